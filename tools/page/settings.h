#pragma once
// A `frame` request's settings.

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "scenes/lens_views/lens_view_method.h"
#include "scenes/scene.h"
#include "tools/cli/option_values.h"
#include "tools/files/json.h"
#include "tools/options/lens_options.h"
#include "tools/options/method_options.h"
#include "tools/options/scene_options.h"
#include "tools/refocus/options.h"
#include "tools/render/options.h"

namespace softfocus {

/// Fewer than `render` takes by itself: the page shall answer at once.
inline constexpr Parameter kPageSamples = [] {
  Parameter fewer = parameter::kSamples;
  fewer.preset = 64;
  return fewer;
}();

/// A camera in place of the scene's.
struct CameraChoice {
  glm::dvec3 position, target;
  double fov_y_degrees;

  bool operator==(const CameraChoice&) const = default;
};

struct FrameSettings {
  PictureSize size{512, 512};  ///< of the picture that is drawn: already divided by `preview`
  int preview = 1;             ///< what sizes and radii were divided by
  double frame = 0.0;          ///< time of the animation
  std::optional<CameraChoice> camera;
  SceneLook look;
  std::optional<std::string> effect;  ///< in place of the scene's: its name, or "none"
  Show show = Show::image;
  MethodChoice method{.filter = find_method("two-pass")};
  Aperture aperture;
  std::optional<HighlightCurve> highlights;  ///< of a picture
  LensOptions lens;
  std::optional<glm::dvec2> focus_at;  ///< 0 to 1 from the left and from the top
  std::optional<float> max_coc_px;
  Sampling sampling{.samples = static_cast<int>(kPageSamples.preset)};
  bool hash = true;  ///< whether the picture's hash is wanted: it takes longer than to show it
};

/// Throws UsageError or JsonError, each with one line that names the key. Unknown keys are
/// ignored.
FrameSettings read_frame_settings(const Json& request);

/// The aperture as the method has it: round, or with blades, or with all that can be set.
Aperture used_aperture(const FrameSettings& settings);

/// The scene's camera, or that camera in its place. Throws UsageError if nothing can be seen
/// through it.
Camera chosen_camera(const Camera& of_scene, const std::optional<CameraChoice>& choice);

/// A member that is there and not null, or nullptr.
const Json* given(const Json& request, std::string_view name);

/// A number that is allowed: UsageError.
double checked_number(const Json& value, const Parameter& parameter);
double checked_number(const Json& value, std::string_view name, double least, double most);

/// Numbers that requests set, and the controls show.
std::span<const Parameter> page_parameters();

}  // namespace softfocus
