#include "dof/lens.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "dof/dof.h"
#include "raster/numbers/exact_math.h"
#include "raster/numbers/half.h"

namespace softfocus {
namespace {

constexpr double kMillimetres = 1000.0;  // per metre

double focus_mm(const ThinLens& lens) { return lens.focus_m * kMillimetres; }

}  // namespace

const char* lens_error(const ThinLens& lens) {
  const auto usable = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!usable(lens.focal_length_mm)) return "the focal length must be a positive number of mm";
  if (!usable(lens.f_number)) {
    return "the f-number must be positive and finite (for an all-sharp picture, "
           "use the pinhole method)";
  }
  if (!usable(lens.focus_m)) return "the focus distance must be a positive number of metres";
  if (focus_mm(lens) <= lens.focal_length_mm) {
    return "the focal length must be shorter than the focus distance: "
           "nothing nearer than the focal length can be in focus";
  }
  return nullptr;
}

double aperture_mm(const ThinLens& lens) { return lens.focal_length_mm / lens.f_number; }

double image_distance_mm(const ThinLens& lens, double distance_m) {
  const double z = distance_m * kMillimetres;
  return lens.focal_length_mm * z / (z - lens.focal_length_mm);
}

double coc_on_film_mm(const ThinLens& lens, double distance_m) {
  const double z = distance_m * kMillimetres;
  const double f = lens.focal_length_mm;
  return aperture_mm(lens) * f * std::fabs(z - focus_mm(lens)) / (z * (focus_mm(lens) - f));
}

double hyperfocal_m(const ThinLens& lens, double largest_coc_mm) {
  const double f = lens.focal_length_mm;
  return (f * f / (lens.f_number * largest_coc_mm) + f) / kMillimetres;
}

SharpRange sharp_range(const ThinLens& lens, double largest_coc_mm) {
  // c = c_max solved for z on either side of focus:
  //   z = A f z_f / (A f +- c_max (z_f - f))
  const double a_f = aperture_mm(lens) * lens.focal_length_mm;
  const double spread = largest_coc_mm * (focus_mm(lens) - lens.focal_length_mm);
  SharpRange range{};
  range.near_m = a_f * lens.focus_m / (a_f + spread);
  range.far_m =
      spread < a_f ? a_f * lens.focus_m / (a_f - spread) : std::numeric_limits<double>::infinity();
  return range;
}

PixelCoc pixel_coc(const ThinLens& lens, double fov_y_degrees, int height_px, double coc_scale) {
  const double pixels_per_unit_tangent =
      height_px / (2.0 * exact_math::tan_degrees(fov_y_degrees / 2.0));
  const double aperture_radius_m = aperture_mm(lens) / kMillimetres / 2.0;
  const double at_infinity = aperture_radius_m / lens.focus_m * pixels_per_unit_tangent * coc_scale;
  return {static_cast<float>(at_infinity), static_cast<float>(lens.focus_m)};
}

double film_height_mm(const ThinLens& lens, double fov_y_degrees) {
  return 2.0 * image_distance_mm(lens, lens.focus_m) * exact_math::tan_degrees(fov_y_degrees / 2.0);
}

double pixels_per_sensor_mm(double sensor_width_mm, double sensor_height_mm, int width_px,
                            int height_px) {
  const bool turned = (width_px < height_px) != (sensor_width_mm < sensor_height_mm);
  const double across = turned ? sensor_height_mm : sensor_width_mm;
  const double down = turned ? sensor_width_mm : sensor_height_mm;
  return std::max(width_px / across, height_px / down);
}

PixelCoc sensor_coc(const ThinLens& lens, double pixels_per_tangent, double coc_scale) {
  const double aperture_radius_m = aperture_mm(lens) / 1000.0 / 2.0;
  return {static_cast<float>(aperture_radius_m / lens.focus_m * pixels_per_tangent * coc_scale),
          static_cast<float>(lens.focus_m)};
}

namespace {

struct RowSizes {
  float largest_px = 0.0f;
  int beyond_limit = 0;
};

constexpr int kHalves = 65536;

float radius_of_half(const PixelCoc& coc, std::uint16_t depth) {
  const float depth_m = half_to_float(depth);
  return std::isinf(depth_m) ? coc.radius_at_infinity_px : std::fabs(coc_radius_px(coc, depth_m));
}

/// That of every half, for pictures of more pixels; else none.
std::vector<float> radii_of_halves(const PixelCoc& coc, std::size_t pixels, ThreadPool& pool) {
  constexpr int kHalvesAtOnce = 1024;
  std::vector<float> radii(pixels > kHalves ? kHalves : 0);
  pool.for_each(static_cast<int>(radii.size()) / kHalvesAtOnce, [&](int band) {
    for (int half = band * kHalvesAtOnce; half < (band + 1) * kHalvesAtOnce; ++half) {
      radii[static_cast<std::size_t>(half)] = radius_of_half(coc, static_cast<std::uint16_t>(half));
    }
  });
  return radii;
}

}  // namespace

CircleSizes circle_sizes(const ConstImageView& scene, const PixelCoc& coc, float limit_px,
                         ThreadPool& pool) {
  std::vector<RowSizes> rows(static_cast<std::size_t>(scene.height));
  const std::size_t pixels =
      static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height);
  const std::vector<float> radii = radii_of_halves(coc, pixels, pool);
  pool.for_each(scene.height, [&](int y) {
    RowSizes sizes;  // other threads' rows lie beside its place
    const auto values = row<std::uint16_t>(scene, y);
    for (std::size_t i = 3; i < values.size(); i += 4) {
      const float radius = radii.empty() ? radius_of_half(coc, values[i]) : radii[values[i]];
      if (radius > sizes.largest_px) sizes.largest_px = radius;
      if (radius > limit_px) ++sizes.beyond_limit;
    }
    rows[static_cast<std::size_t>(y)] = sizes;
  });
  CircleSizes all;
  double beyond = 0.0;
  for (const RowSizes& sizes : rows) {
    all.largest_px = std::max(all.largest_px, std::min(sizes.largest_px, kLargestMaxCoc));
    beyond += sizes.beyond_limit;
  }
  all.beyond_limit = beyond / (static_cast<double>(scene.width) * scene.height);
  return all;
}

}  // namespace softfocus
