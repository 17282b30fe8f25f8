#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).
// There is no scalar form: Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/methods/circular_separable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/numbers/exact_math.h"
#include "raster/threads/scratch_shelf.h"

namespace softfocus {

struct CircularComponent {
  float real_factor;       // A
  float imaginary_factor;  // B
  const float* real;       // k(1) by radius in sixteenths of a pixel
  const float* imaginary;
};

// A row of receivers and their neighbours. `taps[d]`, for d from -reach to reach, points at
// the first receiver's neighbour at distance d, in the first of the planes: the values, then
// the radius.
struct CircularRow {
  const float* const* taps;
  std::ptrdiff_t plane;
  int reach;
  int count;  // of receivers

  CircularComponent components[2];
  float* result;
  std::ptrdiff_t result_plane;
};

// The cut of one component and of two, in radii.
constexpr float kCircularCut[] = {1.2f / 1.085f, 1.2f / 1.11f};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/methods/circular_separable.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kTaskRows = 8;

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

struct RowScratch {
  std::vector<float> values;
  std::vector<const float*> taps;
};

void circular(const DofInput& input, const ImageView& result, int components, ThreadPool& pool) {
  const Planes scene = split_picture(input, pool);
  const std::vector<float> of_rows = largest_of_rows(scene, 3, pool);
  const float largest = *std::max_element(of_rows.begin(), of_rows.end());
  const int reach = static_cast<int>(largest * kCircularCut[components - 1] + 0.5f);

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
  pattern.reach = reach;
  pattern.count = scene.width;

  const int values = 6 * components + 1;
  Planes across = make_planes(values, scene.width, scene.height);
  ScratchShelf<RowScratch> shelf;
  const int tasks = (scene.height + kTaskRows - 1) / kTaskRows;
  const std::ptrdiff_t padded = scene.width + 2 * reach + 2 * kMostLanes;
  pool.for_each(tasks, [&](int task) {
    RowScratch scratch = shelf.take();
    scratch.values.resize(static_cast<std::size_t>(4 * padded));
    scratch.taps.resize(static_cast<std::size_t>(2 * reach + 1));
    for (int d = -reach; d <= reach; ++d) {
      scratch.taps[static_cast<std::size_t>(d + reach)] = scratch.values.data() + reach + d;
    }
    for (int y = task * kTaskRows; y < std::min((task + 1) * kTaskRows, scene.height); ++y) {
      for (int c = 0; c < 4; ++c) {
        const float* from = plane_row(scene, c, y);
        float* to = scratch.values.data() + c * padded;
        std::fill_n(to, reach, from[0]);
        std::copy_n(from, scene.width, to + reach);
        std::fill(to + reach + scene.width, to + padded, from[scene.width - 1]);
      }
      CircularRow row = pattern;
      row.taps = scratch.taps.data() + reach;
      row.plane = padded;
      row.result = plane_row(across, 0, y);
      row.result_plane = across.plane;
      SOFTFOCUS_KERNEL(pool.isa(), circular_across)(row, components);
    }
    shelf.put_back(std::move(scratch));
  });
  pool.for_each(tasks, [&](int task) {
    RowScratch scratch = shelf.take();
    const std::ptrdiff_t length = across.stride;
    scratch.values.resize(static_cast<std::size_t>(3 * length));
    scratch.taps.resize(static_cast<std::size_t>(2 * reach + 1));
    for (int y = task * kTaskRows; y < std::min((task + 1) * kTaskRows, scene.height); ++y) {
      for (int d = -reach; d <= reach; ++d) {
        scratch.taps[static_cast<std::size_t>(d + reach)] =
            plane_row(std::as_const(across), 0, std::clamp(y + d, 0, scene.height - 1));
      }
      CircularRow row = pattern;
      row.taps = scratch.taps.data() + reach;
      row.plane = across.plane;
      row.result = scratch.values.data();
      row.result_plane = length;
      SOFTFOCUS_KERNEL(pool.isa(), circular_down)(row, components);
      for (float& value : scratch.values) value = value < 0.0f ? 0.0f : value;
      store_row(input, result, y, row.result, row.result + length, row.result + 2 * length,
                pool.isa());
    }
    shelf.put_back(std::move(scratch));
  });
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

// How far a neighbour counts. `twice_inverse` is 2 / the receiver's radius.
SOFTFOCUS_INLINE Floats share_of(Floats radius_px, Floats twice_inverse) {
  return smaller(absolute(radius_px) * twice_inverse, splat(1.0f));
}

// The first pass gathers three real values for every component, the second each component's
// three complex ones.
template <bool across, int components>
SOFTFOCUS_INLINE void gather_circular(const CircularRow& row) {
  constexpr int kValues = across ? 3 : 6;  // of one component
  constexpr int kRadius = across ? 3 : 6 * components;
  for (int x = 0; x < row.count; x += kLanes) {
    const float* own = row.taps[0] + x;
    const Floats signed_radius = load(own + kRadius * row.plane);
    const Floats radius = absolute(signed_radius);
    const Mask blurred = radius > 0.5f;
    const Floats cut = radius * kCircularCut[components - 1] + 0.5f;
    const Floats twice_inverse = 2.0f / larger(radius, splat(0.5f));
    const int limit = static_cast<int>(largest_lane(select(blurred, cut, splat(0.0f))));
    const int reach = limit < row.reach ? limit : row.reach;
    const Ints entry = truncate(radius * 16.0f + 0.5f);
    Floats top[3] = {}, bottom = splat(0.0f);
    for (int c = 0; c < components; ++c) {
      const std::ptrdiff_t first = across ? 0 : 6 * c * row.plane;
      const Complexes one{gather(row.components[c].real, entry, blurred),
                          gather(row.components[c].imaginary, entry, blurred)};
      const Complexes step = product(one, one);
      Complexes k = one, next = product(step, one), sum{splat(1.0f), splat(0.0f)};
      Floats here[kValues], values[6] = {};
      for (int i = 0; i < kValues; ++i) here[i] = load(own + first + i * row.plane);
      // The real parts are values 0, 2 and 4.
      for (int i = 0; i < kValues; ++i) values[across ? 2 * i : i] = here[i];
      for (int d = 1; d <= reach; ++d) {
        const Floats weight = saturate(cut - static_cast<float>(d));
        const Complexes weighed{k.re * weight, k.im * weight};
        const float* before = row.taps[-d] + x;
        const float* after = row.taps[d] + x;
        const Floats share_before = share_of(load(before + kRadius * row.plane), twice_inverse);
        const Floats share_after = share_of(load(after + kRadius * row.plane), twice_inverse);
        Floats both[kValues];
        for (int i = 0; i < kValues; ++i) {
          const Floats p = load(before + first + i * row.plane);
          const Floats q = load(after + first + i * row.plane);
          both[i] =
              (here[i] + share_before * (p - here[i])) + (here[i] + share_after * (q - here[i]));
        }
        for (int i = 0; i < 3; ++i) {
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
        for (int i = 0; i < 3; ++i) {
          const Complexes mean = product({values[2 * i], values[2 * i + 1]}, scale);
          float* to = row.result + (6 * c + 2 * i) * row.result_plane + x;
          store(to, select(blurred, mean.re, here[i]));
          store(to + row.result_plane, select(blurred, mean.im, splat(0.0f)));
        }
      } else {
        const Complexes factor = product(
            {splat(row.components[c].real_factor), splat(-row.components[c].imaginary_factor)},
            sum);
        for (int i = 0; i < 3; ++i) {
          top[i] = top[i] + product(factor, {values[2 * i], values[2 * i + 1]}).re;
        }
        bottom = bottom + product(factor, sum).re;
      }
    }
    if constexpr (across) {
      store(row.result + 6 * components * row.result_plane + x, signed_radius);
    } else {
      for (int i = 0; i < 3; ++i) {
        store(row.result + i * row.result_plane + x,
              select(blurred, top[i] / bottom, load(own + 2 * i * row.plane)));
      }
    }
  }
}

}  // namespace

void circular_across(const CircularRow& row, int components) {
  components == 1 ? gather_circular<true, 1>(row) : gather_circular<true, 2>(row);
}
void circular_down(const CircularRow& row, int components) {
  components == 1 ? gather_circular<false, 1>(row) : gather_circular<false, 2>(row);
}

#endif
