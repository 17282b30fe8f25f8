#include "raster/passes/kernel.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/vec4.hpp>
#include <utility>

#include "raster/images/sampler.h"
#include "raster/images/texel.h"
#include "raster/numbers/exact_math.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/passes/row_sums.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

/// Rows that a thread takes at a time. It decodes those above and below once more.
constexpr int kKernelRows = 64;

/// A thread's memory: as many rows of the source as the kernel has, as floats, in a ring.
struct RowRing {
  std::vector<float> decoded;
  std::vector<const float*> rows;
  std::vector<float> sums;
};

/// How far the guard band and the kernel reach to each side.
struct Margins {
  int guard_x, guard_y, reach_x, reach_y;
};
Margins margins_of(const Kernel& kernel, const ConstImageView& source, const ImageView& result) {
  return {(source.width - result.width) / 2, (source.height - result.height) / 2, kernel.width / 2,
          kernel.height / 2};
}

bool fit(const Kernel& kernel, const ConstImageView& source, const ImageView& result) {
  return source.format == Format::rgba16f && result.format == Format::rgba16f &&
         kernel.width % 2 == 1 && kernel.height % 2 == 1 &&
         kernel.weights.size() ==
             static_cast<std::size_t>(kernel.width) * static_cast<std::size_t>(kernel.height) &&
         source.width >= result.width && (source.width - result.width) % 2 == 0 &&
         source.height >= result.height && (source.height - result.height) % 2 == 0;
}

void convolve_band(const Kernel& kernel, const ConstImageView& source, const ImageView& result,
                   const Profile& profile, int first, int end, RowRing& ring, Isa isa) {
  const Margins margins = margins_of(kernel, source, result);
  const int values = 4 * result.width;
  const int columns = result.width + kernel.width - 1;
  const std::size_t row_length = static_cast<std::size_t>(4 * columns + kValuesAtOnce);
  ring.decoded.resize(row_length * static_cast<std::size_t>(kernel.height));
  ring.rows.resize(static_cast<std::size_t>(kernel.height));
  ring.sums.resize(static_cast<std::size_t>(values + kValuesAtOnce));
  const int top = first + margins.guard_y - margins.reach_y;
  const auto place = [&](int y) {
    return ring.decoded.data() + row_length * static_cast<std::size_t>((y - top) % kernel.height);
  };
  const auto decode = [&](int y) {
    decode_row(row<std::uint16_t>(source, std::clamp(y, 0, source.height - 1)),
               margins.guard_x - margins.reach_x, columns, place(y), isa);
  };
  for (int y = top; y < top + kernel.height - 1; ++y) decode(y);
  for (int y = first; y < end; ++y) {
    const int upper = y + margins.guard_y - margins.reach_y;
    decode(upper + kernel.height - 1);
    for (int j = 0; j < kernel.height; ++j) {
      ring.rows[static_cast<std::size_t>(j)] = place(upper + j);
    }
    const float* own = place(y + margins.guard_y) + 4 * margins.reach_x;
    sum_rows({ring.rows.data(), kernel.height, kernel.width, kernel.weights.data()}, values,
             ring.sums.data(), isa);
    store_row(ring.sums.data(), own, values, profile.half_store,
              row<std::uint16_t>(result, y).data(), isa);
  }
}

std::vector<float> divided(std::vector<float> weights, float by) {
  for (float& weight : weights) weight /= by;
  return weights;
}

}  // namespace

