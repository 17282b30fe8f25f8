#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).
// There is no scalar form: Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/polygon/polygon_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "raster/numbers/exact_math.h"
#include "raster/threads/loops.h"

namespace softfocus {

// A run of receivers. Pointers are to a tap's neighbour of the first receiver.
struct PolygonRow {
  const float* own;
  const float* const* taps;
  const float* shares;
  std::ptrdiff_t plane;
  int reach, taps_a_step, count;
  float middle, half;
  float* result;
  std::ptrdiff_t result_plane;
};

// The use of a part's picture for those of its group before it.
enum class PartUse { first, add, least, most };

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/polygon/polygon_lines.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// Up to here a size is none, as in half_fields.h.
constexpr int kLineRows = 8;

struct Direction {
  double x, y;  // down
};

double length(Direction d) { return std::sqrt(d.x * d.x + d.y * d.y); }
bool goes_by_columns(Direction d) { return std::fabs(d.x) >= std::fabs(d.y); }
// Rows a column, or columns a row.
double slope(Direction d) { return goes_by_columns(d) ? d.y / d.x : d.x / d.y; }

// The segment from `begin` to `end` along a direction of length 1: a receiver gathers against it.
PolygonLine make_line(Direction along, double begin, double end, double hat, float largest) {
  const bool by_columns = goes_by_columns(along);
  const double major = by_columns ? along.x : along.y;
  // Steps go to the right or down, whichever way the direction does.
  const double steps = -major;
  PolygonLine line{};
  line.middle = static_cast<float>(0.5 * (begin + end) * steps);
  line.half = static_cast<float>(0.5 * (end - begin) * std::fabs(steps));
  line.reach = static_cast<int>(std::fmax(std::fabs(begin), std::fabs(end)) * std::fabs(steps) *
                                static_cast<double>(largest)) +
               2;
  line.taps_a_step = hat > 1.0 ? 4 : slope(along) == 0.0 ? 1 : 2;
  for (int n = -line.reach; n <= line.reach; ++n) {
    const double minor = n * slope(along);
    const double below = std::floor(minor);
    for (int k = 0; k < line.taps_a_step; ++k) {
      const int at = static_cast<int>(below) + k - (hat > 1.0 ? 1 : 0);
      const double share = std::fmax(0.0, 1.0 - std::fabs(at - minor) / hat) / hat;
      line.taps.push_back(by_columns ? LineTap{n, at, static_cast<float>(share)}
                                     : LineTap{at, n, static_cast<float>(share)});
    }
  }
  return line;
}

std::array<PolygonLine, 2> make_part(Direction first, Direction second, double begin, double end,
                                     float largest) {
  double hat = 1.0;
  if (goes_by_columns(first) == goes_by_columns(second)) {
    hat = std::fmax(1.0, std::fabs(slope(first)) + std::fabs(slope(second)));
  }
  return {make_line(first, begin, end, 1.0, largest), make_line(second, begin, end, hat, largest)};
}

Direction corner(int corners, int i) {
  const double degrees = 90.0 + 360.0 * i / corners;
  // Level and upright lines are so exactly.
  const auto cut = [](double value) { return std::fabs(value) < 1e-9 ? 0.0 : value; };
  return {cut(exact_math::cos_degrees(degrees)), cut(-exact_math::sin_degrees(degrees))};
}

Direction side(int from, int to) {
  const Direction a = corner(5, from), b = corner(5, to);
  Direction d{b.x - a.x, b.y - a.y};
  if (std::fabs(d.y) < 1e-9) d.y = 0.0;
  const double all = length(d);
  return {d.x / all, d.y / all};
}

int largest_reach(const PolygonLines& lines) {
  int reach = 0;
  for (const auto& part : lines.parts) {
    for (const PolygonLine& line : part) reach = std::max(reach, line.reach);
  }
  return reach;
}

}  // namespace

