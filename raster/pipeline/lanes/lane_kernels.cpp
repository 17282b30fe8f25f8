#include "raster/pipeline/lanes/lane_kernels.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "raster/images/texel.h"
#include "raster/numbers/fixed_point.h"
#include "raster/pipeline/clip.h"

#define SOFTFOCUS_KERNELS "raster/pipeline/lanes/lane_kernels.inl"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

bool any_outside(const AssembleJob& job) {
  const auto indices = job.indices.subspan(3 * job.begin, 3 * (job.end - job.begin));
  return std::any_of(indices.begin(), indices.end(), [&](std::uint32_t i) {
    return (static_cast<unsigned>(job.vertices.codes[i]) & ~kNotDrawable) != 0;
  });
}

void assemble_lanes(Isa isa, const AssembleJob& job, LaneChunk& chunk) {
  SOFTFOCUS_KERNEL(isa, assemble)(job, chunk);
}

void rasterize_lanes(Isa isa, const LaneChunk& chunk, std::span<const Bin> bins,
                     const DepthState& state, const Profile& profile, VisibilityTile& tile) {
  SOFTFOCUS_KERNEL(isa, rasterize)(chunk, bins, state, profile, tile);
}

void clear_unseen(Isa isa, const VisibilityTile& tile, glm::vec4 value, const Profile& profile) {
  Image row = make_image(Format::rgba16f, kBlockSize, 1);
  clear_image(row, 0, 0, kBlockSize, 1, value, profile);
  SOFTFOCUS_KERNEL(isa, set_unseen)(tile, row.bytes.data());
}

}  // namespace softfocus
