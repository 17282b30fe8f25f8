#include "tools/crosscheck/tally.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <limits>

#include "dof/measure/difference.h"
#include "raster/images/texel.h"
#include "raster/numbers/half.h"

namespace softfocus {
namespace {

// Sign and magnitude to a line on which neighbours are 1 apart; -0 lies beside +0.
template <class Signed, class Bits>
std::int64_t on_a_line(Bits bits) {
  const auto value = static_cast<Signed>(bits);
  const std::int64_t magnitude = value & std::numeric_limits<Signed>::max();
  return value < 0 ? -1 - magnitude : magnitude;
}

struct Comparison {
  bool equal;
  std::uint32_t ulps;
};

template <class Signed, class Bits>
Comparison compare_floats(Bits a, Bits b, bool a_is_nan, bool b_is_nan) {
  if (a == b || (a_is_nan && b_is_nan)) return {true, 0};
  if (a_is_nan || b_is_nan) return {false, std::numeric_limits<std::uint32_t>::max()};
  const std::int64_t distance = on_a_line<Signed>(a) - on_a_line<Signed>(b);
  return {false, static_cast<std::uint32_t>(distance < 0 ? -distance : distance)};
}

Comparison compare_values(std::uint8_t a, std::uint8_t b) {
  return {a == b, static_cast<std::uint32_t>(a > b ? a - b : b - a)};
}
Comparison compare_values(std::uint16_t a, std::uint16_t b) {
  return compare_floats<std::int16_t>(a, b, std::isnan(half_to_float(a)),
                                      std::isnan(half_to_float(b)));
}
Comparison compare_values(float a, float b) {
  return compare_floats<std::int32_t>(std::bit_cast<std::uint32_t>(a),
                                      std::bit_cast<std::uint32_t>(b), std::isnan(a),
                                      std::isnan(b));
}

std::string text_of(std::uint8_t value) { return std::to_string(value); }
std::string text_of(std::uint16_t value) {
  char text[48];
  std::snprintf(text, sizeof text, "%.9g (0x%04x)", static_cast<double>(half_to_float(value)),
                static_cast<unsigned>(value));
  return text;
}
std::string text_of(float value) {
  char text[48];
  std::snprintf(text, sizeof text, "%.9g (0x%08x)", static_cast<double>(value),
                std::bit_cast<std::uint32_t>(value));
  return text;
}

template <class Channel>
void add_channels(Tally& tally, const Image& driver, const Image& emulated,
                  const std::string& where) {
  const auto channels = static_cast<std::size_t>(channel_count(driver.format));
  for (int y = 0; y < driver.height; ++y) {
    const auto a = row<Channel>(driver, y);
    const auto b = row<Channel>(emulated, y);
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Comparison comparison = compare_values(a[i], b[i]);
      if (comparison.equal) continue;
      ++tally.differing;
      tally.max_ulp = std::max(tally.max_ulp, comparison.ulps);
      if (tally.first) continue;
      tally.first = {static_cast<int>(i / channels),
                     y,
                     static_cast<int>(i % channels),
                     text_of(a[i]),
                     text_of(b[i]),
                     where};
      tally.driver = driver;
      tally.emulated = emulated;
    }
  }
  tally.values += static_cast<std::uint64_t>(driver.width) *
                  static_cast<std::uint64_t>(driver.height) * channels;
}

float largest_magnitude(const Image& image) {
  float largest = 1.0f;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const glm::vec4 texel = load_texel(image, x, y);
      for (int i = 0; i < 3; ++i) {
        if (std::isfinite(texel[i])) largest = std::max(largest, std::fabs(texel[i]));
      }
    }
  }
  return largest;
}

bool same_texel(const Image& a, const Image& b, int x, int y) {
  const glm::vec4 first = load_texel(a, x, y);
  const glm::vec4 second = load_texel(b, x, y);
  for (int i = 0; i < 4; ++i) {
    if (!compare_values(first[i], second[i]).equal) return false;
  }
  return true;
}

// The places that differ and, for halves, by how much.
Image difference_map(const Tally& tally) {
  const Image& driver = tally.driver;
  if (driver.format == Format::rgba16f) return difference_picture(driver, tally.emulated);
  Image map = make_image(Format::rgba16f, driver.width, driver.height);
  for (int y = 0; y < driver.height; ++y) {
    for (int x = 0; x < driver.width; ++x) {
      const float white = same_texel(driver, tally.emulated, x, y) ? 0.0f : 1.0f;
      store_texel(map, x, y, {white, white, white, 1.0f}, {});
    }
  }
  return map;
}

}  // namespace

void add_pictures(Tally& tally, const Image& driver, const Image& emulated,
                  const std::string& where) {
  assert(driver.format == emulated.format && driver.width == emulated.width &&
         driver.height == emulated.height);
  switch (bytes_per_texel(driver.format) / static_cast<std::size_t>(channel_count(driver.format))) {
    case 1: add_channels<std::uint8_t>(tally, driver, emulated, where); break;
    case 2: add_channels<std::uint16_t>(tally, driver, emulated, where); break;
    default: add_channels<float>(tally, driver, emulated, where); break;
  }
}

Image side_by_side(const Tally& tally) {
  const Image& driver = tally.driver;
  const Image map = difference_map(tally);
  const float scale = 1.0f / largest_magnitude(driver);
  const int gap = 4;
  Image result = make_image(Format::rgba16f, 3 * driver.width + 2 * gap, driver.height);
  clear_image(result, {0.2f, 0.2f, 0.2f, 1.0f}, {});
  const int step = driver.width + gap;
  for (int y = 0; y < driver.height; ++y) {
    for (int x = 0; x < driver.width; ++x) {
      store_texel(result, x, y, load_texel(driver, x, y) * scale, {});
      store_texel(result, x + step, y, load_texel(tally.emulated, x, y) * scale, {});
      store_texel(result, x + 2 * step, y, load_texel(map, x, y), {});
    }
  }
  return result;
}

}  // namespace softfocus
