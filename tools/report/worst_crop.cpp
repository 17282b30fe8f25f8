#include "tools/report/worst_crop.h"

#include <algorithm>
#include <cassert>

#include "raster/images/texel.h"

namespace softfocus {
namespace {

/// sums[y][x]: of all values above and to the left; one row and one column more than the map.
PixelMap sums_up_to(const PixelMap& map) {
  PixelMap sums = make_pixel_map(map.width + 1, map.height + 1);
  for (int y = 0; y < map.height; ++y) {
    const auto values = row(map, y);
    const auto above = row(sums, y), here = row(sums, y + 1);
    double of_row = 0.0;
    for (std::size_t x = 0; x < values.size(); ++x) {
      of_row += values[x];
      here[x + 1] = above[x + 1] + of_row;
    }
  }
  return sums;
}

/// How far a block of a reduced picture reaches.
int block_end(int block, int factor, int side) { return std::min((block + 1) * factor, side); }

}  // namespace

Crop worst_crop(const PixelMap& map, int side) {
  assert(side >= 1 && side <= map.width && side <= map.height);
  const PixelMap sums = sums_up_to(map);
  const auto at = [&](int x, int y) { return row(sums, y)[static_cast<std::size_t>(x)]; };
  Crop worst{0, 0, side};
  double most = at(side, side);
  for (int y = 0; y + side <= map.height; ++y) {
    for (int x = 0; x + side <= map.width; ++x) {
      const double sum = at(x + side, y + side) - at(x, y + side) - at(x + side, y) + at(x, y);
      // Sums that are equal but for rounding are equal.
      if (sum <= most + 1e-9 * (1.0 + most)) continue;
      most = sum;
      worst = {x, y, side};
    }
  }
  return worst;
}

Image cropped(const Image& picture, const Crop& crop) {
  Image part = make_image(picture.format, crop.side, crop.side);
  for (int y = 0; y < crop.side; ++y) {
    const auto from =
        row<std::uint16_t>(picture, crop.y + y)
            .subspan(4 * static_cast<std::size_t>(crop.x), 4 * static_cast<std::size_t>(crop.side));
    std::copy(from.begin(), from.end(), row<std::uint16_t>(part, y).begin());
  }
  return part;
}

PixelMap cropped(const PixelMap& map, const Crop& crop) {
  PixelMap part = make_pixel_map(crop.side, crop.side);
  for (int y = 0; y < crop.side; ++y) {
    const auto from =
        row(map, crop.y + y)
            .subspan(static_cast<std::size_t>(crop.x), static_cast<std::size_t>(crop.side));
    std::copy(from.begin(), from.end(), row(part, y).begin());
  }
  return part;
}

Image reduced(const Image& picture, int factor) {
  const int width = (picture.width + factor - 1) / factor;
  const int height = (picture.height + factor - 1) / factor;
  Image small = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      glm::vec4 sum{0.0f};
      for (int v = y * factor; v < block_end(y, factor, picture.height); ++v) {
        for (int u = x * factor; u < block_end(x, factor, picture.width); ++u) {
          const glm::vec4 texel = load_texel<Format::rgba16f>(picture, u, v);
          for (int c = 0; c < 4; ++c) sum[c] += texel[c] > 0.0f ? std::min(texel[c], 1.0f) : 0.0f;
        }
      }
      const int texels = (block_end(y, factor, picture.height) - y * factor) *
                         (block_end(x, factor, picture.width) - x * factor);
      store_texel<Format::rgba16f>(small, x, y, sum / static_cast<float>(texels), {});
    }
  }
  return small;
}

PixelMap reduced(const PixelMap& map, int factor) {
  PixelMap small =
      make_pixel_map((map.width + factor - 1) / factor, (map.height + factor - 1) / factor);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      double sum = 0.0;
      int count = 0;
      for (int v = y * factor; v < block_end(y, factor, map.height); ++v) {
        for (int u = x * factor; u < block_end(x, factor, map.width); ++u, ++count) {
          sum += row(map, v)[static_cast<std::size_t>(u)];
        }
      }
      row(small, y)[static_cast<std::size_t>(x)] = sum / count;
    }
  }
  return small;
}

int reduction_factor(int width, int height, int longest_side) {
  return (std::max(width, height) + longest_side - 1) / longest_side;
}

}  // namespace softfocus
