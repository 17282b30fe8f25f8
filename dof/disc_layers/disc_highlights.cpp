#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/disc_layers/disc_highlights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "dof/disc_layers/disc_levels.h"
#include "dof/picture_planes.h"
#include "raster/numbers/half.h"

namespace softfocus {

constexpr int kLightBlock = 16;     // pixels across
constexpr float kStandsOut = 8.0f;  // l over m, from which on a pixel is a highlight

// A row of a block, to tell which pixels may be highlights.
struct LightRow {
  float least;           // no pixel's m is lower
  float means[2][3];     // of the blocks whose means lie around the row
  float below;           // the share of the lower ones
  float larger_squares;  // from this square of the radius on m comes from larger blocks
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/disc_layers/disc_highlights.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr double kDiscsPerPixel = 32;  // steps of the discs' radii

// The light of blocks of 16, 32, ... pixels.
struct LightBlocks {
  int columns, rows;
  std::vector<float> sum, count, mean, largest;
  std::vector<float> least;  // no pixel of the block has a lower m, at this level or larger ones

  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(std::clamp(row, 0, rows - 1) * columns +
                                    std::clamp(column, 0, columns - 1));
  }
  float mean_at(int column, int row) const { return mean[at(column, row)]; }
};

LightBlocks make_blocks(int columns, int rows) {
  LightBlocks blocks{columns, rows, {}, {}, {}, {}, {}};
  const auto count = static_cast<std::size_t>(columns * rows);
  blocks.sum.resize(count);
  blocks.count.resize(count);
  blocks.mean.resize(count);
  blocks.largest.resize(count);
  blocks.least.resize(count);
  return blocks;
}

// A value that is NaN becomes 0, a negative one too.
float light_of(float value) { return value > 0.0f ? std::min(value, kLargestHalf) : 0.0f; }

float texel_light(const std::uint16_t* texel) {
  return std::max(std::max(light_of(half_to_float(texel[0])), light_of(half_to_float(texel[1]))),
                  light_of(half_to_float(texel[2])));
}

void add_light_columns(const std::uint16_t* from, int width, float* sums, float* largest, Isa isa) {
  if (isa != Isa::scalar) {
    SOFTFOCUS_KERNEL(isa, add_light_columns)(from, width, sums, largest);
    return;
  }
  for (int x = 0; x < width; ++x) {
    const float light = texel_light(from + 4 * x);
    sums[x] += light;
    largest[x] = std::max(largest[x], light);
  }
}

LightBlocks finest_blocks(const DofInput& input, ThreadPool& pool) {
  const int width = input.scene.width, height = input.scene.height;
  LightBlocks blocks = make_blocks((width + kLightBlock - 1) / kLightBlock,
                                   (height + kLightBlock - 1) / kLightBlock);
  pool.for_each(blocks.rows, [&](int block_row) {
    const auto padded = static_cast<std::size_t>(plane_stride(width));
    std::vector<float> sums(padded), largest(padded);
    const int top = block_row * kLightBlock, end = std::min(top + kLightBlock, height);
    for (int y = top; y < end; ++y) {
      add_light_columns(row<std::uint16_t>(input.scene, y).data(), width, sums.data(),
                        largest.data(), pool.isa());
    }
    for (int column = 0; column < blocks.columns; ++column) {
      const int left = column * kLightBlock, right = std::min(left + kLightBlock, width);
      const std::size_t at = blocks.at(column, block_row);
      for (int x = left; x < right; ++x) {
        blocks.sum[at] += sums[static_cast<std::size_t>(x)];
        blocks.largest[at] = std::max(blocks.largest[at], largest[static_cast<std::size_t>(x)]);
      }
      blocks.count[at] = static_cast<float>((right - left) * (end - top));
    }
  });
  return blocks;
}

LightBlocks next_blocks(const LightBlocks& from) {
  LightBlocks to = make_blocks((from.columns + 1) / 2, (from.rows + 1) / 2);
  for (int row = 0; row < from.rows; ++row) {
    for (int column = 0; column < from.columns; ++column) {
      to.sum[to.at(column / 2, row / 2)] += from.sum[from.at(column, row)];
      to.count[to.at(column / 2, row / 2)] += from.count[from.at(column, row)];
    }
  }
  return to;
}

void find_means(LightBlocks& blocks) {
  for (std::size_t i = 0; i < blocks.mean.size(); ++i) {
    blocks.mean[i] = blocks.sum[i] / blocks.count[i];
  }
}

// From the largest blocks down.
void find_least(std::vector<LightBlocks>& levels) {
  for (std::size_t i = levels.size(); i-- > 0;) {
    LightBlocks& blocks = levels[i];
    for (int row = 0; row < blocks.rows; ++row) {
      for (int column = 0; column < blocks.columns; ++column) {
        float least = blocks.mean_at(column, row);
        for (int j = 0; j < 9; ++j) {
          least = std::min(least, blocks.mean_at(column + j % 3 - 1, row + j / 3 - 1));
        }
        if (i + 1 < levels.size()) {
          const LightBlocks& next = levels[i + 1];
          least = std::min(least, next.least[next.at(column / 2, row / 2)]);
        }
        blocks.least[blocks.at(column, row)] = least;
      }
    }
  }
}

// m of a pixel: between the means of the four nearest blocks.
float mean_around(const LightBlocks& blocks, float size, int x, int y) {
  const float u = (static_cast<float>(x) + 0.5f) / size - 0.5f;
  const float v = (static_cast<float>(y) + 0.5f) / size - 0.5f;
  const int column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
  const float right = u - static_cast<float>(column), below = v - static_cast<float>(row);
  const float upper =
      (1.0f - right) * blocks.mean_at(column, row) + right * blocks.mean_at(column + 1, row);
  const float lower = (1.0f - right) * blocks.mean_at(column, row + 1) +
                      right * blocks.mean_at(column + 1, row + 1);
  return (1.0f - below) * upper + below * lower;
}

struct DiscHighlight {
  int x, y;
  float radius_px;                    // negative before the focus
  std::array<float, 3> light;         // taken out
  std::array<std::uint16_t, 3> rest;  // halves
};

// The part of a pixel's light that is a highlight's. Needs a radius above 1.
float highlight_part(const std::vector<LightBlocks>& levels, float radius_px, float light, int x,
                     int y) {
  const float square = radius_px * radius_px;
  std::size_t level = 0;
  float size = kLightBlock;
  for (; level + 1 < levels.size() && square >= size * size; ++level) size += size;
  const float mean = mean_around(levels[level], size, x, y);
  const float part = std::min(2.0f * (1.0f - kStandsOut * mean / light), 1.0f - mean / light);
  return part * std::min(square - 1.0f, 1.0f);
}

LightRow light_row(const std::vector<LightBlocks>& levels, int column, int y) {
  const LightBlocks& blocks = levels[0];
  const int above = (y + kLightBlock / 2) / kLightBlock - 1;
  LightRow row{blocks.least[blocks.at(column, y / kLightBlock)], {}, 0.0f, 3e38f};
  for (int i = 0; i < 3; ++i) {
    row.means[0][i] = blocks.mean_at(column + i - 1, above);
    row.means[1][i] = blocks.mean_at(column + i - 1, above + 1);
  }
  constexpr float kSize = kLightBlock;
  row.below = ((static_cast<float>(y) + 0.5f) / kSize - 0.5f) - static_cast<float>(above);
  if (levels.size() > 1) row.larger_squares = kSize * kSize;
  return row;
}

// A bit for each pixel of a block's row that may be a highlight; those of `row` alone are tested.
std::uint32_t bright_pixels(const DofInput& input, int x, int y, const LightRow& row, Isa isa) {
  const std::uint16_t* from = softfocus::row<std::uint16_t>(input.scene, y).data();
  if (isa != Isa::scalar) {
    return SOFTFOCUS_KERNEL(isa, bright_pixels)(input.settings, from, x, input.scene.width, row);
  }
  std::uint32_t bright = 0;
  const int count = std::min(kLightBlock, input.scene.width - x);
  for (int i = 0; i < count; ++i) {
    if (!(texel_light(from + 4 * (x + i)) > kStandsOut * row.least)) continue;
    const float radius = split_texel(input, x + i, y).radius_px;
    if (radius * radius > 1.0f) bright |= 1u << i;
  }
  return bright;
}

void find_in_span(const DofInput& input, const std::vector<LightBlocks>& levels, int y, int left,
                  std::uint32_t bright, std::vector<DiscHighlight>& found) {
  const std::uint16_t* from = row<std::uint16_t>(input.scene, y).data();
  for (; bright != 0; bright &= bright - 1) {
    const int x = left + std::countr_zero(bright);
    const std::uint16_t* texel = from + 4 * static_cast<std::ptrdiff_t>(x);
    const float light = texel_light(texel);
    const float radius = split_texel(input, x, y).radius_px;
    const float part = highlight_part(levels, radius, light, x, y);
    if (!(part > 0.0f)) continue;
    DiscHighlight highlight{x, y, radius, {}, {}};
    for (std::size_t i = 0; i < 3; ++i) {
      const float value = half_to_float(texel[i]), lit = light_of(value);
      highlight.rest[i] =
          lit > 0.0f ? float_to_half(lit - lit * part, HalfRounding::nearest_even) : texel[i];
      highlight.light[i] =
          lit > 0.0f ? std::max(lit - half_to_float(highlight.rest[i]), 0.0f) : 0.0f;
    }
    found.push_back(highlight);
  }
}

// Row by row.
std::vector<std::vector<DiscHighlight>> find_by_blocks(const DofInput& input, ThreadPool& pool) {
  std::vector<LightBlocks> levels{finest_blocks(input, pool)};
  for (int size = kLightBlock; static_cast<float>(size) < input.settings.max_coc_px; size *= 2) {
    levels.push_back(next_blocks(levels.back()));
  }
  for (LightBlocks& blocks : levels) find_means(blocks);
  find_least(levels);
  const LightBlocks& blocks = levels[0];
  std::vector<std::vector<DiscHighlight>> found(static_cast<std::size_t>(blocks.rows));
  pool.for_each(blocks.rows, [&](int block_row) {
    const int top = block_row * kLightBlock;
    const int end = std::min(top + kLightBlock, input.scene.height);
    for (int y = top; y < end; ++y) {
      for (int column = 0; column < blocks.columns; ++column) {
        const std::size_t at = blocks.at(column, block_row);
        if (!(blocks.largest[at] > kStandsOut * blocks.least[at])) continue;
        const int left = column * kLightBlock;
        const std::uint32_t bright =
            bright_pixels(input, left, y, light_row(levels, column, y), pool.isa());
        find_in_span(input, levels, y, left, bright, found[static_cast<std::size_t>(block_row)]);
      }
    }
  });
  return found;
}

Image without(const DofInput& input, const std::vector<std::vector<DiscHighlight>>& found,
              ThreadPool& pool) {
  Image rest = copy_of(input.scene, pool);
  pool.for_each(static_cast<int>(found.size()), [&](int block_row) {
    for (const DiscHighlight& highlight : found[static_cast<std::size_t>(block_row)]) {
      std::copy(highlight.rest.begin(), highlight.rest.end(),
                row<std::uint16_t>(rest, highlight.y).begin() + 4 * highlight.x);
    }
  });
  return rest;
}

// Numbers the discs that are used, and makes them.
struct DiscNumbers {
  std::vector<std::int32_t> number;  // by radius; -1 if none has it
  std::vector<double> radii_px;

