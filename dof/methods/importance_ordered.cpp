#include "dof/methods/importance_ordered.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "dof/one_pass/one_pass.h"
#include "dof/picture_planes.h"
#include "dof/weights.h"
#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "raster/numbers/random_bits.h"

namespace softfocus {
namespace {

constexpr int kChannels = 3;
constexpr int kRadius = 3;  // the plane of radii

// The share of lost detail that counts at a radius of one pixel.
constexpr float kDetail = 0.25f;

// --- the picture at half size ---

// A picture, its planes, and what one-pass makes of it.
struct ImportanceLevel {
  Image scene;
  DofSettings settings;
  Planes before;  // colours, radius
  Planes after;
};

// The second least of four.
float second_least(float a, float b, float c, float d) {
  return std::min(std::max(std::min(a, b), std::min(c, d)),
                  std::min(std::max(a, b), std::max(c, d)));
}

// A mean of four colours, so that a constant stays. The depth is that of the second nearest: a
// mean of depths at an edge would be a depth that is not there.
void halve_row(const DofInput& input, const Planes& planes, int y, const DofInput& small,
               const ImageView& half, float* colours, Isa isa) {
  const int upper = 2 * y, lower = std::min(2 * y + 1, planes.height - 1);
  const auto columns_of = [&](int x) {
    return std::array{2 * x, std::min(2 * x + 1, planes.width - 1)};
  };
  const std::ptrdiff_t stride = plane_stride(half.width);
  for (int c = 0; c < kChannels; ++c) {
    const float* first = plane_row(planes, c, upper);
    const float* second = plane_row(planes, c, lower);
    for (int x = 0; x < half.width; ++x) {
      const auto [i, j] = columns_of(x);
      colours[c * stride + x] = ((first[i] + first[j]) + (second[i] + second[j])) * 0.25f;
    }
  }
  const float* first = plane_row(planes, kRadius, upper);
  const float* second = plane_row(planes, kRadius, lower);
  const std::uint16_t* first_texels = row<std::uint16_t>(input.scene, upper).data();
  const std::uint16_t* second_texels = row<std::uint16_t>(input.scene, lower).data();
  std::uint16_t* to = row<std::uint16_t>(half, y).data();
  for (int x = 0; x < half.width; ++x) {
    const auto [i, j] = columns_of(x);
    const float radius = second_least(first[i], first[j], second[i], second[j]);
    const std::uint16_t* from = radius == first[i]    ? first_texels + 4 * i
                                : radius == first[j]  ? first_texels + 4 * j
                                : radius == second[i] ? second_texels + 4 * i
                                                      : second_texels + 4 * j;
    to[4 * x + 3] = from[3];
  }
  // Alpha, the depth, is taken from the picture itself.
  store_row(small, half, y, colours, colours + stride, colours + 2 * stride, isa);
}

ImportanceLevel half_of(const DofInput& input, const Planes& planes, ThreadPool& pool) {
  ImportanceLevel level{
      make_image(Format::rgba16f, (input.scene.width + 1) / 2, (input.scene.height + 1) / 2),
      input.settings,
      {},
      {}};
  level.settings.coc.radius_at_infinity_px *= 0.5f;
  level.settings.max_coc_px *= 0.5f;
  level.settings.leak *= 2.0f;  // it counts per pixel
  const ImageView half = level.scene;
  const DofInput small{half, level.settings, {}};
  pool.for_each(half.height, [&](int y) {
    std::vector<float> colours(static_cast<std::size_t>(kChannels * plane_stride(half.width)));
    halve_row(input, planes, y, small, half, colours.data(), pool.isa());
  });
  level.before = split_picture(small, pool);
  Image filtered = make_image(Format::rgba16f, half.width, half.height);
  one_pass(small, filtered, pool);
  level.after = split_picture({filtered, level.settings, {}}, pool);
  return level;
}

// Row `y` of a plane at twice its size, bilinearly. `between` has a place for each column.
void magnify_row(const Planes& small, int plane, int y, int width, float* between, float* to) {
  const int other = (y & 1) != 0 ? std::min(y / 2 + 1, small.height - 1) : std::max(y / 2 - 1, 0);
  const float* near = plane_row(small, plane, y / 2);
  const float* far = plane_row(small, plane, other);
  for (int x = 0; x < small.width; ++x) between[x] = near[x] + 0.25f * (far[x] - near[x]);
  float before = between[0];
  for (int x = 0; 2 * x < width; ++x) {
    const float here = between[x];
    to[2 * x] = here + 0.25f * (before - here);
    const float after = between[std::min(x + 1, small.width - 1)];
    to[2 * x + 1] = here + 0.25f * (after - here);  // perhaps past the end, where nothing lies
    before = here;
  }
}

// E of the header: three rows of `stride`. `scratch` has room for three more.
void rough_row(const Planes& planes, const ImportanceLevel& level, int y, float* rough,
               float* scratch) {
  const int width = planes.width;
  const std::ptrdiff_t stride = planes.stride;
  float* between = scratch;
  float* before = scratch + stride;
  float* softness = scratch + 2 * stride;
  const float* radius = plane_row(planes, kRadius, y);
  for (int x = 0; x < width; ++x) {
    const float s = (std::fabs(radius[x]) - 0.5f) * (1.0f / 1.5f);
    softness[x] = s > 0.0f ? (s < 1.0f ? s : 1.0f) : 0.0f;
  }
  for (int c = 0; c < kChannels; ++c) {
    float* to = rough + c * stride;
    magnify_row(level.after, c, y, width, between, to);
    magnify_row(level.before, c, y, width, between, before);
    const float* sharp = plane_row(planes, c, y);
    for (int x = 0; x < width; ++x) {
      to[x] += (1.0f - softness[x]) * (sharp[x] - before[x]);
    }
  }
}

// --- blocks ---

struct Blocks {
  int columns, rows;
  std::vector<int> reach;         // row by row; 0: exact as it is
  std::vector<float> importance;  // not yet divided by the work

  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row * columns + column);
  }
};

