#pragma once
// Which rungs the surfaces of a picture have where, so that tiles leave out the others.

#include <cstdint>
#include <vector>

#include "dof/object_layers/hidden_parts.h"

namespace softfocus {

struct LayerMarks {
  static constexpr int kBlock = 16;  ///< pixels across a block
  int columns, rows;
  /// Of a block, before the focus and behind it: a bit for each rung, numbered over all levels.
  std::vector<std::uint64_t> blocks[2];

  /// All rungs in a rectangle of the picture. What lies outside repeats its border.
  std::uint64_t rungs_in(int side, int x, int y, int width, int height) const;
};

LayerMarks mark_layers(const Surfaces& surfaces, ThreadPool& pool);

}  // namespace softfocus