  std::uint32_t of(float radius_px) {
    const double steps =
        std::floor(static_cast<double>(std::fabs(radius_px)) * kDiscsPerPixel + 0.5);
    std::int32_t& found = number[static_cast<std::size_t>(steps)];
    if (found < 0) {
      found = static_cast<std::int32_t>(radii_px.size());
      radii_px.push_back(steps / kDiscsPerPixel);
    }
    return static_cast<std::uint32_t>(found);
  }
};

// The rungs of both sides, in the order of DiscHighlights::rungs, and where each begins.
struct AllRungs {
  std::vector<LitRung> rungs;
  std::vector<RungStep> steps;  // of one side, and one more

  std::size_t at(int side, std::size_t rung) const {
    return side == 0 ? steps.size() - 2 - rung : steps.size() - 1 + rung;
  }
};

AllRungs all_rungs(const std::vector<LevelRungs>& ladder, int width, int height) {
  AllRungs all;
  std::vector<LitRung> behind;
  for (std::size_t level = 0; level < ladder.size(); ++level) {
    for (std::size_t i = 0; i < ladder[level].rungs.size(); ++i) {
      const bool first = level > 0 && i == 0;
      all.steps.push_back(first ? ladder[level - 1].beyond : ladder[level].rungs[i].step);
      LitRung rung{level, i, 1, 0, {}, {}, {}, 0, 0};
      rung.block_columns = ((width - 1) >> level) / kDiscBlock + 1;
      rung.block_rows = ((height - 1) >> level) / kDiscBlock + 1;
      behind.push_back(rung);
    }
  }
  all.steps.push_back(ladder.back().beyond);
  all.rungs.assign(behind.rbegin(), behind.rend());
  for (LitRung& rung : all.rungs) rung.side = 0;
  all.rungs.insert(all.rungs.end(), behind.begin(), behind.end());
  return all;
}

void add_part(const LitPart& part, int reach, LitRung& rung) {
  rung.reach = std::max(rung.reach, reach);
  rung.parts.push_back(part);
  if (rung.blocks.empty()) {
    rung.blocks.resize(static_cast<std::size_t>(rung.block_columns * rung.block_rows));
  }
  const int column = (part.x >> rung.level) / kDiscBlock, row = (part.y >> rung.level) / kDiscBlock;
  rung.blocks[static_cast<std::size_t>(row * rung.block_columns + column)] = 1;
}

void add_highlight(const DiscHighlight& highlight, std::uint32_t disc, AllRungs& all) {
  const float square = highlight.radius_px * highlight.radius_px;
  const int reach = static_cast<int>(std::fabs(highlight.radius_px)) + 2;
  for (std::size_t i = 1; i + 1 < all.steps.size(); ++i) {
    const float share = share_from(all.steps[i], square) - share_from(all.steps[i + 1], square);
    if (share == 0.0f) continue;
    LitPart part{highlight.x, highlight.y, disc, {}};
    for (std::size_t c = 0; c < 3; ++c) {
      part.units[c] = static_cast<double>(highlight.light[c]) * static_cast<double>(share);
    }
    add_part(part, reach, all.rungs[all.at(highlight.radius_px < 0.0f ? 0 : 1, i)]);
  }
}

void count_rows(LitRung& rung, int height) {
  std::size_t above = 0;
  for (int y = 0; y <= height; ++y) {
    while (above < rung.parts.size() && rung.parts[above].y < y) ++above;
    rung.parts_above.push_back(above);
  }
}

// Half the part of a row of pixels' height that lies in a disc, at each of 16 heights.
constexpr int kHeights = 16;
std::array<double, kHeights> half_widths(double radius_px, int dy) {
  std::array<double, kHeights> widths{};
  for (int i = 0; i < kHeights; ++i) {
    const double y = dy - 0.5 + (i + 0.5) / kHeights;
    const double square = radius_px * radius_px - y * y;
    widths[static_cast<std::size_t>(i)] = square > 0.0 ? std::sqrt(square) : 0.0;
  }
  return widths;
}

ExactDisc exact_disc(double radius_px) {
  ExactDisc disc;
  for (int dy = 0;; ++dy) {
    const std::array<double, kHeights> widths = half_widths(radius_px, dy);
    const double least = *std::min_element(widths.begin(), widths.end());
    const double largest = *std::max_element(widths.begin(), widths.end());
    if (largest == 0.0) return disc;
    const int whole = static_cast<int>(std::floor(least - 0.5));
    const int outer = std::max(static_cast<int>(std::ceil(largest - 0.5)), 0);
    disc.rows.push_back({whole, outer, disc.covers.size()});
    double row = whole < 0 ? 0.0 : 2.0 * whole + 1.0;
    for (int dx = whole + 1; dx <= outer; ++dx) {
      double cover = 0.0;
      for (const double width : widths) {
        cover += dx == 0 ? std::fmin(2.0 * width, 1.0)
                         : std::fmax(std::fmin(width - dx + 0.5, 1.0), 0.0);
      }
      disc.covers.push_back(cover / kHeights);
      row += (dx == 0 ? 1.0 : 2.0) * cover / kHeights;
    }
    disc.area += dy == 0 ? row : 2.0 * row;
  }
}

}  // namespace