std::span<const NamedKernel> kernels() {
  static const std::array named_kernels{
      NamedKernel{"edge-detection",
                  "8 of the pixel less its eight neighbours",
                  {3, 3, {-1, -1, -1, -1, 8, -1, -1, -1, -1}}},
      NamedKernel{"sharpen",
                  "5 of the pixel less the four beside it",
                  {3, 3, {0, -1, 0, -1, 5, -1, 0, -1, 0}}},
      NamedKernel{
          "box-3", "the mean of 3x3 pixels", {3, 3, divided({1, 1, 1, 1, 1, 1, 1, 1, 1}, 9.0f)}},
      NamedKernel{"gaussian-3",
                  "3x3 pixels by binomials, sigma .71",
                  {3, 3, divided({1, 2, 1, 2, 4, 2, 1, 2, 1}, 16.0f)}},
      NamedKernel{"gaussian-5",
                  "5x5 pixels by binomials, sigma 1",
                  {5, 5,
                   divided({1,  4, 6, 4,  1,  4,  16, 24, 16, 4, 6, 24, 36,
                            24, 6, 4, 16, 24, 16, 4,  1,  4,  6, 4, 1},
                           256.0f)}},
  };
  return named_kernels;
}

const Kernel* find_kernel(std::string_view name) {
  for (const NamedKernel& named : kernels()) {
    if (named.name == name) return &named.kernel;
  }
  return nullptr;
}

std::vector<float> gaussian_weights(double sigma_px) {
  assert(sigma_px >= 0.0 && sigma_px <= 341.0);
  constexpr double kLog2OfE = 1.4426950408889634;
  const int reach = static_cast<int>(3.0 * sigma_px);
  std::vector<double> exact;
  double sum = 0.0;
  for (int d = -reach; d <= reach; ++d) {
    exact.push_back(d == 0 ? 1.0
                           : exact_math::exp2(-0.5 * d * d / (sigma_px * sigma_px) * kLog2OfE));
    sum += exact.back();
  }
  std::vector<float> weights;
  weights.reserve(exact.size());
  for (const double weight : exact) weights.push_back(static_cast<float>(weight / sum));
  return weights;
}

Kernel row_kernel(std::vector<float> weights) {
  const int width = static_cast<int>(weights.size());
  return {width, 1, std::move(weights)};
}

Kernel column_kernel(std::vector<float> weights) {
  const int height = static_cast<int>(weights.size());
  return {1, height, std::move(weights)};
}

Kernel square_kernel(const std::vector<float>& weights) {
  const int side = static_cast<int>(weights.size());
  Kernel kernel{side, side, {}};
  for (const float down : weights) {
    for (const float across : weights) kernel.weights.push_back(down * across);
  }
  return kernel;
}

void convolve(const Kernel& kernel, const ConstImageView& source, const ImageView& result,
              const Profile& profile, ThreadPool& pool) {
  assert(fit(kernel, source, result));
  for_each_band_with<RowRing>(
      pool, result.height, kKernelRows, [&](int first, int end, auto& ring) {
        convolve_band(kernel, source, result, profile, first, end, ring, pool.isa());
      });
}

void box_in_four_reads(const Texture& source, const ImageView& result, const Profile& profile,
                       ThreadPool& pool) {
  assert(source.levels[0].width == result.width && source.levels[0].height == result.height);
  struct Read {
    glm::vec2 offset;
    float weight;
  };
  constexpr std::array kReads{Read{{-0.5f, -0.5f}, 4.0f / 9.0f}, Read{{1.0f, -0.5f}, 2.0f / 9.0f},
                              Read{{-0.5f, 1.0f}, 2.0f / 9.0f}, Read{{1.0f, 1.0f}, 1.0f / 9.0f}};
  constexpr Sampler kSampler{Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
  const glm::vec2 texel{1.0f / static_cast<float>(result.width),
                        1.0f / static_cast<float>(result.height)};
  fullscreen_pass<Format::rgba16f>(result, profile, pool, [&](int x, int y) {
    const glm::vec2 middle{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
    glm::vec4 sum{0.0f};
    for (const Read& read : kReads) {
      sum += read.weight * sample(source, kSampler, (middle + read.offset) * texel, 0.0f, profile);
    }
    sum.w = load_texel<Format::rgba16f>(source.levels[0], x, y).w;
    return sum;
  });
}

}  // namespace softfocus
