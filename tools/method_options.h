#pragma once
// --method and --max-coc, as `render` and `bench` share them.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "dof/method.h"
#include "scenes/scene.h"

namespace softfocus {

/// Adds --method; `method` holds the default.
void add_method_option(CLI::App& parser, const Method*& method);

/// Adds --max-coc.
void add_max_coc_option(CLI::App& parser, std::optional<float>& max_coc_px);

/// The filter size for a picture of that height: as given, or the scene's, at most
/// kLargestMaxCoc.
float used_max_coc_px(std::optional<float> given, const SceneLens& of_scene, int height_px);

}  // namespace softfocus
