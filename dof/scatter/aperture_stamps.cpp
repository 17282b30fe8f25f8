#include "dof/scatter/aperture_stamps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "raster/numbers/exact_math.h"

namespace softfocus {

const char* aperture_error(const Aperture& aperture) {
  if (aperture.blades != 0 && (aperture.blades < 3 || aperture.blades > kMostApertureBlades)) {
    return "an aperture has neither 0 nor 3 to 64 blades";
  }
  if (!std::isfinite(aperture.turn_degrees)) return "the aperture's turn is not finite";
  if (!(aperture.stretch >= 1.0f / kMostApertureStretch &&
        aperture.stretch <= kMostApertureStretch)) {
    return "the aperture's stretch is not from 1/16 to 16";
  }
  return nullptr;
}

namespace {

// A stamp's number is the radius's binary32, rounded to 12 bits behind the first, and above them a
// bit for what lies before the focus.
constexpr int kBitsLeftOut = 11;
constexpr std::uint32_t kUpsideDown = 1u << 20;
constexpr double kCoverUnit = 0x1p-20;

struct Corner {
  double x, y;  // to the right and down
};

struct Shape {
  std::vector<Corner> corners;  // none: round
  double across, down;          // half its width and height, of a circle
  double top, bottom;

  struct Ends {
    double left, right;
  };
  // The ends of the aperture's row at a height, for a circle of radius 1; none if left >= right.
  Ends ends_at(double height) const {
    const double y = height / down;
    if (corners.empty()) {
      const double square = 1.0 - y * y;
      const double half = square > 0.0 ? across * std::sqrt(square) : 0.0;
      return {-half, half};
    }
    Ends ends{2.0, -2.0};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Corner& a = corners[i];
      const Corner& b = corners[i + 1 < corners.size() ? i + 1 : 0];
      if ((a.y <= y) == (b.y <= y)) continue;
      const double x = across * (a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)));
      ends.left = std::fmin(ends.left, x);
      ends.right = std::fmax(ends.right, x);
    }
    return ends;
  }
};

Shape shape_of(const Aperture& aperture, bool upside_down) {
  const double stretch = static_cast<double>(aperture.stretch);
  const double down = std::fmin(1.0, stretch);
  Shape shape{{}, std::fmin(1.0, 1.0 / stretch), down, -down, down};
  for (int i = 0; i < aperture.blades; ++i) {
    const double degrees = 90.0 + static_cast<double>(aperture.turn_degrees) +
                           360.0 * i / aperture.blades + (upside_down ? 180.0 : 0.0);
    shape.corners.push_back({exact_math::cos_degrees(degrees), -exact_math::sin_degrees(degrees)});
  }
  if (!shape.corners.empty()) {
    const auto [highest, lowest] =
        std::minmax_element(shape.corners.begin(), shape.corners.end(),
                            [](const Corner& a, const Corner& b) { return a.y < b.y; });
    shape.top = down * highest->y;
    shape.bottom = down * lowest->y;
  }
  return shape;
}

struct MadeStamp {
  std::vector<StampRow> rows;
  std::vector<float> differences;
  int reach = 1;  // columns
  int above = 0;
  double covers = 0.0;
};

// The differences of a row's covers from pixel -reach - 1 on, by the midpoint rule.
void cover_row(const Shape& shape, double radius, int dy, int heights,
               std::vector<double>& differences) {
  std::fill(differences.begin(), differences.end(), 0.0);
  const double middle = 0.5 * static_cast<double>(differences.size() - 2);
  const auto add_end = [&](double x, double sign) {
    const double place = x + 0.5 + middle;
    const double pixel = std::floor(place);
    const auto at = static_cast<std::size_t>(pixel);
    differences[at] += sign * (1.0 - (place - pixel));
    differences[at + 1] += sign * (place - pixel);
  };
  // A level edge may lie anywhere in the row.
  const double from = std::fmax(dy - 0.5, radius * shape.top);
  const double step = (std::fmin(dy + 0.5, radius * shape.bottom) - from) / heights;
  for (int i = 0; step > 0.0 && i < heights; ++i) {
    const Shape::Ends ends = shape.ends_at((from + (i + 0.5) * step) / radius);
    if (!(ends.left < ends.right)) continue;
    add_end(radius * ends.left, step);
    add_end(radius * ends.right, -step);
  }
  // Whole units, so that what comes back at the right end is what was added at the left.
  double cover = 0.0, before = 0.0;
  for (double& difference : differences) {
    cover += difference;
    const double whole = std::floor(cover / kCoverUnit + 0.5) * kCoverUnit;
    difference = whole - before;
    before = whole;
  }
}

