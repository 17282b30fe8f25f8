#pragma once
// Scenes as texts, and what is complained of in them.

#include <string>
#include <string_view>

#include "scenes/load/load_scene.h"
#include "tests/support/scene_test_files.h"

namespace softfocus::test {

inline Scene read(std::string_view text) { return read_scene_text(text, "a.toml"); }

inline std::string complaint(std::string_view text) {
  return scene_error_of([&] { read(text); });
}

inline constexpr std::string_view kMaterial = "[material.m]\n";  // line 1 of what follows it

inline std::string object(std::string_view keys) {
  return std::string(kMaterial) + "[[object]]\nmaterial = \"m\"\n" + std::string(keys);
}

inline std::string scatter_of(std::string_view keys) {
  return std::string(kMaterial) + "[[scatter]]\nshape = \"sphere\"\nmaterials = [\"m\"]\n" +
         std::string(keys);
}

}  // namespace softfocus::test