DiscHighlights find_highlights(const DofInput& input, const std::vector<LevelRungs>& ladder,
                               ThreadPool& pool) {
  DiscHighlights result;
  const std::vector<std::vector<DiscHighlight>> found = find_by_blocks(input, pool);
  const auto none = [](const std::vector<DiscHighlight>& row) { return row.empty(); };
  if (std::all_of(found.begin(), found.end(), none)) return result;
  result.rest = without(input, found, pool);
  const auto steps = static_cast<std::size_t>(std::ceil(input.settings.max_coc_px * 32.0f)) + 2;
  DiscNumbers numbers{std::vector<std::int32_t>(steps, -1), {}};
  AllRungs all = all_rungs(ladder, input.scene.width, input.scene.height);
  for (const std::vector<DiscHighlight>& rows : found) {
    for (const DiscHighlight& highlight : rows) {
      add_highlight(highlight, numbers.of(highlight.radius_px), all);
    }
  }
  result.discs.resize(numbers.radii_px.size());
  pool.for_each(static_cast<int>(result.discs.size()), [&](int disc) {
    const auto i = static_cast<std::size_t>(disc);
    result.discs[i] = exact_disc(numbers.radii_px[i]);
  });
  for (LitRung& rung : all.rungs) {
    if (rung.parts.empty()) continue;
    for (LitPart& part : rung.parts) {
      const double scale = 1.0 / (result.discs[part.disc].area * kLightUnit);
      for (double& units : part.units) units *= scale;
    }
    count_rows(rung, input.scene.height);
    result.rungs.push_back(std::move(rung));
  }
  return result;
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

SOFTFOCUS_INLINE Floats positive(Bits half) {
  return smaller(larger(half_to_float(half), splat(0.0f)), splat(65504.0f));
}

// The largest of red, green and blue.
SOFTFOCUS_INLINE Floats light_of(const HalfTexels& texels) {
  return larger(larger(positive(texels.r), positive(texels.g)), positive(texels.b));
}

}  // namespace

