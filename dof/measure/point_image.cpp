#include "dof/measure/point_image.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "dof/measure/tone.h"

namespace softfocus {
namespace {

/// Calls `take(x, y, luminance)` for each pixel, in reading order.
template <class Take>
void for_each_luminance(const Image& image, const Take& take) {
  assert(image.format == Format::rgba16f);
  for (int y = 0; y < image.height; ++y) {
    const auto texels = row<std::uint16_t>(image, y);
    for (int x = 0; x < image.width; ++x) {
      const auto i = 4 * static_cast<std::size_t>(x);
      take(x, y,
           luminance(half_light(texels[i]), half_light(texels[i + 1]), half_light(texels[i + 2])));
    }
  }
}

}  // namespace

double energy(const Image& image) {
  double sum = 0.0;
  for_each_luminance(image, [&](int, int, double light) { sum += light; });
  return sum;
}

PointShape point_shape(const Image& image) {
  PointShape shape;
  for_each_luminance(image, [&](int x, int y, double light) {
    shape.energy += light;
    shape.centre_x_px += light * (x + 0.5);
    shape.centre_y_px += light * (y + 0.5);
  });
  if (shape.energy == 0.0) return shape;
  shape.centre_x_px /= shape.energy;
  shape.centre_y_px /= shape.energy;

  // A second round: the difference of large sums would lose the digits.
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for_each_luminance(image, [&](int x, int y, double light) {
    const double dx = x + 0.5 - shape.centre_x_px;
    const double dy = y + 0.5 - shape.centre_y_px;
    xx += light * dx * dx;
    xy += light * dx * dy;
    yy += light * dy * dy;
  });
  const double middle = 0.5 * (xx + yy) / shape.energy;
  const double half_difference = 0.5 * (xx - yy) / shape.energy;
  const double mixed = xy / shape.energy;
  const double spread = std::sqrt(half_difference * half_difference + mixed * mixed);
  const double larger = middle + spread;
  if (larger > 0.0) shape.eigenvalue_ratio = std::max(0.0, middle - spread) / larger;
  shape.radius_px = std::sqrt(4.0 * middle);
  return shape;
}

double disc_coverage(int x, int y, double centre_x_px, double centre_y_px, double radius_px) {
  const double dx = x + 0.5 - centre_x_px;
  const double dy = y + 0.5 - centre_y_px;
  const double distance = std::sqrt(dx * dx + dy * dy);
  constexpr double kHalfDiagonal = std::numbers::sqrt2 / 2.0;
  if (distance >= radius_px + kHalfDiagonal) return 0.0;
  if (distance <= radius_px - kHalfDiagonal) return 1.0;
  constexpr int kSteps = 16;
  int inside = 0;
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      const double px = dx - 0.5 + (i + 0.5) / kSteps;
      const double py = dy - 0.5 + (j + 0.5) / kSteps;
      inside += px * px + py * py < radius_px * radius_px ? 1 : 0;
    }
  }
  return static_cast<double>(inside) / (kSteps * kSteps);
}

double disc_deviation(const Image& image, double radius_px) {
  assert(radius_px > 0.0);
  const PointShape shape = point_shape(image);
  const auto disc = [&](int x, int y) {
    return disc_coverage(x, y, shape.centre_x_px, shape.centre_y_px, radius_px);
  };
  double covered = 0.0;
  for_each_luminance(image, [&](int x, int y, double) { covered += disc(x, y); });
  if (shape.energy == 0.0 || covered == 0.0) return std::numeric_limits<double>::quiet_NaN();
  double errors = 0.0;
  double squares = 0.0;
  for_each_luminance(image, [&](int x, int y, double light) {
    const double right = disc(x, y) * shape.energy / covered;
    errors += (light - right) * (light - right);
    squares += right * right;
  });
  return std::sqrt(errors / squares);
}

}  // namespace softfocus
