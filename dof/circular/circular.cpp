#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).
// There is no scalar form: Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/circular/circular.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dof/half_resolution/half_fields.h"
#include "dof/half_resolution/merge_fields.h"
#include "dof/picture_planes.h"
#include "raster/numbers/exact_math.h"
#include "raster/threads/loops.h"

namespace softfocus {

struct CircularComponent {
  float real_factor;       // A
  float imaginary_factor;  // B
  const float* real;       // k(1) by radius in sixteenths of a pixel
  const float* imaginary;
};

// A row of receivers and their neighbours. `taps[d]`, for d from -reach to reach, points at
// the first receiver's neighbour at distance d, in the first of the planes: the values, the
// size, and in the far field the size that counts.
struct CircularRow {
  const float* const* taps;
  std::ptrdiff_t plane;
  int reach;
  int count;  // of receivers

  CircularComponent components[2];
  const float* weight;  // of the far field's receivers, for the second pass
  float* result;
  std::ptrdiff_t result_plane;
};

// The cut of one component and of two, in radii.
constexpr float kCircularCut[] = {1.2f / 1.085f, 1.2f / 1.11f};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/circular/circular.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kCircularTaskRows = 8;

struct ComplexGaussian {
  double a, b, real_factor, imaginary_factor;
};
constexpr ComplexGaussian kOne[] = {{.862325, 1.624835, .767583, 1.862321}};
constexpr ComplexGaussian kTwo[] = {{.886528, 5.268909, .411259, -.548794},
                                    {1.960518, 1.558213, .513282, 4.56111}};
// The radius, in the kernel's units, of the disc nearest to the cut kernel.
constexpr double kEdges[] = {1.085, 1.11};

// k(1) of a component, for radii in sixteenths of a pixel.
struct Table {
  std::vector<float> real, imaginary;
};

Table make_table(const ComplexGaussian& gaussian, double edge, float largest_px) {
  const double log2_of_e = 1.4426950408889634;
  const int count = static_cast<int>(largest_px * 16.0f + 0.5f) + 1;
  Table table;
  for (int i = 0; i < count; ++i) {
    const double x = edge / (std::max(i, 1) / 16.0);
    const double size = exact_math::exp2(-gaussian.a * x * x * log2_of_e);
    const double degrees = gaussian.b * x * x * (180.0 / exact_math::kPi);
    table.real.push_back(static_cast<float>(size * exact_math::cos_degrees(degrees)));
    table.imaginary.push_back(static_cast<float>(size * exact_math::sin_degrees(degrees)));
  }
  return table;
}

// A field's places in HalfFields: colour, size and weight or opacity.
struct CircularField {
  bool near;
  int colour, size, share;
  int values() const { return near ? 4 : 3; }
  // Between the passes: complex values, the size, and of the far field the size that counts.
  int planes(int components) const { return 2 * values() * components + (near ? 1 : 2); }
};
constexpr CircularField kFarField{false, kFarColour, kFarSize, kFarWeight};
constexpr CircularField kNearField{true, kNearColour, kNearSize, kNearOpacity};

struct CircularScratch {
  std::vector<float> values;
  std::vector<const float*> taps;
};

struct Circular {
  HalfFields& fields;  // blurred in place by the second pass
  const HalfTiles& tiles;
  CircularRow pattern;
  int components;
  Planes& across;