/// Adds a row's light to sums and maxima of columns.
void add_light_columns(const std::uint16_t* from, int width, float* sums, float* largest) {
  for (int x = 0; x < width; x += kLanes) {
    const Floats light = light_of(load_repeating(from, x, width));
    store(sums + x, load(sums + x) + light);
    store(largest + x, larger(load(largest + x), light));
  }
}

/// A bit for each pixel of a block's row that may be a highlight. It is set where larger blocks
/// are needed, and where highlight_part(), in its order of operations, is above 0.
std::uint32_t bright_pixels(const DofSettings& settings, const std::uint16_t* from, int x,
                            int width, const LightRow& row) {
  std::uint32_t bright = 0;
  for (int i = 0; i < kLightBlock && x + i < width; i += kLanes) {
    const HalfTexels texels = load_repeating(from, x + i, width);
    const Floats light = light_of(texels);
    const Mask lit = (light > kStandsOut * row.least) & first_lanes(width - x - i);
    if (!any(lit)) continue;
    const Floats radius = split_radius(settings, half_to_float(texels.a));
    const Floats square = radius * radius;
    const Ints lane = lane_numbers() + i;
    const Mask later = lane >= kLightBlock / 2;  // between the second and the third
    const Floats right =
        (to_floats(lane) + 0.5f) * (1.0f / kLightBlock) + select(later, splat(-0.5f), splat(0.5f));
    Floats mean[2];
    for (int j = 0; j < 2; ++j) {
      const float* of = row.means[j];
      mean[j] = (1.0f - right) * select(later, splat(of[1]), splat(of[0])) +
                right * select(later, splat(of[2]), splat(of[1]));
    }
    const Floats around = (1.0f - row.below) * mean[0] + row.below * mean[1];
    const Mask stands_out = kStandsOut * around / light < 1.0f;
    bright |= lane_bits(lit & (square > 1.0f) & (stands_out | (square >= row.larger_squares))) << i;
  }
  return bright;
}

#endif
