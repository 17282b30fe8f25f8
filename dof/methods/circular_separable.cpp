#include "dof/methods/circular_separable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dof/methods/circular_kernel.h"
#include "dof/picture_planes.h"
#include "raster/numbers/exact_math.h"
#include "raster/threads/scratch_shelf.h"

#define SOFTFOCUS_KERNELS "dof/methods/circular_kernels.inl"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kWidestVector = 16;
constexpr int kTaskRows = 8;

struct ComplexGaussian {
  double a, b, real_factor, imaginary_factor;
};
constexpr ComplexGaussian kOne[] = {{.862325, 1.624835, .767583, 1.862321}};
constexpr ComplexGaussian kTwo[] = {{.886528, 5.268909, .411259, -.548794},
                                    {1.960518, 1.558213, .513282, 4.56111}};
// The radius of the disc that the cut kernel is nearest to, in the kernel's units.
constexpr double kEdges[] = {1.085, 1.11};

// k(1) of a component by radius.
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
  const std::ptrdiff_t padded = scene.width + 2 * reach + 2 * kWidestVector;
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
