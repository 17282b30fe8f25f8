// Triangle set-up for as many triangles at once as a vector has lanes. The scalar form is
// setup.cpp.

#ifndef SOFTFOCUS_ISA

#include "raster/pipeline/lanes/assemble_lanes.h"

#include <algorithm>
#include <array>
#include <span>

#include "raster/numbers/fixed_point.h"
#include "raster/pipeline/clip.h"
#include "raster/pipeline/multisample.h"

#define SOFTFOCUS_KERNELS "raster/pipeline/lanes/assemble_lanes.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void assemble_lanes(Isa isa, const AssembleJob& job, LaneChunk& chunk) {
  // Where in a pixel a triangle is looked for.
  std::array<glm::ivec2, 1 + kMaxSamples> places;
  const auto append = [](std::span<const glm::ivec2> from, glm::ivec2* to) {
    return std::copy(from.begin(), from.end(), to);
  };
  glm::ivec2* end = append(sample_places(job.samples), places.data());
  if (job.edge_samples > 1) end = append(sample_places(job.edge_samples), end);
  SOFTFOCUS_KERNEL(isa, assemble)(job, {places.data(), end}, chunk);
}

}  // namespace softfocus

#else  // once a vector unit

namespace {

/// The three vertices' values of a quantity.
using Corners = std::array<Floats, 3>;
using IntCorners = std::array<Ints, 3>;

SOFTFOCUS_INLINE Corners gather_corners(const float* column, const IntCorners& rows, Mask mask) {
  return {gather(column, rows[0], mask), gather(column, rows[1], mask),
          gather(column, rows[2], mask)};
}
SOFTFOCUS_INLINE IntCorners gather_corners(const std::int32_t* column, const IntCorners& rows,
                                           Mask mask) {
  return {gather(column, rows[0], mask), gather(column, rows[1], mask),
          gather(column, rows[2], mask)};
}

// is_culled_unsnapped().
SOFTFOCUS_INLINE Mask culled_unsnapped(const AssembleJob& job, const Corners& x, const Corners& y) {
  const Floats area = (x[0] - x[2]) * (y[1] - y[2]) - (y[0] - y[2]) * (x[1] - x[2]);
  const Mask front = job.front_face == FrontFace::clockwise ? area > 0.0f : area < 0.0f;
  return job.cull == Cull::back ? ~front : front;
}

SOFTFOCUS_INLINE void swap_where(Mask mask, Floats& a, Floats& b) {
  const Floats was_a = a;
  a = select(mask, b, a);
  b = select(mask, was_a, b);
}

// The plane of the depths, as PlanesFromOrigin makes it.
SOFTFOCUS_INLINE Corners depth_plane(Corners x, Corners y, Corners depth, Mask clockwise,
                                     std::size_t provoking, float origin) {
  const std::size_t other = provoking == 0 ? 2 : 0;
  swap_where(clockwise, x[1], x[other]);
  swap_where(clockwise, y[1], y[other]);
  swap_where(clockwise, depth[1], depth[other]);
  const Floats dx01 = x[0] - x[1];
  const Floats dy01 = y[0] - y[1];
  const Floats dx20 = x[2] - x[0];
  const Floats dy20 = y[2] - y[0];
  const Floats one_over_area = 1.0f / (dx01 * dy20 - dx20 * dy01);
  const Floats da01 = depth[0] - depth[1];
  const Floats da20 = depth[2] - depth[0];
  const Floats per_x = da01 * (dy20 * one_over_area) - da20 * (dy01 * one_over_area);
  const Floats per_y = da20 * (dx01 * one_over_area) - da01 * (dx20 * one_over_area);
  return {depth[0] - (per_x * (x[0] - origin) + per_y * (y[0] - origin)), per_x, per_y};
}

SOFTFOCUS_INLINE Ints smallest(const IntCorners& v) { return smaller(smaller(v[0], v[1]), v[2]); }
SOFTFOCUS_INLINE Ints largest(const IntCorners& v) { return larger(larger(v[0], v[1]), v[2]); }

struct EdgeLanes {
  IntCorners at_origin, per_x, per_y, threshold;
};

// Whether a sample of a pixel is covered.
SOFTFOCUS_INLINE Mask covers(const EdgeLanes& edges, std::span<const glm::ivec2> places, int x,
                             int y) {
  Mask covered{};
  for (const glm::ivec2& place : places) {
    Ints all_inside{};
    for (std::size_t i = 0; i < 3; ++i) {
      // The slopes are multiples of 256.
      all_inside |=
          edges.at_origin[i] + (x * kSubpixelOne + place.x) * (edges.per_x[i] >> kSubpixelBits) +
          (y * kSubpixelOne + place.y) * (edges.per_y[i] >> kSubpixelBits) - edges.threshold[i];
    }
    covered |= all_inside >= 0;
  }
  return covered;
}

// Triangles between the pixels' samples, as of one sample are half of all that are as small as a
// pixel. Looks only at bounds of at most 2x2 pixels.
SOFTFOCUS_INLINE Mask covers_nothing(const EdgeLanes& edges, std::span<const glm::ivec2> places,
                                     Ints width, Ints height) {
  const Mask in_second_column = width > 1;
  const Mask in_second_row = height > 1;
  const Mask covers_any = covers(edges, places, 0, 0) |
                          (in_second_column & covers(edges, places, 1, 0)) |
                          (in_second_row & covers(edges, places, 0, 1)) |
                          (in_second_column & in_second_row & covers(edges, places, 1, 1));
  return (width <= 2) & (height <= 2) & ~covers_any;
}

// kLanes triangles, to be read one at a time.
struct TriangleColumns {
  alignas(64) std::array<std::array<std::int32_t, kLanes>, 3> edge, slopes, threshold, index;
  alignas(64) std::array<std::array<std::int32_t, kLanes>, 4> bounds;
  alignas(64) std::array<std::array<float, kLanes>, 3> depth;
  alignas(64) std::array<float, kLanes> inverse_area;
  unsigned clockwise;
};

SOFTFOCUS_INLINE void store_to(std::array<std::int32_t, kLanes>& column, Ints v) {
  store(column.data(), v);
}
SOFTFOCUS_INLINE void store_to(std::array<float, kLanes>& column, Floats v) {
  store(column.data(), v);
}

SOFTFOCUS_INLINE void copy_triangle(const TriangleColumns& columns, std::size_t lane,
                                    const AssembleJob& job, LaneTriangle& t) {
#pragma GCC unroll 3
  for (std::size_t i = 0; i < 3; ++i) {
    t.edge[i] = columns.edge[i][lane];
    t.slopes[i] = columns.slopes[i][lane];
    t.depth[i] = columns.depth[i][lane];
    t.thresholds[i] = static_cast<std::int8_t>(columns.threshold[i][lane]);
    const auto vertex = static_cast<std::size_t>(columns.index[i][lane]);
    t.vertices[i] = job.vertices.rows + vertex * job.vertices.stride;
    mark_used(job.vertices, vertex);
  }
#pragma GCC unroll 4
  for (std::size_t i = 0; i < 4; ++i) {
    t.bounds[i] = static_cast<std::int16_t>(columns.bounds[i][lane]);
  }
  t.origin = packed_pixel(t.bounds[0], t.bounds[1]);
  t.inverse_area = columns.inverse_area[lane];
  t.is_large = false;
  t.large = nullptr;
  t.clockwise = (columns.clockwise >> lane & 1u) != 0;
  t.front_facing = t.clockwise == (job.front_face == FrontFace::clockwise);
}

}  // namespace

