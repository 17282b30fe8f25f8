#include "dof/measure/squared_error.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace softfocus {

PixelMap squared_error_map(const Image& a, const Image& b, const ToneTable& tone,
                           ThreadPool& pool) {
  assert(a.format == Format::rgba16f && b.format == Format::rgba16f);
  assert(a.width == b.width && a.height == b.height);
  PixelMap map = make_pixel_map(a.width, a.height);
  pool.for_each(a.height, [&](int y) {
    const auto of_a = row<std::uint16_t>(a, y);
    const auto of_b = row<std::uint16_t>(b, y);
    const auto errors = row(map, y);
    for (std::size_t x = 0; x < errors.size(); ++x) {
      double squares = 0.0;
      for (std::size_t i = 4 * x; i < 4 * x + 3; ++i) {
        const double error = toned(tone, of_a[i]) - toned(tone, of_b[i]);
        squares += error * error;
      }
      errors[x] = squares / 3.0;
    }
  });
  return map;
}

double psnr_db(double mean_squared_error) {
  if (mean_squared_error == 0.0) return std::numeric_limits<double>::infinity();
  return -10.0 * std::log10(mean_squared_error);
}

}  // namespace softfocus
