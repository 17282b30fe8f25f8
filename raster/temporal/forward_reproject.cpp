#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include "raster/temporal/forward_reproject.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <vector>

#include "raster/images/image.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/temporal/split_texels.h"
#include "raster/threads/loops.h"

namespace softfocus {

/// The rows and columns that the pixels of a row go to, or -1.
struct ForwardRow {
  const float* motions_x;
  const float* motions_y;
  int width, height, y;
  std::int32_t* columns;  ///< up to whole vectors
  std::int32_t* rows;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "raster/temporal/forward_reproject.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kSpan = 64;       // pixels of the frame before that are skipped together
constexpr int kOwnedRows = 16;  // of the result, a thread at a time

struct Place {
  int x, y;
};
/// Halves above 0 are in the order of their bits.
bool has_depth(std::uint16_t bits) { return bits > 0 && bits <= 0x7C00; }

constexpr std::uint16_t kBehindAll = 0xFFFF;

/// As the profile stores a texel: NaN may change.
void store_moved(const std::uint16_t* from, const Profile& profile, std::uint16_t* to) {
  for (int c = 0; c < 4; ++c) to[c] = float_to_half(half_to_float(from[c]), profile.half_store);
}

/// Stores a row of texels in the same way; `planes` is memory to use again.
void store_row(const ConstImageView& from, int y, const Profile& profile, Isa isa,
               std::vector<float>& planes, std::uint16_t* to) {
  const std::ptrdiff_t plane = plane_floats(from.width);
  planes.resize(static_cast<std::size_t>(4 * plane));
  split_texels(from, y, 4, planes.data(), isa);
  const float* const first = planes.data() + 1;
  const float* const each[] = {first, first + plane, first + 2 * plane, first + 3 * plane};
  join_texels(each, from.width, profile.half_store, to, isa);
}

/// The places that all pixels go to, in rows of whole vectors, and the rows that each span goes to.
struct Targets {
  std::size_t pitch = 0, spans = 0;
  std::vector<std::int32_t> columns, rows;
  struct Reach {
    std::int32_t first, last;
  };
  std::vector<Reach> reaches;
};

Targets find_targets(const ConstImageView& velocity, ThreadPool& pool) {
  const int width = velocity.width, height = velocity.height;
  Targets targets;
  targets.pitch = static_cast<std::size_t>((width + kMostLanes - 1) / kMostLanes * kMostLanes);
  targets.spans = static_cast<std::size_t>((width + kSpan - 1) / kSpan);
  targets.columns.resize(targets.pitch * static_cast<std::size_t>(height));
  targets.rows.resize(targets.columns.size());
  targets.reaches.resize(targets.spans * static_cast<std::size_t>(height));
  for_each_band(pool, height, kPassRows, [&](int first, int end) {
    const std::ptrdiff_t plane = plane_floats(width);
    std::vector<float> motions(static_cast<std::size_t>(2 * plane));
    for (int y = first; y < end; ++y) {
      std::int32_t* columns = targets.columns.data() + static_cast<std::size_t>(y) * targets.pitch;
      std::int32_t* rows = targets.rows.data() + static_cast<std::size_t>(y) * targets.pitch;
      split_texels(velocity, y, 2, motions.data(), pool.isa());
      SOFTFOCUS_KERNEL(pool.isa(), find_row_targets)
      ({motions.data() + 1, motions.data() + plane + 1, width, height, y, columns, rows});
      for (int x = 0; x < width; x += kSpan) {
        Targets::Reach reach{height, -1};
        for (int i = x; i < std::min(x + kSpan, width); ++i) {
          if (rows[i] < 0) continue;
          reach = {std::min(reach.first, rows[i]), std::max(reach.last, rows[i])};
        }
        targets.reaches[static_cast<std::size_t>(y) * targets.spans +
                        static_cast<std::size_t>(x / kSpan)] = reach;
      }
    }
  });
  return targets;
}

/// Rows `first` to `end` - 1 of the result; returns their holes.
std::int64_t take_rows(const ConstImageView& before, const Targets& targets,
                       const ImageView& result, const Profile& profile, int first, int end) {
  const int width = before.width;
  std::vector<std::uint16_t> nearest(
      static_cast<std::size_t>(width) * static_cast<std::size_t>(end - first), kBehindAll);
  for (int y = first; y < end; ++y) {
    const auto pixels = row<std::uint16_t>(result, y);
    std::fill(pixels.begin(), pixels.end(), std::uint16_t{0});
  }
  for (int y = 0; y < before.height; ++y) {
    const std::uint16_t* texels = row<std::uint16_t>(before, y).data();
    const auto line = static_cast<std::size_t>(y);
    for (std::size_t span = 0; span < targets.spans; ++span) {
      const Targets::Reach reach = targets.reaches[line * targets.spans + span];
      if (reach.last < first || reach.first >= end) continue;
      const auto begin = static_cast<int>(span) * kSpan;
      for (int x = begin; x < std::min(begin + kSpan, width); ++x) {
        const std::size_t source = line * targets.pitch + static_cast<std::size_t>(x);
        const std::int32_t at_y = targets.rows[source], at_x = targets.columns[source];
        if (at_y < first || at_y >= end) continue;
        const std::uint16_t depth = texels[4 * x + 3];
        std::uint16_t& least =
            nearest[static_cast<std::size_t>(at_y - first) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(at_x)];
        if (!has_depth(depth) || depth >= least) continue;
        least = depth;
        store_moved(texels + 4 * x, profile,
                    row<std::uint16_t>(result, at_y).data() + std::ptrdiff_t{4} * at_x);
      }
    }
  }
  return std::count(nearest.begin(), nearest.end(), kBehindAll);
}

/// The texel that a hole takes, or nullptr.
const std::uint16_t* filler(const ConstImageView& scattered, int x, int y) {
  static constexpr std::array kWays{Place{-1, 0}, Place{1, 0}, Place{0, -1}, Place{0, 1}};
  const std::uint16_t* best = nullptr;
  for (const Place way : kWays) {
    for (int step = 1; step <= kHoleReach; ++step) {
      const int at_x = x + step * way.x, at_y = y + step * way.y;
      if (at_x < 0 || at_x >= scattered.width || at_y < 0 || at_y >= scattered.height) break;
      const std::uint16_t* texel =
          row<std::uint16_t>(scattered, at_y).data() + std::ptrdiff_t{4} * at_x;
      if (!has_depth(texel[3])) continue;
      if (best == nullptr || texel[3] > best[3]) best = texel;
      break;
    }
  }
  return best;
}

}  // namespace

std::int64_t forward_reproject(const ConstImageView& before, const ConstImageView& velocity,
                               const ImageView& result, const Profile& profile, ThreadPool& pool) {
  assert(before.format == Format::rgba16f && result.format == Format::rgba16f);
  assert(velocity.format == Format::rg16f && velocity.width == before.width &&
         velocity.height == before.height && result.width == before.width &&
         result.height == before.height);
  const Targets targets = find_targets(velocity, pool);
  const int bands = (before.height + kOwnedRows - 1) / kOwnedRows;
  std::vector<std::int64_t> holes(static_cast<std::size_t>(bands));
  pool.for_each(bands, [&](int band) {
    const int first = band * kOwnedRows;
    holes[static_cast<std::size_t>(band)] = take_rows(before, targets, result, profile, first,
                                                      std::min(first + kOwnedRows, before.height));
  });
  return std::accumulate(holes.begin(), holes.end(), std::int64_t{0});
}

std::int64_t fill_holes(const ConstImageView& scattered, const ImageView& result,
                        const Profile& profile, ThreadPool& pool) {
  assert(scattered.format == Format::rgba16f && result.format == Format::rgba16f);
  std::vector<std::int64_t> left(static_cast<std::size_t>(scattered.height));
  for_each_band(pool, scattered.height, kPassRows, [&](int first, int end) {
    std::vector<float> planes;
    for (int y = first; y < end; ++y) {
      const std::uint16_t* own = row<std::uint16_t>(scattered, y).data();
      std::uint16_t* to = row<std::uint16_t>(result, y).data();
      store_row(scattered, y, profile, pool.isa(), planes, to);
      for (int x = 0; x < scattered.width; ++x) {
        if (has_depth(own[4 * x + 3])) continue;
        const std::uint16_t* other = filler(scattered, x, y);
        if (other == nullptr) {
          ++left[static_cast<std::size_t>(y)];
        } else {
          store_moved(other, profile, to + 4 * x);
        }
      }
    }
  });
  return std::accumulate(left.begin(), left.end(), std::int64_t{0});
}

}  // namespace softfocus

#else  // the kernel

void find_row_targets(const ForwardRow& row) {
  const Floats width = splat(static_cast<float>(row.width));
  const Floats height = splat(static_cast<float>(row.height));
  const Floats line = splat(static_cast<float>(row.y)), none = splat(0.0f);
  for (int x = 0; x < row.width; x += kLanes) {
    const Floats at_x = floor(to_floats(x + lane_numbers()) + load(row.motions_x + x) + 0.5f);
    const Floats at_y = floor(line + load(row.motions_y + x) + 0.5f);
    const Mask inside = (at_x >= none) & (at_x < width) & (at_y >= none) & (at_y < height);
    store(row.columns + x, select(inside, truncate(select(inside, at_x, none)), splat(-1)));
    store(row.rows + x, select(inside, truncate(select(inside, at_y, none)), splat(-1)));
  }
}

#endif