/// assemble_lanes() on a unit.
void assemble(const AssembleJob& job, std::span<const glm::ivec2> places, LaneChunk& chunk) {
  constexpr std::int32_t kClipBits = (1 << 6) - 1;
  const VertexStore& vertices = job.vertices;
  const bool planes = job.profile->attributes == AttributeSetup::planes_from_origin;
  const int reach = std::max(sample_reach(job.samples), sample_reach(job.edge_samples));
  TriangleColumns columns;

  for (std::size_t begin = job.begin; begin < job.end; begin += kLanes) {
    const Mask active =
        first_lanes(static_cast<int>(std::min<std::size_t>(job.end - begin, kLanes)));
    const auto* first_index = reinterpret_cast<const std::int32_t*>(&job.indices[3 * begin]);
    const Ints third = lane_numbers() * 3;
    IntCorners index;
    for (std::size_t i = 0; i < 3; ++i) {
      index[i] = gather(first_index, third + static_cast<std::int32_t>(i), active);
    }
    const IntCorners codes = gather_corners(vertices.codes, index, active);
    const Ints outside_any = codes[0] | codes[1] | codes[2];
    const Ints outside_all = codes[0] & codes[1] & codes[2];
    const Mask rejected = ((outside_all & (kClipBits | static_cast<std::int32_t>(kNotFinite))) |
                           (outside_any & static_cast<std::int32_t>(kNotFinite))) != 0;
    const Mask clipped = (outside_any & kClipBits) != 0;
    const Mask drawable = (outside_any & static_cast<std::int32_t>(kNotDrawable)) == 0;
    Mask slow = active & ~rejected & clipped;
    Mask kept = active & ~rejected & ~clipped & drawable;
    if (!any(kept | slow)) continue;

    IntCorners x = gather_corners(vertices.snapped_x, index, kept);
    IntCorners y = gather_corners(vertices.snapped_y, index, kept);
    const Ints x_min = smallest(x), x_max = largest(x);
    const Ints y_min = smallest(y), y_max = largest(y);
    const Ints x_begin = larger((x_min - reach + 255) >> kSubpixelBits, splat(job.clip.x_begin));
    const Ints y_begin = larger((y_min - reach + 255) >> kSubpixelBits, splat(job.clip.y_begin));
    const Ints x_end = smaller(((x_max + reach) >> kSubpixelBits) + 1, splat(job.clip.x_end));
    const Ints y_end = smaller(((y_max + reach) >> kSubpixelBits) + 1, splat(job.clip.y_end));
    kept &= (x_begin < x_end) & (y_begin < y_end);
    const Mask small = (x_max - x_min <= kSmallExtent) & (y_max - y_min <= kSmallExtent);
    slow |= kept & ~small;
    kept &= small;
    // The other lanes would overflow below.
    for (std::size_t i = 0; i < 3; ++i) {
      x[i] = select(kept, x[i], Ints{});
      y[i] = select(kept, y[i], Ints{});
    }

    const Ints area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
    const Mask clockwise = area > 0;
    kept &= area != 0;
    if (job.cull != Cull::none) {
      const bool front_is_clockwise = job.front_face == FrontFace::clockwise;
      const bool keeps_clockwise = front_is_clockwise == (job.cull == Cull::back);
      kept &= keeps_clockwise ? clockwise : ~clockwise;
    }
    Corners window_x{}, window_y{};
    if (planes || job.cull_unsnapped) {
      window_x = gather_corners(vertices.x, index, kept);
      window_y = gather_corners(vertices.y, index, kept);
    }
    if (job.cull_unsnapped) kept &= ~culled_unsnapped(job, window_x, window_y);
    if (!any(kept | slow)) continue;

    EdgeLanes edges;
#pragma GCC unroll 3
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t from = (i + 1) % 3;
      const std::size_t to = (i + 2) % 3;
      const Ints dx = select(clockwise, x[to] - x[from], x[from] - x[to]);
      const Ints dy = select(clockwise, y[to] - y[from], y[from] - y[to]);
      edges.per_x[i] = -dy * kSubpixelOne;
      edges.per_y[i] = dx * kSubpixelOne;
      edges.at_origin[i] =
          dy * (x[from] - x_begin * kSubpixelOne) - dx * (y[from] - y_begin * kSubpixelOne);
      const Mask level_owns = job.profile->fill_rule == FillRule::upper_left ? dx > 0 : dx < 0;
      const Mask owns = (dy < 0) | ((dy == 0) & level_owns);
      edges.threshold[i] = owns + 1;
    }
    kept &= ~covers_nothing(edges, places, x_end - x_begin, y_end - y_begin);
    const unsigned kept_bits = lane_bits(kept);
    if ((kept_bits | lane_bits(slow)) == 0) continue;

    if (kept_bits != 0) {
      for (std::size_t i = 0; i < 3; ++i) {
        // packed_slopes().
        store_to(columns.slopes[i], (edges.per_x[i] >> 8 & 0xFFFF) | (edges.per_y[i] >> 8) << 16);
        store_to(columns.edge[i], edges.at_origin[i]);
        store_to(columns.threshold[i], edges.threshold[i]);
        store_to(columns.index[i], index[i]);
      }
      store_to(columns.bounds[0], x_begin);
      store_to(columns.bounds[1], y_begin);
      store_to(columns.bounds[2], x_end);
      store_to(columns.bounds[3], y_end);
      const Ints positive_area = select(clockwise, area, -area);
      store_to(columns.inverse_area, 1.0f / to_floats(positive_area));
      columns.clockwise = lane_bits(clockwise);

      const Corners depth = gather_corners(vertices.depth, index, kept);
      const Corners fields = planes ? depth_plane(window_x, window_y, depth, clockwise,
                                                  job.provoking, job.samples == 1 ? 0.5f : 0.0f)
                                    : Corners{depth[0], depth[1] - depth[0], depth[2] - depth[0]};
      for (std::size_t i = 0; i < 3; ++i) {
        store_to(columns.depth[i], fields[i]);
      }
    }
    // In the order of submission, which decides between equal depths.
    for (unsigned bits = kept_bits | lane_bits(slow); bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::size_t>(__builtin_ctz(bits));
      if ((kept_bits >> lane & 1u) != 0) {
        copy_triangle(columns, lane, job, next_triangle(chunk));
      } else {
        job.add_slowly(job, chunk, begin + lane);
      }
    }
  }
}

#endif
