#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).
// Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/half_resolution/merge_fields.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "raster/threads/loops.h"

namespace softfocus {

// The planes that are enlarged: the far field's colour and weight, the near one's colour and
// opacity.
inline constexpr int kMergedPlanes[] = {kFarColour,      kFarColour + 1, kFarColour + 2,
                                        kFarWeight,      kNearColour,    kNearColour + 1,
                                        kNearColour + 2, kNearOpacity};
inline constexpr int kMergedFar = 0, kMergedWeight = 3, kMergedNear = 4, kMergedOpacity = 7;
inline constexpr int kAllMerged = 8;

// Planes of a row of pixels, sharp: red, green, blue, radius. The first three become the result.
struct MergeRow {
  float* pixels;
  std::ptrdiff_t pixel_plane;
  int count;  // of cells
  // The cells' row between two of them, from one before the first on.
  const float* blurred;
  std::ptrdiff_t blurred_plane;
  bool near_field;
  float* clear;  // gets 1 - opacity
};

// Three rows of pixels, planes as above, with one pixel more at either end.
struct SoftenRow {
  const float* rows[3];
  std::ptrdiff_t plane;
  int count;
  float* to;
  std::ptrdiff_t to_plane;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/half_resolution/merge_fields.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kMergeRows = 8;

struct Scratch {
  std::vector<float> sharp;  // rows of pixels from one above the task's first on
  std::vector<float> pixels, blurred, sums;
  HighlightScratch highlights;
};

// Three quarters of the row of cells that y lies in, and a quarter of the next.
void blend_rows(const Planes& blurred, int count, int y, float* to, std::ptrdiff_t plane, Isa isa) {
  const int inside = y / 2;
  const int other = std::clamp(y % 2 == 0 ? inside - 1 : inside + 1, 0, blurred.height - 1);
  for (int i = 0; i < count; ++i, to += plane) {
    const int c = kMergedPlanes[i];
    SOFTFOCUS_KERNEL(isa, blend_row)
    (plane_row(blurred, c, inside), plane_row(blurred, c, other), blurred.width, to + kMostLanes);
    to[kMostLanes - 1] = to[kMostLanes];
    to[kMostLanes + blurred.width] = to[kMostLanes + blurred.width - 1];
  }
}

void add_highlights(const Highlights& highlights, int y, int width, const float* clear,
                    float* pixels, std::ptrdiff_t plane, Scratch& scratch) {
  scratch.sums.resize(static_cast<std::size_t>(3 * kHighlightLayers * plane));
  const std::uint32_t used =
      highlight_row(highlights, y, width, scratch.highlights, scratch.sums.data(), plane);
  for (int layer = 0; layer < kHighlightLayers; ++layer) {
    if ((used >> layer & 1u) == 0) continue;
    const float* light = scratch.sums.data() + 3 * layer * plane;
    for (int x = 0; x < width; ++x) {
      const float through = layer == kHighlightNear ? 1.0f : clear[x];
      const float shown = through * highlight_visible(layer, pixels[3 * plane + x]);
      for (int c = 0; c < 3; ++c) pixels[c * plane + x] += shown * light[c * plane + x];
    }
  }
}

// A row of pixels without highlights, with the first repeated before it.
void sharp_row(const DofInput& input, const Highlights& highlights, int y, float* to,
               std::ptrdiff_t plane, std::ptrdiff_t padded, Isa isa) {
  split_picture_row(input, y, to, plane, static_cast<int>(padded), isa);
  for (const Highlight& light : highlights.rows[static_cast<std::size_t>(y)]) {
    for (int c = 0; c < 3; ++c) to[c * plane + light.x] -= light.excess[c];
  }
  const int last = input.scene.width - 1;
  for (int c = 0; c < 4; ++c) {
    to[c * plane - 1] = to[c * plane];
    to[c * plane + last + 1] = to[c * plane + last];
  }
}

}  // namespace

void merge_fields(const DofInput& input, const HalfFields& fields, const ImageView& result,
                  ThreadPool& pool) {
  const Planes& blurred = fields.cells;
  const int width = input.scene.width, height = input.scene.height;
  const Highlights& highlights = fields.highlights;
  const std::ptrdiff_t padded = plane_stride(width) + 2 * kMostLanes;
  const std::ptrdiff_t half_padded = plane_stride(blurred.width) + 3 * kMostLanes;
  for_each_band_with<Scratch>(pool, height, kMergeRows, [&](int first, int end, auto& scratch) {
    scratch.pixels.resize(static_cast<std::size_t>(5 * padded));
    scratch.blurred.resize(static_cast<std::size_t>(kAllMerged * half_padded));
    const std::ptrdiff_t sharp_plane = padded + 2 * kMostLanes;
    scratch.sharp.resize(static_cast<std::size_t>((kMergeRows + 2) * 4 * sharp_plane));
    const auto sharp = [&](int y) {
      return scratch.sharp.data() + (y - first + 1) * 4 * sharp_plane + kMostLanes;
    };
    for (int y = first - 1; y <= end; ++y) {
      sharp_row(input, highlights, std::clamp(y, 0, height - 1), sharp(y), sharp_plane, padded,
                pool.isa());
    }
    for (int y = first; y < end; ++y) {
      float* pixels = scratch.pixels.data();
      const SoftenRow soft{
          {sharp(y - 1), sharp(y), sharp(y + 1)}, sharp_plane, width, pixels, padded};
      SOFTFOCUS_KERNEL(pool.isa(), soften_row)(soft);
      blend_rows(blurred, fields.near_field ? kAllMerged : kMergedNear, y, scratch.blurred.data(),
                 half_padded, pool.isa());
      float* clear = pixels + 4 * padded;
      const MergeRow row{pixels,        padded,
                         blurred.width, scratch.blurred.data() + kMostLanes,
                         half_padded,   fields.near_field,
                         clear};
      SOFTFOCUS_KERNEL(pool.isa(), merge_half_row)(row);
      if (highlights.reach >= 0) {
        add_highlights(highlights, y, width, clear, pixels, padded, scratch);
      }
      store_row(input, result, y, pixels, pixels + padded, pixels + 2 * padded, pool.isa());
    }
  });
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

// How much of the neighbour at an offset, of weight `k`, comes into a pixel of radius r.
SOFTFOCUS_INLINE Floats neighbour_share(Floats k, Floats radius, Floats per_square, Floats other) {
  const Floats spread = smaller(other * other * per_square, splat(1.0f));
  return k * (spread * saturate(2.0f - absolute(other - radius)));
}

// kLanes cells as 2 kLanes pixels.
SOFTFOCUS_INLINE TwoVectors enlarge(const float* cells) {
  const Floats own = load(cells);
  return zip(own + (load(cells - 1) - own) * 0.25f, own + (load(cells + 1) - own) * 0.25f);
}

}  // namespace

void soften_row(const SoftenRow& row) {
  for (int x = 0; x < row.count; x += kLanes) {
    const float* own = row.rows[1] + x;
    const Floats radius = load(own + 3 * row.plane);
    const Floats square = radius * radius;
    // The variance along an axis, twice that of either neighbour's weight.
    const Floats variance = larger(smaller((square - 0.25f) * 0.25f, splat(0.5f)), splat(0.0f));
    Floats out[3];
    for (int c = 0; c < 3; ++c) out[c] = load(own + c * row.plane);
    // From radius 2 on nothing sharp is seen behind the focus, and from 3 before it.
    if (any((variance > 0.0f) & (square < 9.0f))) {
      const Floats side = variance * 0.5f, middle = 1.0f - variance;
      const Floats corner = side * side, edge = side * middle;
      const Floats per_square = 1.0f / larger(square, splat(0.25f));
      Floats pairs[4][3];
      // Opposite neighbours in pairs, so that a mirrored picture has the same sums.
      const int dx[] = {-1, 1, 0, 1}, dy[] = {0, -1, 1, 1};
      for (int i = 0; i < 4; ++i) {
        const float* p = row.rows[1 - dy[i]] + x - dx[i];
        const float* q = row.rows[1 + dy[i]] + x + dx[i];
        const Floats k = dx[i] == 0 || dy[i] == 0 ? edge : corner;
        const Floats of_p = neighbour_share(k, radius, per_square, load(p + 3 * row.plane));
        const Floats of_q = neighbour_share(k, radius, per_square, load(q + 3 * row.plane));
        for (int c = 0; c < 3; ++c) {
          pairs[i][c] =
              of_p * (load(p + c * row.plane) - out[c]) + of_q * (load(q + c * row.plane) - out[c]);
        }
      }
      for (int c = 0; c < 3; ++c) {
        const Floats more = (pairs[0][c] + pairs[2][c]) + (pairs[1][c] + pairs[3][c]);
        out[c] = select(variance > 0.0f, out[c] + more, out[c]);
      }
    }
    for (int c = 0; c < 3; ++c) store(row.to + c * row.to_plane + x, out[c]);
    store(row.to + 3 * row.to_plane + x, radius);
  }
}

void blend_row(const float* own, const float* other, int count, float* to) {
  for (int x = 0; x < count; x += kLanes) {
    const Floats here = load(own + x);
    store(to + x, here + (load(other + x) - here) * 0.25f);
  }
}

namespace {

SOFTFOCUS_INLINE void merge_vector(float* pixels, std::ptrdiff_t plane, const Floats* blurred,
                                   bool near_field, float* clear) {
  const Floats radius = load(pixels + 3 * plane);
  const Mask nearer = radius < 0.0f;
  const Floats share = select(nearer, saturate(-radius - 2.0f),
                              saturate((radius * radius - 2.25f) * (1.0f / 1.75f)));
  const Floats through = near_field ? 1.0f - blurred[kMergedOpacity] : splat(1.0f);
  const Floats per_weight = 1.0f / blurred[kMergedWeight];
  for (int c = 0; c < 3; ++c) {
    const Floats sharp = load(pixels + c * plane);
    const Floats far = blurred[kMergedFar + c] * per_weight;
    Floats out = select(share > 0.0f, mix(sharp, far, share), sharp);
    if (near_field) {
      out = select(through < 1.0f, blurred[kMergedNear + c] + through * out, out);
    }
    store(pixels + c * plane, out);
  }
  store(clear, through);
}

}  // namespace

void merge_half_row(const MergeRow& row) {
  const int planes = row.near_field ? kAllMerged : kMergedNear;
  for (int x = 0; x < row.count; x += kLanes) {
    Floats lower[kAllMerged] = {}, upper[kAllMerged] = {};
    for (int c = 0; c < planes; ++c) {
      const TwoVectors both = enlarge(row.blurred + c * row.blurred_plane + x);
      lower[c] = both.first;
      upper[c] = both.second;
    }
    float* pixels = row.pixels + 2 * x;
    merge_vector(pixels, row.pixel_plane, lower, row.near_field, row.clear + 2 * x);
    merge_vector(pixels + kLanes, row.pixel_plane, upper, row.near_field,
                 row.clear + 2 * x + kLanes);
  }
}

#endif
