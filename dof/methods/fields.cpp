#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/methods/fields.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "dof/scatter/layer_planes.h"
#include "dof/scatter/scatter_discs.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "dof/methods/fields.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kFieldRows = 8;
constexpr float kSharpPx = 0.5f;

enum class Field { near, far };

bool is_of(Field field, float radius_px) {
  return field == Field::near ? radius_px < -kSharpPx : radius_px > kSharpPx;
}

// A field's radius in quarters of a pixel.
struct FieldRadius {
  std::uint64_t squares = 0, count = 0;

  void add(float radius_px) {
    const auto quarters = static_cast<std::uint64_t>(disc_of(radius_px));
    squares += quarters * quarters;
    ++count;
  }
  float px() const {
    if (count == 0) return 0.0f;
    const double mean = static_cast<double>(squares) / static_cast<double>(count);
    return 0.25f * static_cast<float>(std::floor(std::sqrt(mean) + 0.5));
  }
};

FieldRadii radii_of(const Planes& scene) {
  FieldRadius near, far;
  for (int y = 0; y < scene.height; ++y) {
    const float* radius = plane_row(scene, 3, y);
    for (int x = 0; x < scene.width; ++x) {
      if (is_of(Field::near, radius[x])) near.add(radius[x]);
      if (is_of(Field::far, radius[x])) far.add(radius[x]);
    }
  }
  return {near.px(), far.px()};
}

float share_in(Field field, float radius_px, float field_px) {
  if (!is_of(field, radius_px)) return 0.0f;
  return std::min(1.0f, radius_px * radius_px / (field_px * field_px));
}

// Sums of a field's colour times share, and of its shares, along each row from its left end on. The
// row goes on by its last pixels for `margin` to either side.
struct FieldSums {
  int margin;
  std::ptrdiff_t plane, stride;
  std::vector<double> values;  // entry margin + x of a plane's row: all left of pixel x
  std::vector<std::uint8_t> any;

  double* row(int y) { return values.data() + y * stride; }
  const double* row(int y) const { return values.data() + y * stride; }
};

FieldSums sum_rows(const Planes& scene, Field field, float field_px, int margin, ThreadPool& pool) {
  FieldSums sums;
  sums.margin = margin;
  sums.plane = std::ptrdiff_t{scene.width} + 2 * margin + 1;
  sums.stride = 4 * sums.plane;
  sums.values.resize(static_cast<std::size_t>(sums.stride * scene.height));
  sums.any.resize(static_cast<std::size_t>(scene.height));
  pool.for_each(scene.height, [&](int y) {
    const float* from = plane_row(scene, 0, y);
    double* to = sums.row(y);
    double sum[4] = {};
    bool any = false;
    for (std::ptrdiff_t i = 0; i < sums.plane; ++i) {
      for (int c = 0; c < 4; ++c) to[c * sums.plane + i] = sum[c];
      const auto x = std::clamp<std::ptrdiff_t>(i - margin, 0, scene.width - 1);
      const float share = share_in(field, from[3 * scene.plane + x], field_px);
      if (share <= 0.0f) continue;
      any = true;
      for (int c = 0; c < 3; ++c) {
        sum[c] += static_cast<double>(share) * static_cast<double>(from[c * scene.plane + x]);
      }
      sum[3] += static_cast<double>(share);
    }
    sums.any[static_cast<std::size_t>(y)] = any ? 1 : 0;
  });
  return sums;
}

// Calls write(y, sums), where sums are four rows of the field under its disc, the disc's area 1.
template <class Write>
void blur_field(const Planes& scene, Field field, float field_px, ThreadPool& pool,
                const Write& write) {
  const auto disc = static_cast<std::size_t>(disc_of(field_px));
  const ScatterDiscs discs = make_discs(field_px);
  const int reach = discs.reaches[disc];
  const FieldSums rows = sum_rows(scene, field, field_px, reach + 3, pool);
  const auto width = static_cast<std::size_t>(scene.width);
  for_each_row_with<std::vector<double>>(pool, scene.height, kFieldRows, [&](int y, auto& sums) {
    sums.resize(4 * width);
    std::fill(sums.begin(), sums.end(), 0.0);
    for (int dy = -reach; dy <= reach; ++dy) {
      const int from = std::clamp(y + dy, 0, scene.height - 1);
      if (rows.any[static_cast<std::size_t>(from)] == 0) continue;
      const DiscSpan span =
          discs.spans[static_cast<std::size_t>(std::abs(dy) * discs.count) + disc];
      if (span.whole < -1) continue;
      SOFTFOCUS_KERNEL(pool.isa(), add_field_row)
      (rows.row(from) + rows.margin, rows.plane, scene.width, span.whole, 0.125 * span.eighths,
       static_cast<double>(discs.weights[disc]), sums.data());
    }
    write(y, sums.data());
  });
}

