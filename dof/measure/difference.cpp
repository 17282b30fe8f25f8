#include "dof/measure/difference.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

#include "raster/images/texel.h"
#include "raster/numbers/half.h"

namespace softfocus {
namespace {

double display_value(std::uint16_t half) {
  const float value = half_to_float(half);
  return value > 0.0f ? std::min(static_cast<double>(value), 1.0) : 0.0;
}

// Of values with different bits.
double error_between(std::uint16_t a, std::uint16_t b) {
  const double error =
      std::fabs(static_cast<double>(half_to_float(a)) - static_cast<double>(half_to_float(b)));
  return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
}

// A stop for each quarter of the logarithmic scale.
glm::vec4 heat(int ulps) {
  if (ulps == 0) return {0.0f, 0.0f, 0.0f, 1.0f};
  constexpr std::array<glm::vec3, 4> kStops{
      glm::vec3{0.1f, 0.2f, 1.0f}, glm::vec3{0.0f, 0.8f, 0.3f}, glm::vec3{1.0f, 0.9f, 0.0f},
      glm::vec3{1.0f, 0.0f, 0.0f}};
  const int magnitude =
      static_cast<int>(std::bit_width(static_cast<unsigned>(ulps))) - 1;  // 0 to 15
  const float place = static_cast<float>(magnitude) / 5.0f;
  const auto stop = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  const float t = place - static_cast<float>(stop);
  return {kStops[stop] + (kStops[stop + 1] - kStops[stop]) * t, 1.0f};
}

}  // namespace

Difference compare_images(const Image& a, const Image& b) {
  assert(a.format == Format::rgba16f && b.format == Format::rgba16f);
  assert(a.width == b.width && a.height == b.height);
  Difference difference;
  double squares = 0.0;
  for (int y = 0; y < a.height; ++y) {
    const auto of_a = row<std::uint16_t>(a, y);
    const auto of_b = row<std::uint16_t>(b, y);
    for (std::size_t i = 0; i < of_a.size(); ++i) {
      const int ulps = half_ulps_between(of_a[i], of_b[i]);
      ++difference.values;
      ++difference
            .ulp_histogram[static_cast<std::size_t>(std::bit_width(static_cast<unsigned>(ulps)))];
      if (ulps != 0) {
        if (difference.differing == 0) {
          difference.first_x = static_cast<int>(i / 4);
          difference.first_y = y;
          difference.first_channel = static_cast<int>(i % 4);
        }
        ++difference.differing;
        if (i % 4 != 3) {
          difference.max_error = std::max(difference.max_error, error_between(of_a[i], of_b[i]));
        }
        difference.max_ulp = std::max(difference.max_ulp, ulps);
      }
      if (i % 4 != 3) {
        const double error = display_value(of_a[i]) - display_value(of_b[i]);
        squares += error * error;
      }
    }
  }
  difference.psnr_db = psnr_db(squares / (3.0 * a.width * a.height));
  return difference;
}

std::uint64_t pixels_beyond(const Image& a, const Image& b, const PixelLimit& limit) {
  assert(a.format == Format::rgba16f && b.format == Format::rgba16f);
  assert(a.width == b.width && a.height == b.height);
  const std::size_t channels = limit.has_opacity ? 4 : 3;
  const auto is_like = [&](const Image& one, int x, int y, const Image& other, int i, int j) {
    const auto* const p = row<std::uint16_t>(one, y).data() + 4 * x;
    const auto* const q = row<std::uint16_t>(other, j).data() + 4 * i;
    for (std::size_t c = 0; c < channels; ++c) {
      if (half_ulps_between(p[c], q[c]) != 0 && error_between(p[c], q[c]) > limit.most)
        return false;
    }
    return true;
  };
  const auto is_found = [&](const Image& one, int x, int y, const Image& other) {
    if (is_like(one, x, y, other, x, y)) return true;
    const int reach = limit.search_px;
    for (int j = std::max(y - reach, 0); j <= std::min(y + reach, one.height - 1); ++j) {
      for (int i = std::max(x - reach, 0); i <= std::min(x + reach, one.width - 1); ++i) {
        if (is_like(one, x, y, other, i, j)) return true;
      }
    }
    return false;
  };
  std::uint64_t count = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) count += !(is_found(a, x, y, b) && is_found(b, x, y, a));
  }
  return count;
}

Image difference_picture(const Image& a, const Image& b) {
  Image picture = make_image(Format::rgba16f, a.width, a.height);
  for (int y = 0; y < a.height; ++y) {
    const auto of_a = row<std::uint16_t>(a, y);
    const auto of_b = row<std::uint16_t>(b, y);
    for (int x = 0; x < a.width; ++x) {
      int largest = 0;
      for (std::size_t c = 0; c < 4; ++c) {
        const std::size_t i = static_cast<std::size_t>(x) * 4 + c;
        largest = std::max(largest, half_ulps_between(of_a[i], of_b[i]));
      }
      store_texel<Format::rgba16f>(picture, x, y, heat(largest), {});
    }
  }
  return picture;
}

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
