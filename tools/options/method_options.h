#pragma once
// --method and --max-coc, as `render` and `bench` share them.

#include <optional>
#include <string>

#include "dof/dof.h"
#include "scenes/lens_views/lens_view_method.h"
#include "scenes/scene.h"
#include "tools/cli/parser.h"

namespace softfocus {

/// What chooses a method by the scene (dof/auto/auto_method.h).
inline constexpr std::string_view kAutoMethod = "auto";

/// A method of either table: a filter of the drawn picture or one that draws the scene. Or
/// neither: the scene shall choose.
struct MethodChoice {
  const Method* filter = nullptr;
  const LensViewMethod* of_scene = nullptr;

  bool is_auto() const { return filter == nullptr && of_scene == nullptr; }
  std::string_view name() const {
    return is_auto() ? kAutoMethod : filter != nullptr ? filter->name : of_scene->name;
  }
};

/// Adds --method for filters; `method` holds the default.
void add_method_option(CLI::App& parser, const Method*& method);

/// The same for both tables and for `auto`. What a build lacks is refused here, with how to get it.
void add_method_option(CLI::App& parser, MethodChoice& method);

/// Adds --max-coc.
void add_max_coc_option(CLI::App& parser, std::optional<float>& max_coc_px);

/// The filter size for a picture of that height: as given, or the scene's, at most
/// kLargestMaxCoc.
float used_max_coc_px(std::optional<float> given, const SceneLens& of_scene, int height_px);

}  // namespace softfocus