std::vector<float> largest_of_blocks(const Planes& planes, const Blocks& blocks, ThreadPool& pool) {
  std::vector<float> largest(blocks.reach.size());
  pool.for_each(blocks.rows, [&](int row) {
    const int y_end = std::min((row + 1) * kBlockHeight, planes.height);
    for (int column = 0; column < blocks.columns; ++column) {
      const int x = column * kBlockWidth, x_end = std::min(x + kBlockWidth, planes.width);
      float most = 0.0f;
      for (int y = row * kBlockHeight; y < y_end; ++y) {
        const float* radius = plane_row(planes, kRadius, y);
        for (int i = x; i < x_end; ++i) most = std::max(most, std::fabs(radius[i]));
      }
      largest[blocks.at(column, row)] = most;
    }
  });
  return largest;
}

// How far the taps of each block must go: the farthest reach of pixels that reach it.
Blocks blocks_of(const Planes& planes, ThreadPool& pool) {
  Blocks blocks{(planes.width + kBlockWidth - 1) / kBlockWidth,
                (planes.height + kBlockHeight - 1) / kBlockHeight,
                {},
                {}};
  const auto count =
      static_cast<std::size_t>(blocks.columns) * static_cast<std::size_t>(blocks.rows);
  blocks.reach.resize(count);
  blocks.importance.resize(count);
  const std::vector<float> largest = largest_of_blocks(planes, blocks, pool);
  const int farthest = tap_count(*std::max_element(largest.begin(), largest.end()));
  const int columns = (farthest + kBlockWidth - 1) / kBlockWidth;
  const int rows = (farthest + kBlockHeight - 1) / kBlockHeight;
  const auto gap = [](int apart, int size) { return std::max((apart - 1) * size + 1, 0); };
  pool.for_each(blocks.rows, [&](int row) {
    for (int column = 0; column < blocks.columns; ++column) {
      int& reach = blocks.reach[blocks.at(column, row)];
      for (int y = std::max(row - rows, 0); y <= std::min(row + rows, blocks.rows - 1); ++y) {
        const int x_end = std::min(column + columns, blocks.columns - 1);
        for (int x = std::max(column - columns, 0); x <= x_end; ++x) {
          const int by = tap_count(largest[blocks.at(x, y)]);
          if (by > reach && by >= gap(std::abs(x - column), kBlockWidth) &&
              by >= gap(std::abs(y - row), kBlockHeight)) {
            reach = by;
          }
        }
      }
    }
  });
  return blocks;
}

std::uint64_t work_of(int reach) {
  return static_cast<std::uint64_t>(reach) * static_cast<std::uint64_t>(reach);
}

float difference(float a, float b) {
  const float most = std::max(std::max(a, b), 0.0f);
  return std::fabs(a - b) / (1.0f + most);
}

// How far one level's picture is from what the next smaller one would have made of it.
void weigh_blocks(const ImportanceLevel& level, const ImportanceLevel& smaller, Blocks& blocks,
                  ThreadPool& pool) {
  const Planes& planes = level.before;
  const std::ptrdiff_t stride = planes.stride;
  pool.for_each(blocks.rows, [&](int row) {
    std::vector<float> memory(static_cast<std::size_t>(6 * stride));
    float* rough = memory.data();
    const int y_end = std::min((row + 1) * kBlockHeight / 2, planes.height);
    for (int y = row * kBlockHeight / 2; y < y_end; ++y) {
      rough_row(planes, smaller, y, rough, rough + 3 * stride);
      for (int x = 0; x < planes.width; ++x) {
        float sum = 0.0f;
        for (int c = 0; c < kChannels; ++c) {
          sum += difference(plane_row(level.after, c, y)[x], rough[c * stride + x]);
        }
        blocks.importance[blocks.at(x / (kBlockWidth / 2), row)] += sum;
      }
    }
  });
}