  int rows() const { return fields.cells.height; }
  int columns() const { return fields.cells.width; }
};

// Runs of cells in a row of tiles that the field reaches; the others are cleared.
template <class Blur>
void for_each_run(const Circular& all, CircularField field, int y, float* to, std::ptrdiff_t plane,
                  int planes, const Blur& blur) {
  if (!field.near) return blur(0, all.columns());
  const auto reached = [&](int column) {
    return all.tiles.near_reach[all.tiles.at(column, y / kHalfTile)] > 0.0f;
  };
  for (int first = 0, end = 0; first < all.tiles.columns; first = end) {
    for (end = first + 1; end < all.tiles.columns && reached(end) == reached(first);) ++end;
    const int x = first * kHalfTile;
    const int count = std::min(end * kHalfTile, all.columns()) - x;
    if (reached(first)) {
      blur(x, count);
    } else {
      for (int c = 0; c < planes; ++c) std::fill_n(to + c * plane + x, count, 0.0f);
    }
  }
}

// A row of the field with its ends repeated for `reach` cells and two vectors.
void pad_row(const Circular& all, CircularField field, int y, std::ptrdiff_t padded, float* to) {
  const int reach = all.pattern.reach, width = all.columns();
  const Planes& cells = all.fields.cells;
  const auto repeat_ends = [&](float* row) {
    std::fill_n(row, reach, row[reach]);
    std::fill(row + reach + width, row + padded, row[reach + width - 1]);
  };
  for (int c = 0; c < field.values(); ++c) {
    std::copy_n(plane_row(cells, c < 3 ? field.colour + c : field.share, y), width,
                to + c * padded + reach);
    repeat_ends(to + c * padded);
  }
  float* size = to + field.values() * padded;
  std::copy_n(plane_row(cells, field.size, y), width, size + reach);
  repeat_ends(size);
  if (field.near) return;
  const float* weight = plane_row(cells, field.share, y);
  float* counts = size + padded;
  for (int x = 0; x < width; ++x) counts[reach + x] = size[reach + x] * weight[x];
  repeat_ends(counts);
}

void blur_across(const Circular& all, CircularField field, int y, CircularScratch& scratch,
                 Isa isa) {
  const int reach = all.pattern.reach;
  const std::ptrdiff_t padded = all.columns() + 2 * reach + 2 * kMostLanes;
  scratch.values.resize(static_cast<std::size_t>(5 * padded));
  scratch.taps.resize(static_cast<std::size_t>(2 * reach + 1));
  pad_row(all, field, y, padded, scratch.values.data());
  float* to = plane_row(all.across, 0, y);
  const auto blur = [&](int x, int count) {
    for (int d = -reach; d <= reach; ++d) {
      scratch.taps[static_cast<std::size_t>(d + reach)] = scratch.values.data() + reach + x + d;
    }
    CircularRow row = all.pattern;
    row.taps = scratch.taps.data() + reach;
    row.plane = padded;
    row.count = count;
    row.result = to + x;
    row.result_plane = all.across.plane;
    SOFTFOCUS_KERNEL(isa, circular_across)(row, all.components, field.near);
  };
  for_each_run(all, field, y, to, all.across.plane, field.planes(all.components), blur);
}

void blur_down(const Circular& all, CircularField field, int y, CircularScratch& scratch, Isa isa) {
  const int reach = all.pattern.reach;
  scratch.taps.resize(static_cast<std::size_t>(2 * reach + 1));
  Planes& cells = all.fields.cells;
  float* to = plane_row(cells, field.colour, y);
  const auto blur = [&](int x, int count) {
    for (int d = -reach; d <= reach; ++d) {
      scratch.taps[static_cast<std::size_t>(d + reach)] =
          plane_row(std::as_const(all.across), 0, std::clamp(y + d, 0, all.rows() - 1)) + x;
    }
    CircularRow row = all.pattern;
    row.taps = scratch.taps.data() + reach;
    row.plane = all.across.plane;
    row.count = count;
    row.weight = plane_row(cells, kFarWeight, y) + x;
    row.result = to + x;
    row.result_plane = cells.plane;
    SOFTFOCUS_KERNEL(isa, circular_down)(row, all.components, field.near);
  };
  // Cells out of reach have no colour and no opacity.
  for_each_run(all, field, y, to, cells.plane, 0, blur);
}

void blur_field(const Circular& all, CircularField field, ThreadPool& pool) {
  for (const auto blur : {blur_across, blur_down}) {
    for_each_row_with<CircularScratch>(
        pool, all.rows(), kCircularTaskRows,
        [&](int y, auto& scratch) { blur(all, field, y, scratch, pool.isa()); });
  }
}

void circular(const DofInput& input, const ImageView& result, int components, ThreadPool& pool) {
  const float cut = kCircularCut[components - 1];
  HalfFields fields = make_half_fields(input, pool);
  const HalfTiles tiles = make_half_tiles(fields, cut, true, pool);
  const float largest =
      std::max(*std::max_element(tiles.far_reach.begin(), tiles.far_reach.end()),
               *std::max_element(tiles.near_reach.begin(), tiles.near_reach.end()));
  std::array<Table, 2> tables;
  CircularRow pattern{};
  for (int c = 0; c < components; ++c) {
    const ComplexGaussian& gaussian = components == 1 ? kOne[c] : kTwo[c];
    Table& table = tables[static_cast<std::size_t>(c)];
    table = make_table(gaussian, kEdges[components - 1], largest);
    pattern.components[c] = {static_cast<float>(gaussian.real_factor),
                             static_cast<float>(gaussian.imaginary_factor), table.real.data(),
                             table.imaginary.data()};
  }
  pattern.reach = static_cast<int>(largest * cut + 0.5f);
  // One after the other, the fields share the memory between the passes.
  const Planes& cells = fields.cells;
  const int planes = (fields.near_field ? kNearField : kFarField).planes(components);
  Planes across =
      make_planes(std::max(planes, kFarField.planes(components)), cells.width, cells.height, pool);
  const Circular all{fields, tiles, pattern, components, across};
  blur_field(all, kFarField, pool);
  if (fields.near_field) blur_field(all, kNearField, pool);
  merge_fields(input, fields, result, pool);
}

}  // namespace