PolygonLines polygon_lines(int corners, float largest, bool upside_down) {
  PolygonLines lines{{}, 0.0f};
  if (corners == 6) {
    const double begin = upside_down ? -1.0 : 0.0;
    lines.parts = {make_part(corner(6, 0), corner(6, 2), begin, begin + 1.0, largest),
                   make_part(corner(6, 0), corner(6, 4), begin, begin + 1.0, largest),
                   make_part(corner(6, 2), corner(6, 4), begin, begin + 1.0, largest)};
    return lines;
  }
  // Directions in a pentagon in a circle of radius 1: from a corner to the middle, along both its
  // sides; the sides of the parallelogram around it, and its own.
  const Direction u = side(0, 1), w = side(0, 4);
  const double sine = exact_math::sin_degrees(72.0);
  const double before = 1.0 / length({u.x + w.x, u.y + w.y});
  const double around = (1.0 + exact_math::cos_degrees(36.0)) / sine;
  const double own = 2.0 * exact_math::sin_degrees(36.0);
  for (const double all : {around, own}) {
    const double begin = upside_down ? before - all : -before;
    lines.parts.push_back(make_part(u, w, begin, begin + all, largest));
    lines.parts.push_back(make_part(side(2, 3), side(2, 1), begin, begin + all, largest));
    lines.parts.push_back(make_part(side(3, 2), side(3, 4), begin, begin + all, largest));
  }
  // A lone cell's light, L / (around^2 sine) + (1 - L) / (own^2 sine), over the pentagon's area.
  const double of_own = 1.0 / (own * own * sine), of_all = 1.0 / (2.5 * sine);
  lines.least_share =
      static_cast<float>((of_own - of_all) / (of_own - 1.0 / (around * around * sine)));
  return lines;
}

LineField make_line_field(bool near, int width, int height, int reach, ThreadPool& pool) {
  LineField field{near, width, height, reach + 2, {}, {}};
  field.planes = make_planes(kLinePlanes, width + 2 * field.margin + kMostLanes, height, pool);
  std::fill_n(field.planes.values.get(), kLinePlanes * field.planes.plane, 0.0f);
  field.runs.assign(static_cast<std::size_t>(height), {{0, width}});
  return field;
}

void repeat_line_ends(LineField& field, int first, int count, int y) {
  for (int c = first; c < first + count; ++c) {
    float* row = line_row(field, c, y);
    std::fill_n(row - field.margin, field.margin, row[0]);
    std::fill_n(row + field.width, field.margin + kMostLanes, row[field.width - 1]);
  }
}

void blur_line(const PolygonLine& line, const LineField& from, LineField& to, ThreadPool& pool) {
  std::vector<float> shares;
  shares.reserve(line.taps.size());
  for (const LineTap& tap : line.taps) shares.push_back(tap.share);
  for_each_row_with<std::vector<const float*>>(
      pool, from.height, kLineRows, [&](int y, auto& taps) {
        taps.resize(line.taps.size());
        for (int c = 0; c < kLineValues; ++c) std::fill_n(line_row(to, c, y), to.width, 0.0f);
        for (const LineRun run : from.runs[static_cast<std::size_t>(y)]) {
          for (std::size_t i = 0; i < taps.size(); ++i) {
            const int row = std::clamp(y + line.taps[i].dy, 0, from.height - 1);
            taps[i] = line_row(from, 0, row) + run.begin + line.taps[i].dx;
          }
          const PolygonRow pass{line_row(from, 0, y) + run.begin,
                                taps.data(),
                                shares.data(),
                                from.planes.plane,
                                line.reach,
                                line.taps_a_step,
                                run.end - run.begin,
                                line.middle,
                                line.half,
                                line_row(to, 0, y) + run.begin,
                                to.planes.plane};
          SOFTFOCUS_KERNEL(pool.isa(), blur_along_line)(pass, from.near);
        }
        repeat_line_ends(to, 0, kLineValues, y);
      });
}