// The picture behind the near field. The fourth plane: 1 where it is known.
Planes behind_near(const Planes& scene, FieldRadii radii, ThreadPool& pool) {
  Planes behind = make_planes(4, scene.width, scene.height, pool);
  pool.for_each(scene.height, [&](int y) {
    const float* from = plane_row(scene, 0, y);
    float* to = plane_row(behind, 0, y);
    for (int x = 0; x < scene.width; ++x) {
      for (int c = 0; c < 3; ++c) to[c * behind.plane + x] = from[c * scene.plane + x];
      const float near = share_in(Field::near, from[3 * scene.plane + x], radii.near_px);
      to[3 * behind.plane + x] = near < 0.5f ? 1.0f : 0.0f;
    }
  });
  if (radii.far_px <= 0.0f) return behind;
  blur_field(scene, Field::far, radii.far_px, pool, [&](int y, const double* sums) {
    const float* radius = plane_row(scene, 3, y);
    float* to = plane_row(behind, 0, y);
    for (int x = 0; x < scene.width; ++x) {
      const double share = static_cast<double>(share_in(Field::far, radius[x], radii.far_px));
      if (share <= 0.0) continue;
      for (int c = 0; c < 3; ++c) {
        float& colour = to[c * behind.plane + x];
        const double far = sums[c * scene.width + x] / sums[3 * scene.width + x];
        const auto sharp = static_cast<double>(colour);
        colour = static_cast<float>(sharp + share * (far - sharp));
      }
    }
  });
  return behind;
}

}  // namespace

FieldRadii field_radii(const DofInput& input) {
  ThreadPool pool(1);
  return radii_of(split_picture(input, pool));
}

void fields(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const Planes scene = split_picture(input, pool);
  const FieldRadii radii = radii_of(scene);
  Planes out = behind_near(scene, radii, pool);
  if (radii.near_px > 0.0f) {
    guess_hidden(out, 3, pool);
    blur_field(scene, Field::near, radii.near_px, pool, [&](int y, const double* sums) {
      float* to = plane_row(out, 0, y);
      for (int x = 0; x < scene.width; ++x) {
        const double opacity = std::min(sums[3 * scene.width + x], 1.0);
        if (opacity <= 0.0) continue;
        for (int c = 0; c < 3; ++c) {
          float& colour = to[c * out.plane + x];
          colour = static_cast<float>(sums[c * scene.width + x] +
                                      (1.0 - opacity) * static_cast<double>(colour));
        }
      }
    });
  }
  pool.for_each(scene.height, [&](int y) {
    store_row(input, result, y, plane_row(out, 0, y), plane_row(out, 1, y), plane_row(out, 2, y),
              pool.isa());
  });
}

}  // namespace softfocus

#else  // kernels

/// Adds a disc's row: pixels -whole to whole about x, and the next on either side by `end`, times
/// the disc's weight. `left` points at the sum left of pixel 0. Of whole = -1 the two overlap and
/// leave 2 end - 1 of the pixel.
void add_field_row(const double* left, std::ptrdiff_t plane, int width, int whole, double end,
                   double weight, double* sums) {
  for (int c = 0; c < 4; ++c) {
    const double* inner_end = left + c * plane + whole + 1;
    const double* inner = left + c * plane - whole;
    double* to = sums + std::ptrdiff_t{c} * width;
    for (int x = 0; x < width; ++x) {
      const double all = inner_end[x] - inner[x];
      const double wide = inner_end[x + 1] - inner[x - 1];
      to[x] += weight * (all + end * (wide - all));
    }
  }
}

#endif