// The runs on either side of the longest stretch without a difference.
void append_row(const std::vector<double>& differences, int first_pixel, MadeStamp& stamp) {
  const auto size = differences.size();
  std::size_t begin = 0, end = size;
  while (begin < size && differences[begin] == 0.0) ++begin;
  while (end > begin && differences[end - 1] == 0.0) --end;
  std::size_t gap = end, gap_end = end, run = begin;
  for (std::size_t i = begin; i <= end; ++i) {
    if (i < end && differences[i] == 0.0) continue;
    if (i - run > gap_end - gap) {
      gap = run;
      gap_end = i;
    }
    run = i + 1;
  }
  const auto pixel = [&](std::size_t i) {
    return static_cast<std::int16_t>(static_cast<int>(i) + first_pixel);
  };
  stamp.rows.push_back({pixel(begin), pixel(gap_end), static_cast<std::uint16_t>(gap - begin),
                        static_cast<std::uint16_t>(end - gap_end),
                        static_cast<std::uint32_t>(stamp.differences.size())});
  for (std::size_t i = begin; i < end; ++i) {
    if (i < gap || i >= gap_end) stamp.differences.push_back(static_cast<float>(differences[i]));
  }
  double cover = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    cover += differences[i];
    stamp.covers += cover;
  }
}

MadeStamp made_stamp(const Shape& shape, double radius) {
  MadeStamp stamp;
  const int reach = std::max(0, static_cast<int>(std::ceil(radius - 0.5)));
  stamp.above = std::max(0, static_cast<int>(std::ceil(radius * shape.down - 0.5)));
  // So fine that a pixel's cover is right to a few millionths of the stamp.
  const int heights = std::clamp(static_cast<int>(1024.0 / std::fmax(radius, 1.0)), 32, 512);
  std::vector<double> differences(static_cast<std::size_t>(2 * reach + 4));
  stamp.reach = reach + 2;
  for (int dy = -stamp.above; dy <= stamp.above; ++dy) {
    cover_row(shape, radius, dy, heights, differences);
    append_row(differences, -reach - 1, stamp);
  }
  return stamp;
}

MadeStamp one_pixel() { return {{{0, 1, 1, 1, 0}}, {1.0f, -1.0f}, 1, 0, 1.0}; }

}  // namespace

std::uint32_t stamp_number(float radius_px, bool upside_down_differs) {
  const float magnitude = std::fabs(radius_px);
  if (!(magnitude > 0.5f)) return 0;
  const auto bits = std::bit_cast<std::uint32_t>(magnitude);
  const std::uint32_t number = (bits + (1u << (kBitsLeftOut - 1))) >> kBitsLeftOut;
  return number | (upside_down_differs && radius_px < 0.0f ? kUpsideDown : 0u);
}

ApertureStamps make_stamps(std::span<std::uint32_t> numbers, const Aperture& aperture,
                           ThreadPool& pool) {
  std::vector<std::uint32_t> index_of(2 * kUpsideDown, 0);
  for (const std::uint32_t number : numbers) index_of[number] = 1;
  std::vector<std::uint32_t> used;
  for (std::uint32_t number = 0; number < index_of.size(); ++number) {
    if (index_of[number] == 0) continue;
    index_of[number] = static_cast<std::uint32_t>(used.size());
    used.push_back(number);
  }
  for (std::uint32_t& number : numbers) number = index_of[number];

  const Shape upright = shape_of(aperture, false), upside_down = shape_of(aperture, true);
  std::vector<MadeStamp> made(used.size());
  pool.for_each(static_cast<int>(used.size()), [&](int i) {
    const std::uint32_t number = used[static_cast<std::size_t>(i)];
    const bool turned = (number & kUpsideDown) != 0;
    const auto radius =
        static_cast<double>(std::bit_cast<float>((number & ~kUpsideDown) << kBitsLeftOut));
    MadeStamp stamp =
        number == 0 ? one_pixel() : made_stamp(turned ? upside_down : upright, radius);
    if (!(stamp.covers > 0.0)) stamp = one_pixel();
    made[static_cast<std::size_t>(i)] = std::move(stamp);
  });
  ApertureStamps stamps;
  for (const MadeStamp& stamp : made) {
    const auto first = static_cast<std::uint32_t>(stamps.differences.size());
    stamps.stamps.push_back({static_cast<std::int32_t>(stamps.rows.size()) + stamp.above,
                             stamp.above, static_cast<float>(1.0 / stamp.covers)});
    stamps.reach = std::max(stamps.reach, stamp.reach);
    for (StampRow row : stamp.rows) {
      row.first += first;
      stamps.rows.push_back(row);
    }
    stamps.differences.insert(stamps.differences.end(), stamp.differences.begin(),
                              stamp.differences.end());
  }
  return stamps;
}

}  // namespace softfocus
