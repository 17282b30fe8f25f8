#pragma once
// Frames of trials: pictures pixel by pixel, and scenes of upright rectangles that are placed by
// the pixels they cover.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>

#include "raster/images/texel.h"
#include "tools/stress/cases/stress_case.h"

namespace softfocus {

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
StressFrame drawn_frame(Scene scene, double radius_at_infinity_px, double largest_px, int size_px,
                        ThreadPool& pool, double focus_m = kStressFocusM);

/// A trial of one frame.
StressTrial single(StressFrame frame);

}  // namespace softfocus