void blur_polygon(const PolygonLines& lines, LineField& field, ThreadPool& pool) {
  LineField across =
      make_line_field(field.near, field.width, field.height, largest_reach(lines), pool);
  LineField part =
      make_line_field(field.near, field.width, field.height, largest_reach(lines), pool);
  std::array<LineField, 2> groups{make_line_field(field.near, field.width, field.height, 0, pool),
                                  make_line_field(field.near, field.width, field.height, 0, pool)};
  across.runs = part.runs = field.runs;
  pool.for_each(field.height, [&](int y) {
    for (const int c : {kLineSize, kLineCounts}) {
      std::copy_n(line_row(field, c, y), field.width, line_row(across, c, y));
      repeat_line_ends(across, c, 1, y);
    }
  });
  const auto for_each_row = [&](const auto& use) {
    pool.for_each(field.height, [&](int y) {
      for (int c = 0; c < kLineValues; ++c) use(c, y);
    });
  };
  for (std::size_t i = 0; i < lines.parts.size(); ++i) {
    blur_line(lines.parts[i][0], field, across, pool);
    blur_line(lines.parts[i][1], across, part, pool);
    const std::size_t group = i / kPolygonParts;
    const PartUse use = i % kPolygonParts == 0      ? PartUse::first
                        : lines.least_share == 0.0f ? PartUse::add
                        : group == 0                ? PartUse::least
                                                    : PartUse::most;
    for_each_row([&](int c, int y) {
      SOFTFOCUS_KERNEL(pool.isa(), combine_parts)
      (line_row(part, c, y), use, field.width, line_row(groups[group], c, y));
    });
  }
  for_each_row([&](int c, int y) {
    SOFTFOCUS_KERNEL(pool.isa(), finish_polygon)
    (line_row(groups[0], c, y), line_row(groups[1], c, y), lines.least_share, field.width,
     line_row(field, c, y));
  });
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

constexpr float kLeastLineSize = 0.5f;

SOFTFOCUS_INLINE float largest_lane(Floats v) {
  float lanes[kLanes];
  store(lanes, v);
  float largest = 0.0f;
  for (int i = 0; i < kLanes; ++i) largest = lanes[i] > largest ? lanes[i] : largest;
  return largest;
}

SOFTFOCUS_INLINE void store_in(float* to, Floats v, int count) {
  if (count >= kLanes) return store(to, v);
  float lanes[kLanes];
  store(lanes, v);
  for (int i = 0; i < count; ++i) to[i] = lanes[i];
}

template <bool near>
SOFTFOCUS_INLINE void gather_line(const PolygonRow& row) {
  constexpr int kValues = near ? 4 : 3;
  for (int x = 0; x < row.count; x += kLanes) {
    const float* own = row.own + x;
    const Floats size = load(own + kLineSize * row.plane);
    const Mask blurred = (size > kLeastLineSize) & first_lanes(row.count - x);
    const Floats middle = size * row.middle;
    const Floats end = larger(size * row.half, splat(0.5f)) + 0.5f;
    const int limit =
        static_cast<int>(largest_lane(select(blurred, end + absolute(middle), splat(0.0f))));
    const int reach = limit < row.reach ? limit : row.reach;
    const Floats twice_inverse = 2.0f / larger(size, splat(kLeastLineSize));
    Floats here[kValues], sums[kValues] = {}, weights = splat(0.0f);
    for (int i = 0; i < kValues; ++i) here[i] = load(own + i * row.plane);
    for (int n = -reach; n <= reach; ++n) {
      const Floats inside = saturate(end - absolute(static_cast<float>(n) - middle));
      const int first = (n + row.reach) * row.taps_a_step;
      for (int k = first; k < first + row.taps_a_step; ++k) {
        const Floats weight = inside * row.shares[k];
        const float* from = row.taps[k] + x;
        Floats counts = splat(1.0f);
        if (!near) {
          counts = smaller(load(from + kLineCounts * row.plane) * twice_inverse, splat(1.0f));
        }
        for (int i = 0; i < kValues; ++i) {
          const Floats value = load(from + i * row.plane);
          const Floats counted = near ? value : here[i] + counts * (value - here[i]);
          sums[i] = sums[i] + weight * counted;
        }
        weights = weights + weight;
      }
    }
    for (int i = 0; i < kValues; ++i) {
      store_in(row.result + i * row.result_plane + x, select(blurred, sums[i] / weights, here[i]),
               row.count - x);
    }
  }
}

}  // namespace

void blur_along_line(const PolygonRow& row, bool near) {
  near ? gather_line<true>(row) : gather_line<false>(row);
}

void combine_parts(const float* part, PartUse use, int count, float* to) {
  for (int x = 0; x < count; x += kLanes) {
    const Floats more = load(part + x), before = load(to + x);
    const Floats all = use == PartUse::first   ? more
                       : use == PartUse::add   ? before + more
                       : use == PartUse::least ? smaller(before, more)
                                               : larger(before, more);
    store_in(to + x, all, count - x);
  }
}

/// The mean of a sum, or a mixture of the least and the most.
void finish_polygon(const float* first, const float* most, float least_share, int count,
                    float* to) {
  for (int x = 0; x < count; x += kLanes) {
    const Floats sum = load(first + x), above = load(most + x);
    const Floats all =
        least_share == 0.0f ? sum * (1.0f / 3.0f) : above + least_share * (sum - above);
    store_in(to + x, all, count - x);
  }
}

#endif
