#include "dof/methods/pinhole.h"

#include <algorithm>

namespace softfocus {

void pinhole(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  constexpr int kRows = 64;
  pool.for_each((result.height + kRows - 1) / kRows, [&](int block) {
    const int end = std::min((block + 1) * kRows, result.height);
    for (int y = block * kRows; y < end; ++y) {
      const auto from = row<std::uint16_t>(input.scene, y);
      std::copy(from.begin(), from.end(), row<std::uint16_t>(result, y).begin());
    }
  });
}

}  // namespace softfocus
