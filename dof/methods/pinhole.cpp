#include "dof/methods/pinhole.h"

#include <algorithm>

#include "raster/threads/loops.h"

namespace softfocus {

void pinhole(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  constexpr int kRows = 64;
  for_each_row(pool, result.height, kRows, [&](int y) {
    const auto from = row<std::uint16_t>(input.scene, y);
    std::copy(from.begin(), from.end(), row<std::uint16_t>(result, y).begin());
  });
}

}  // namespace softfocus
