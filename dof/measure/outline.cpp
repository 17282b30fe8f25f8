#include "dof/measure/outline.h"

#include <array>
#include <cmath>

namespace softfocus {

std::vector<std::uint8_t> coverage_of(const Image& picture, std::uint16_t background_depth) {
  std::vector<std::uint8_t> covered;
  covered.reserve(static_cast<std::size_t>(picture.width) *
                  static_cast<std::size_t>(picture.height));
  for (int y = 0; y < picture.height; ++y) {
    const std::uint16_t* texels = row<std::uint16_t>(picture, y).data();
    for (int x = 0; x < picture.width; ++x) {
      covered.push_back(texels[4 * x + 3] != background_depth ? 1 : 0);
    }
  }
  return covered;
}

OutlineError outline_error(const std::vector<std::uint8_t>& drawn,
                           const std::vector<std::uint8_t>& shown, int width, int height) {
  const auto at = [&](const std::vector<std::uint8_t>& of, int x, int y) {
    if (x < 0 || y < 0 || x >= width || y >= height) return 0;
    return static_cast<int>(of[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                               static_cast<std::size_t>(x)]);
  };
  OutlineError error;
  std::size_t outline = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int is = at(drawn, x, y), looks = at(shown, x, y);
      error.seen += static_cast<std::size_t>(is);
      if (is == 1 && (at(drawn, x - 1, y) + at(drawn, x + 1, y) + at(drawn, x, y - 1) +
                      at(drawn, x, y + 1)) < 4) {
        ++outline;
      }
      if (is == looks) continue;
      ++(is == 1 ? error.lost : error.gained);
      // The nearest pixel that is drawn as this one is shown; the outline runs half a pixel before.
      constexpr int kFarthest = 32;
      double nearest = kFarthest;
      for (int r = 1; r < kFarthest && nearest > r; ++r) {
        for (int i = -r; i <= r; ++i) {
          const std::array<std::array<int, 2>, 4> ring{
              {{x + i, y - r}, {x + i, y + r}, {x - r, y + i}, {x + r, y + i}}};
          for (const std::array<int, 2>& place : ring) {
            if (at(drawn, place[0], place[1]) != looks) continue;
            const double dx = place[0] - x, dy = place[1] - y;
            nearest = std::fmin(nearest, std::sqrt(dx * dx + dy * dy));
          }
        }
      }
      error.most_px = std::fmax(error.most_px, nearest - 0.5);
    }
  }
  if (outline > 0) {
    error.mean_px = static_cast<double>(error.lost + error.gained) / static_cast<double>(outline);
  }
  return error;
}

}  // namespace softfocus
