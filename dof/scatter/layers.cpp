#include "dof/scatter/layers.h"

#include "dof/scatter/scatter.h"

namespace softfocus {

void layers(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  scatter_in_slabs(input, result, SlabRule::layers, pool);
}

}  // namespace softfocus
