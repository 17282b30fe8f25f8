#pragma once
// A case of the atlas: pictures that are hard to blur, scenes whose shadows are hard to find,
// objects that are hard to show from a relief, their true answers, and a number for how far a
// method's answer is from the truth.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "dof/dof.h"
#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
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
  Image sharp;         ///< RGBA16F, depth in alpha
  EdgePictures edges;  ///< of `sharp`, if the case has them
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

// Frames of trials: pictures pixel by pixel, and scenes of upright rectangles that are placed by
// the pixels they cover.

/// The focus, and the depths at which a circle is half and all of the one at infinity.
inline constexpr double kStressFocusM = 2.0;
inline constexpr double kStressFarM = 4.0;
inline constexpr double kStressNearM = 1.0;

/// `texel_at(x, y)` gives red, green, blue and the depth in metres.
template <class TexelAt>
Image picture_of(int width, int height, const TexelAt& texel_at) {
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      store_texel<Format::rgba16f>(image, x, y, texel_at(x, y), {});
    }
  }
  return image;
}

/// A square picture of greys with its depth.
template <class GreyAt, class DepthAt>
Image grey_picture_of(int size_px, const GreyAt& grey_at, const DepthAt& depth_at) {
  return picture_of(size_px, size_px, [&](int x, int y) {
    return glm::vec4{glm::vec3{static_cast<float>(grey_at(x, y))},
                     static_cast<float>(depth_at(x, y))};
  });
}

/// The depth in metres at which the circle's signed radius is that.
double depth_of_radius(double radius_px, double radius_at_infinity_px, double focus_m);

/// Settings that cut no circle of up to `largest_px`.
DofSettings uncut_settings(double radius_at_infinity_px, double focus_m, double largest_px);

/// A part of the picture, in pixels from its left and upper border.
struct PixelBox {
  double left, top, right, bottom;
};

/// A square of pixels.
inline PixelBox pixel_square(int left, int top, int side) {
  return {1.0 * left, 1.0 * top, 1.0 * (left + side), 1.0 * (top + side)};
}

/// An empty scene, seen from the origin.
Scene flat_scene();

/// Adds an upright rectangle that covers that part of a picture of `size_px` rows. Unlit, so
/// that its colour is its light.
void add_rectangle(Scene& scene, int size_px, const PixelBox& box, double depth_m, glm::vec3 colour,
                   std::optional<std::uint32_t> texture = {}, glm::vec2 repeats = {1, 1});

/// Adds a rectangle over all of the picture and its size around it, for lenses look past the
/// border.
void add_backdrop(Scene& scene, int size_px, double depth_m, glm::vec3 colour,
                  std::optional<std::uint32_t> texture = {}, float repeats = 3);

/// Adds a texture by the name of its pattern, of two colours, and returns its index.
std::uint32_t add_pattern(Scene& scene, std::string_view pattern, int cells, glm::vec3 first,
                          glm::vec3 second);

/// Draws a scene as methods get it. `largest_px`: the circles are not cut up to that radius.
/// `samples` of a pixel: several find edges.
StressFrame drawn_frame(Scene scene, double radius_at_infinity_px, double largest_px, int size_px,
                        ThreadPool& pool, double focus_m = kStressFocusM, int samples = 1);

/// A trial of one frame.
StressTrial single(StressFrame frame);

}  // namespace softfocus
