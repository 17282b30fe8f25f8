#include "scenes/draw/light_shares.h"

#include <algorithm>

#include "raster/images/texel.h"

namespace softfocus {
namespace {

const std::uint8_t* row_of(std::span<const std::uint8_t> shares, int width, int y) {
  return shares.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
}

}  // namespace

bool has_shares(std::span<const std::uint8_t> shares, int width, const Rectangle& area) {
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const std::uint8_t* of_row = row_of(shares, width, y);
    if (std::any_of(of_row + area.x_begin, of_row + area.x_end,
                    [](std::uint8_t share) { return share != 0; })) {
      return true;
    }
  }
  return false;
}

void take_shares(std::span<const std::uint8_t> shares, int whole, const Rectangle& area,
                 const Image& with, const Image& without, Image& colour, const Profile& profile) {
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const std::uint8_t* of_row = row_of(shares, colour.width, y);
    for (int x = area.x_begin; x < area.x_end; ++x) {
      if (of_row[x] == 0) continue;
      const float part = static_cast<float>(of_row[x]) / static_cast<float>(whole);
      const glm::vec4 lit = load_texel<Format::rgba16f>(with, x, y);
      const glm::vec4 unlit = load_texel<Format::rgba16f>(without, x, y);
      glm::vec4 here = load_texel<Format::rgba16f>(colour, x, y);
      for (int i = 0; i < 3; ++i) {
        here[i] = std::max(here[i] + part * (unlit[i] - lit[i]), 0.0f);
      }
      store_texel<Format::rgba16f>(colour, x, y, here, profile);
    }
  }
}

}  // namespace softfocus