void circular_one(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  circular(input, result, 1, pool);
}
void circular_two(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  circular(input, result, 2, pool);
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

struct Complexes {
  Floats re, im;
};
SOFTFOCUS_INLINE Complexes product(Complexes a, Complexes b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

SOFTFOCUS_INLINE float largest_lane(Floats v) {
  float lanes[kLanes];
  store(lanes, v);
  float largest = 0.0f;
  for (int i = 0; i < kLanes; ++i) largest = lanes[i] > largest ? lanes[i] : largest;
  return largest;
}

// Stores the first `count` lanes, all if there are more: what lies beyond may be done already.
SOFTFOCUS_INLINE void store_in(float* to, Floats v, int count) {
  if (count >= kLanes) return store(to, v);
  float lanes[kLanes];
  store(lanes, v);
  for (int i = 0; i < count; ++i) to[i] = lanes[i];
}

// How far a neighbour counts. `twice_inverse` is 2 / the receiver's size.
SOFTFOCUS_INLINE Floats share_of(Floats counts, Floats twice_inverse) {
  return smaller(counts * twice_inverse, splat(1.0f));
}

// The first pass gathers real values for every component, the second each component's complex
// ones.
template <bool across, int components, bool near>
SOFTFOCUS_INLINE void gather_circular(const CircularRow& row) {
  constexpr int kReals = near ? 4 : 3;
  constexpr int kValues = across ? kReals : 2 * kReals;  // of one component
  constexpr int kSize = across ? kReals : 2 * kReals * components;
  constexpr int kCounts = kSize + 1;
  for (int x = 0; x < row.count; x += kLanes) {
    const float* own = row.taps[0] + x;
    const Floats size = load(own + kSize * row.plane);
    // Beyond the row lies nothing that has been written.
    const Mask blurred = (size > 0.5f) & first_lanes(row.count - x);
    const Floats cut = size * kCircularCut[components - 1] + 0.5f;
    const Floats twice_inverse = 2.0f / larger(size, splat(0.5f));
    const int limit = static_cast<int>(largest_lane(select(blurred, cut, splat(0.0f))));
    const int reach = limit < row.reach ? limit : row.reach;
    const Ints entry = truncate(size * 16.0f + 0.5f);
    Floats top[kReals] = {}, bottom = splat(0.0f);
    for (int c = 0; c < components; ++c) {
      const std::ptrdiff_t first = across ? 0 : kValues * c * row.plane;
      const Complexes one{gather(row.components[c].real, entry, blurred),
                          gather(row.components[c].imaginary, entry, blurred)};
      const Complexes step = product(one, one);
      Complexes k = one, next = product(step, one), sum{splat(1.0f), splat(0.0f)};
      Floats here[kValues], values[2 * kReals] = {};
      for (int i = 0; i < kValues; ++i) here[i] = load(own + first + i * row.plane);
      // The real parts are the even values.
      for (int i = 0; i < kValues; ++i) values[across ? 2 * i : i] = here[i];
      for (int d = 1; d <= reach; ++d) {
        const Floats weight = saturate(cut - static_cast<float>(d));
        const Complexes weighed{k.re * weight, k.im * weight};
        const float* before = row.taps[-d] + x;
        const float* after = row.taps[d] + x;
        Floats share_before = splat(1.0f), share_after = splat(1.0f);
        if (!near) {
          share_before = share_of(load(before + kCounts * row.plane), twice_inverse);
          share_after = share_of(load(after + kCounts * row.plane), twice_inverse);
        }
        Floats both[kValues];
        for (int i = 0; i < kValues; ++i) {
          const Floats p = load(before + first + i * row.plane);
          const Floats q = load(after + first + i * row.plane);
          both[i] = near ? p + q
                         : (here[i] + share_before * (p - here[i])) +
                               (here[i] + share_after * (q - here[i]));
        }
        for (int i = 0; i < kReals; ++i) {
          if constexpr (across) {
            values[2 * i] = values[2 * i] + weighed.re * both[i];
            values[2 * i + 1] = values[2 * i + 1] + weighed.im * both[i];
          } else {
            const Complexes more = product(weighed, {both[2 * i], both[2 * i + 1]});
            values[2 * i] = values[2 * i] + more.re;
            values[2 * i + 1] = values[2 * i + 1] + more.im;
          }
        }
        sum.re = sum.re + (weighed.re + weighed.re);
        sum.im = sum.im + (weighed.im + weighed.im);
        k = product(k, next);
        next = product(next, step);
      }
      if constexpr (across) {
        const Floats inverse = 1.0f / (sum.re * sum.re + sum.im * sum.im);
        const Complexes scale{sum.re * inverse, -(sum.im * inverse)};
        for (int i = 0; i < kReals; ++i) {
          const Complexes mean = product({values[2 * i], values[2 * i + 1]}, scale);
          float* to = row.result + (2 * kReals * c + 2 * i) * row.result_plane + x;
          store_in(to, select(blurred, mean.re, here[i]), row.count - x);
          store_in(to + row.result_plane, select(blurred, mean.im, splat(0.0f)), row.count - x);
        }
      } else {
        const Complexes factor = product(
            {splat(row.components[c].real_factor), splat(-row.components[c].imaginary_factor)},
            sum);
        for (int i = 0; i < kReals; ++i) {
          top[i] = top[i] + product(factor, {values[2 * i], values[2 * i + 1]}).re;
        }
        bottom = bottom + product(factor, sum).re;
      }
    }
    if constexpr (across) {
      float* to = row.result + 2 * kReals * components * row.result_plane + x;
      store_in(to, size, row.count - x);
      if (!near) store_in(to + row.result_plane, load(own + kCounts * row.plane), row.count - x);
    } else {
      Floats out[4];
      for (int i = 0; i < kReals; ++i) {
        // Negative parts of the kernel leave less than nothing beside bright light.
        out[i] =
            larger(select(blurred, top[i] / bottom, load(own + 2 * i * row.plane)), splat(0.0f));
      }
      const Floats opacity = smaller(near ? out[kReals - 1] : load(row.weight + x), splat(1.0f));
      const Floats scale =
          !near ? opacity : select(out[kReals - 1] > 0.0f, opacity / out[kReals - 1], splat(0.0f));
      for (int i = 0; i < 3; ++i) {
        store_in(row.result + i * row.result_plane + x, out[i] * scale, row.count - x);
      }
      if (near) store_in(row.result + 3 * row.result_plane + x, opacity, row.count - x);
    }
  }
}

}  // namespace

void circular_across(const CircularRow& row, int components, bool near) {
  if (near) {
    components == 1 ? gather_circular<true, 1, true>(row) : gather_circular<true, 2, true>(row);
  } else {
    components == 1 ? gather_circular<true, 1, false>(row) : gather_circular<true, 2, false>(row);
  }
}
void circular_down(const CircularRow& row, int components, bool near) {
  if (near) {
    components == 1 ? gather_circular<false, 1, true>(row) : gather_circular<false, 2, true>(row);
  } else {
    components == 1 ? gather_circular<false, 1, false>(row) : gather_circular<false, 2, false>(row);
  }
}

#endif
