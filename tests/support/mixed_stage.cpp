#ifndef SOFTFOCUS_ISA

#include "tests/support/mixed_stage.h"

#include <algorithm>
#include <cstring>

#include "raster/numbers/fixed_point.h"

#define SOFTFOCUS_KERNELS "tests/support/mixed_stage.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus::test {

LaneStages<ListedVertices<4>, MixedColour> mixed_stages(Isa isa) {
  return {SOFTFOCUS_KERNEL(isa, place_listed), SOFTFOCUS_KERNEL(isa, shade_listed),
          SOFTFOCUS_KERNEL(isa, shade_mixed)};
}

}  // namespace softfocus::test

#else  // once a vector unit

#include "raster/pipeline/lanes/block_lanes.inl"
#include "raster/pipeline/lanes/edge_lanes.inl"
#include "raster/pipeline/lanes/interpolate_lanes.inl"
#include "raster/pipeline/lanes/shade_lanes.inl"
#include "raster/pipeline/lanes/vertex_lanes.inl"

namespace {

struct ListedLanes {
  static constexpr std::size_t kVaryings = 4;
  const std::vector<VertexOutput<4> >& list;

  void position(Ints index, std::array<Floats, 4>& in_clip_space) const {
    for (int lane = 0; lane < kLanes; ++lane) {
      const VertexOutput<4>& vertex = list[static_cast<std::size_t>(index[lane])];
      for (int i = 0; i < 4; ++i) {
        in_clip_space[static_cast<std::size_t>(i)][lane] = vertex.position[i];
      }
    }
  }
  void operator()(Ints index, std::array<Floats, 4>& in_clip_space,
                  std::array<Floats, 4>& varyings) const {
    position(index, in_clip_space);
    for (int lane = 0; lane < kLanes; ++lane) {
      const VertexOutput<4>& vertex = list[static_cast<std::size_t>(index[lane])];
      for (int i = 0; i < 4; ++i) {
        varyings[static_cast<std::size_t>(i)][lane] = vertex.varyings[static_cast<std::size_t>(i)];
      }
    }
  }
};

struct MixedLanes {
  static constexpr auto kInterpolation = test::MixedColour::kInterpolation;
  static constexpr std::size_t kInputs = 4;

  template <class Quads, class Put>
  void inputs(const Quads& in, const Put& put) const {
    put(0, in.varying(0) + in.ddx(0));
    put(1, in.varying(1) - in.ddy(0));
    put(2, select(in.front_facing(), in.varying(2), -in.varying(2)));
    put(3, in.varying(3) + in.ddx(1));
  }
  void shade(const FragmentBatch<4>& batch, std::array<Floats, 4>* colours) const {
    for (int i = 0; i < batch.vectors(); ++i) {
      colours[i] = {batch.input(0, i), batch.input(1, i), batch.input(2, i), batch.input(3, i)};
    }
  }
};

}  // namespace

unsigned place_listed(const test::ListedVertices<4>& stage, const VertexJob& job) {
  return place_vertices(ListedLanes{*stage.list}, job);
}

void shade_listed(const test::ListedVertices<4>& stage, const VertexJob& job) {
  shade_vertices(ListedLanes{*stage.list}, job);
}

void shade_mixed(const test::MixedColour&, const FragmentJob& job, const VisibilityTile& tile,
                 const VisibleRun& run) {
  shade_fragments(MixedLanes{}, job, tile, run);
}

#endif
