#include "tools/page/screen.h"

#include <algorithm>

#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
namespace {

constexpr std::size_t kHalves = 65536;

/// The encoded value of every half: one look-up a channel in place of a search in a table.
const std::vector<std::uint8_t>& encoded_halves() {
  static const std::vector<std::uint8_t> encoded_of = [] {
    std::vector<std::uint8_t> encoded(kHalves);
    for (std::size_t half = 0; half < kHalves; ++half) {
      encoded[half] = linear_to_srgb8(half_to_float(static_cast<std::uint16_t>(half)));
    }
    return encoded;
  }();
  return encoded_of;
}

}  // namespace

void show_on_screen(const Image& picture, Pixels& pixels, ThreadPool& pool) {
  constexpr std::size_t kChannels = 4;
  constexpr int kRows = 32;
  const std::vector<std::uint8_t>& encoded = encoded_halves();
  const auto row_bytes = static_cast<std::size_t>(picture.width) * kChannels;
  pixels.width = picture.width;
  pixels.height = picture.height;
  pixels.rgba.resize(row_bytes * static_cast<std::size_t>(picture.height));
  pool.for_each((picture.height + kRows - 1) / kRows, [&](int band) {
    const int end = std::min((band + 1) * kRows, picture.height);
    for (int y = band * kRows; y < end; ++y) {
      const auto halves = row<std::uint16_t>(picture, y);
      std::uint8_t* to = &pixels.rgba[static_cast<std::size_t>(y) * row_bytes];
      for (std::size_t i = 0; i < row_bytes; i += kChannels) {
        for (std::size_t c = 0; c < 3; ++c) to[i + c] = encoded[halves[i + c]];
        to[i + 3] = 255;
      }
    }
  });
}

}  // namespace softfocus
