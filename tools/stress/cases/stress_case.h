#pragma once
// A case of the atlas: pictures that are hard to blur, scenes whose shadows are hard to find,
// objects that are hard to show from a relief, their true answers, and a number for how far a
// method's answer is from the truth.

#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "dof/dof.h"
#include "raster/images/image.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/scene.h"

namespace softfocus {

/// The place and the light in which an object was drawn that is shown from elsewhere.
struct StressRelief {
  glm::dvec3 drawn_from;
  std::vector<Light> drawn_lights;
};

/// The scene for methods that draw it themselves, beside the sharp picture.
struct StressScene {
  Scene scene;
  CameraMatrices camera{};
  double focus_m = 1.0;
  double aperture_m = 0.0;      ///< its radius
  double shutter_frames = 0.0;  ///< how long the shutter is open: above 0 all of it is the truth
  bool shadows = false;         ///< of all lights: kinds of shadows answer, and nothing is blurred
  std::optional<StressRelief> relief{};  ///< impostors answer, and nothing is blurred
};

/// One picture to blur. Most trials have one, those of motion and of resolution two.
struct StressFrame {
  Image sharp;  ///< RGBA16F, depth in alpha
  DofSettings settings;
  std::optional<StressScene> scene;  ///< none: the case is made as a picture
  Image truth;                       ///< without pixels where the lens's views are the truth
};

struct StressTrial {
  std::vector<StressFrame> frames;
};

/// An answer to a trial: a picture for each frame, beside the true ones.
struct StressAnswer {
  const StressTrial& trial;
  double severity;
  std::span<const Image> truth;
  std::span<const Image> result;
  ThreadPool& pool;
};

/// The severity that is swept.
struct StressParameter {
  std::string_view name;
  std::string_view unit;
};

struct StressCase {
  std::string_view name;
  std::string_view title;
  std::string_view must_hold;
  StressParameter parameter;
  std::string_view measured;  ///< what the number is, for an axis
  std::string_view unit;
  double limit;  ///< the largest number that holds, the same for all methods
  std::string_view why_limit;
  std::span<const double> severities;  ///< from the mildest on
  double telling;                      ///< the severity whose pictures are shown
  /// Views of the lens that make the truth; 0: it is calculated.
  int views;
  StressTrial (*make)(double severity, int size_px, ThreadPool& pool);
  /// 0 or more, in `unit`; NaN and infinity do not hold.
  double (*measure)(const StressAnswer& answer);
};

/// All cases, by theme.
std::vector<StressCase> stress_cases();

std::span<const StressCase> edge_cases();
std::span<const StressCase> light_cases();
std::span<const StressCase> crowd_cases();
std::span<const StressCase> glass_cases();
std::span<const StressCase> plane_cases();
std::span<const StressCase> depth_cases();
std::span<const StressCase> plain_cases();
std::span<const StressCase> motion_cases();
std::span<const StressCase> shutter_cases();
std::span<const StressCase> shadow_cases();
std::span<const StressCase> relief_cases();

/// The severities for a picture of that size: radii and widths in pixels are at most a quarter of
/// it. `quick` takes the first, the telling and the last one.
std::vector<double> severities_of(const StressCase& of, int size_px, bool quick);

/// The severity whose pictures are shown: the nearest that there is to the telling one.
double shown_severity(const StressCase& of, std::span<const double> severities);

/// Whether two cases are measured on the same pictures.
bool same_trials(const StressCase& a, const StressCase& b);

}  // namespace softfocus