// --- the order, and the end ---

std::vector<std::size_t> in_order(const Blocks& blocks, BlockOrder order) {
  std::vector<std::size_t> sequence;
  for (std::size_t i = 0; i < blocks.reach.size(); ++i) {
    if (blocks.reach[i] > 0) sequence.push_back(i);
  }
  std::vector<float> key(blocks.reach.size());
  for (const std::size_t i : sequence) {
    key[i] = order == BlockOrder::importance
                 ? blocks.importance[i] / static_cast<float>(work_of(blocks.reach[i]))
                 : static_cast<float>(mix_bits(i) >> 40);
  }
  if (order == BlockOrder::rows) return sequence;
  std::stable_sort(sequence.begin(), sequence.end(),
                   [&](std::size_t a, std::size_t b) { return key[a] > key[b]; });
  return sequence;
}

// The first of the sequence that the budget pays for.
std::vector<OnePassBlock> paid_blocks(const Blocks& blocks, std::span<const std::size_t> sequence,
                                      float budget) {
  std::uint64_t whole = 0;
  for (const std::size_t i : sequence) whole += work_of(blocks.reach[i]);
  const double limit = static_cast<double>(whole) * static_cast<double>(budget);
  std::vector<OnePassBlock> paid;
  std::uint64_t work = 0;
  for (const std::size_t i : sequence) {
    work += work_of(blocks.reach[i]);
    if (static_cast<double>(work) > limit) break;
    const int number = static_cast<int>(i);
    paid.push_back({number % blocks.columns, number / blocks.columns, blocks.reach[i]});
  }
  return paid;
}

// The rough picture, and the picture itself where nothing blurs it. Circles that are too small
// to blur the small picture make up for it in importance: there E is off by some of the detail
// that the small picture lacks.
void store_rough(const DofInput& input, const Planes& planes, const ImportanceLevel& level,
                 Blocks& blocks, const ImageView& result, ThreadPool& pool) {
  const std::ptrdiff_t stride = planes.stride;
  pool.for_each(blocks.rows, [&](int row) {
    std::vector<float> memory(static_cast<std::size_t>(6 * stride));
    float* rough = memory.data();
    const int y_end = std::min((row + 1) * kBlockHeight, planes.height);
    for (int y = row * kBlockHeight; y < y_end; ++y) {
      rough_row(planes, level, y, rough, rough + 3 * stride);
      const float* radius = plane_row(planes, kRadius, y);
      for (int column = 0; column < blocks.columns; ++column) {
        const std::size_t block = blocks.at(column, row);
        const int x_end = std::min((column + 1) * kBlockWidth, planes.width);
        for (int c = 0; c < kChannels; ++c) {
          const float* sharp = plane_row(planes, c, y);
          float* to = rough + c * stride;
          float sum = 0.0f;
          for (int x = column * kBlockWidth; x < x_end; ++x) {
            const float r = std::fabs(radius[x]);
            const float share = r > 1.0f ? kDetail / (r * r) : 0.0f;
            sum += share * difference(sharp[x], to[x]);
            if (blocks.reach[block] == 0) to[x] = sharp[x];
          }
          blocks.importance[block] += sum;
        }
      }
      store_row(input, result, y, rough, rough + stride, rough + 2 * stride, pool.isa());
    }
  });
}

// A copy without NaNs and infinities, for one-pass would spread them.
Image finite_picture(const DofInput& input, const Planes& planes, ThreadPool& pool) {
  Image finite = make_image(Format::rgba16f, planes.width, planes.height);
  pool.for_each(planes.height, [&](int y) {
    store_row(input, finite, y, plane_row(planes, 0, y), plane_row(planes, 1, y),
              plane_row(planes, 2, y), pool.isa());
  });
  return finite;
}

}  // namespace

void refine(const DofInput& input, float budget, BlockOrder order, const ImageView& result,
            ThreadPool& pool) {
  const Planes planes = split_picture(input, pool);
  const Image finite = finite_picture(input, planes, pool);
  const DofInput clean{finite, input.settings, input.profile};
  if (budget >= 1.0f) return one_pass(clean, result, pool);
  Blocks blocks = blocks_of(planes, pool);
  const ImportanceLevel half = half_of(clean, planes, pool);
  const ImportanceLevel quarter = half_of({half.scene, half.settings, {}}, half.before, pool);
  weigh_blocks(half, quarter, blocks, pool);
  store_rough(clean, planes, half, blocks, result, pool);
  const std::vector<std::size_t> sequence = in_order(blocks, order);
  one_pass_blocks(clean, paid_blocks(blocks, sequence, budget), result, pool);
}

void importance_ordered(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  refine(input, input.settings.budget, BlockOrder::importance, result, pool);
}

}  // namespace softfocus
