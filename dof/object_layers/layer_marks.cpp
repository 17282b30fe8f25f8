#include "dof/object_layers/layer_marks.h"

#include <algorithm>
#include <bit>

#include "dof/object_layers/object_rungs.h"

namespace softfocus {
namespace {

// The rungs of some surfaces, before the focus and behind it.
struct Marked {
  std::uint64_t rungs[2] = {0, 0};
  std::uint32_t last = ~0u;  // what the rungs of the last surface come from

  void add(float radius_px) {
    const float square = radius_px * radius_px;
    const auto bits = std::bit_cast<std::uint32_t>(square);
    const std::uint32_t key = bits >> 22 << 2 | ((bits & 0x3FFFFFu) == 0 ? 2u : 0u) |
                              std::bit_cast<std::uint32_t>(radius_px) >> 31;
    if (key == last) return;
    last = key;
    rungs[radius_px < 0.0f ? 0 : 1] |= rungs_of(square);
  }
};

}  // namespace

std::uint64_t LayerMarks::rungs_in(int side, int x, int y, int width, int height) const {
  const int left = std::clamp(x / kBlock, 0, columns - 1);
  const int right = std::clamp((x + width - 1) / kBlock, 0, columns - 1);
  const int top = std::clamp(y / kBlock, 0, rows - 1);
  const int bottom = std::clamp((y + height - 1) / kBlock, 0, rows - 1);
  std::uint64_t rungs = 0;
  for (int row = top; row <= bottom; ++row) {
    const auto begin = static_cast<std::size_t>(row * columns);
    for (int column = left; column <= right; ++column) {
      rungs |= blocks[side][begin + static_cast<std::size_t>(column)];
    }
  }
  return rungs;
}

LayerMarks mark_layers(const Surfaces& surfaces, ThreadPool& pool) {
  const Planes& visible = surfaces.visible;
  const Planes& hidden = surfaces.hidden;
  LayerMarks marks{};
  marks.columns = (visible.width + LayerMarks::kBlock - 1) / LayerMarks::kBlock;
  marks.rows = (visible.height + LayerMarks::kBlock - 1) / LayerMarks::kBlock;
  for (auto& blocks : marks.blocks) {
    blocks.assign(static_cast<std::size_t>(marks.columns * marks.rows), 0);
  }
  pool.for_each(marks.rows, [&](int row) {
    const int end = std::min((row + 1) * LayerMarks::kBlock, visible.height);
    for (int y = row * LayerMarks::kBlock; y < end; ++y) {
      const float* radii = plane_row(visible, 3, y);
      const float* hidden_radii = plane_row(hidden, hidden_plane::kRadius, y);
      const float* shares = plane_row(hidden, hidden_plane::kShare, y);
      for (int column = 0; column < marks.columns; ++column) {
        Marked marked;
        const int begin = column * LayerMarks::kBlock;
        for (int x = begin; x < std::min(begin + LayerMarks::kBlock, visible.width); ++x) {
          marked.add(radii[x]);
          if (shares[x] > 0.0f) marked.add(hidden_radii[x]);
        }
        const auto block = static_cast<std::size_t>(row * marks.columns + column);
        for (std::size_t side = 0; side < 2; ++side)
          marks.blocks[side][block] |= marked.rungs[side];
      }
    }
  });
  return marks;
}

}  // namespace softfocus
