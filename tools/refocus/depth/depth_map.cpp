#include "tools/refocus/depth/depth_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace softfocus {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// Metres: what is nearer counts as so near, for single precision must hold 1/z.
constexpr double kNearest = 1e-9;

bool is_missing(float metres) { return metres != metres; }

bool means_missing(double code, const DepthReading& reading) {
  const DepthEncoding& encoding = *reading.encoding;
  if (code != code || code == -std::numeric_limits<double>::infinity()) return true;
  if (std::isinf(code)) return !encoding.infinity_is_far;
  if (code == 0.0 && encoding.zero_is_missing) return true;
  return std::find(reading.missing_codes.begin(), reading.missing_codes.end(), code) !=
         reading.missing_codes.end();
}

/// The distance along the ray of what lies at distance 1 along the axis.
double ray_length(int x, int y, int width, int height, const DepthReading& reading) {
  const double right =
      (x + 0.5 - width / 2.0 - reading.axis_x) * reading.pixel_aspect / reading.pixels_per_tangent;
  const double down = (y + 0.5 - height / 2.0 - reading.axis_y) / reading.pixels_per_tangent;
  return std::sqrt(1.0 + right * right + down * down);
}

double largest_of(NumberType type, const DepthEncoding& encoding) {
  return encoding.by_full_scale ? full_scale(type) : 1.0;
}

/// Walks over the places of a line, `count` of them, `step` apart from `first` on, and puts into
/// `found` the last known depth where that is farther, or nearer.
void sweep(const std::vector<float>& metres, std::vector<float>& found, Holes side,
           std::ptrdiff_t first, std::ptrdiff_t step, int count) {
  float last = kMissing;
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(first + i * step);
    if (!is_missing(metres[at])) {
      last = metres[at];
    } else if (!is_missing(last) &&
               !(side == Holes::near_side ? found[at] <= last : found[at] >= last)) {
      found[at] = last;
    }
  }
}

}  // namespace

CodeEnds::CodeEnds(NumberType type, const DepthReading& reading)
    : reading_(reading),
      full_(largest_of(type, *reading.encoding)),
      least_(std::numeric_limits<double>::infinity()),
      largest_(-least_) {}

void CodeEnds::add(std::span<const float> codes, std::span<const float> mask) {
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const double raw = static_cast<double>(codes[i]);
    if (means_missing(raw, reading_) || std::isinf(raw) || (!mask.empty() && mask[i] == 0.0f)) {
      continue;
    }
    const double code = raw / full_;
    least_ = std::min(least_, code);
    largest_ = std::max(largest_, code);
  }
}

void CodeEnds::put_in(DepthNumbers& numbers) const {
  numbers.least_code = least_;
  numbers.largest_code = largest_;
}

void codes_to_depths(std::span<float> codes, NumberType type, int first_row, int width, int height,
                     const DepthReading& reading, std::span<const float> mask) {
  const DepthEncoding& encoding = *reading.encoding;
  const double largest = largest_of(type, encoding);
  const int rows = static_cast<int>(codes.size() / static_cast<std::size_t>(width));
  std::size_t i = 0;
  for (int y = first_row; y < first_row + rows; ++y) {
    for (int x = 0; x < width; ++x, ++i) {
      const double raw = static_cast<double>(codes[i]);
      codes[i] = kMissing;
      if (means_missing(raw, reading) || (!mask.empty() && mask[i] == 0.0f)) continue;
      double metres = encoding.distance_m(raw / largest, reading.numbers);
      if (reading.along == DepthAlong::ray) {
        metres /= ray_length(x, y, width, height, reading);
      }
      if (metres > 0.0) codes[i] = static_cast<float>(std::max(metres, kNearest));
    }
  }
}

DepthMap depth_of_codes(PlaneValues codes, NumberType type, int width, int height,
                        const DepthReading& reading, const PlaneValues& mask) {
  CodeEnds ends{type, reading};
  ends.add(codes, mask);
  DepthReading full = reading;
  ends.put_in(full.numbers);
  codes_to_depths(codes, type, 0, width, height, full, mask);
  return {width, height, std::move(codes)};
}

PlaneValues codes_of_depth(const DepthMap& map, NumberType type, const DepthReading& reading) {
  const DepthEncoding& encoding = *reading.encoding;
  const double largest = largest_of(type, encoding);
  PlaneValues codes(map.metres.size(), kMissing);
  std::size_t i = 0;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x, ++i) {
      if (is_missing(map.metres[i])) continue;
      double metres = static_cast<double>(map.metres[i]);
      if (reading.along == DepthAlong::ray) {
        metres *= ray_length(x, y, map.width, map.height, reading);
      }
      codes[i] = static_cast<float>(encoding.code(metres, reading.numbers) * largest);
    }
  }
  return codes;
}

std::size_t missing_depths(const DepthMap& map) {
  return static_cast<std::size_t>(std::count_if(map.metres.begin(), map.metres.end(), is_missing));
}

void add_to_ends(DepthEnds& ends, std::span<const float> metres) {
  for (const float depth_m : metres) {
    if (std::isinf(depth_m)) ends.has_infinite = true;
    if (!std::isfinite(depth_m)) continue;
    ++ends.finite;
    ends.beyond_100_m += depth_m > 100.0f;
    ends.within_1_cm += depth_m < 0.01f;
    ends.near_m = std::min(ends.near_m, static_cast<double>(depth_m));
    ends.far_m = std::max(ends.far_m, static_cast<double>(depth_m));
  }
}

namespace {

void fill_from_side(DepthMap& map, Holes side) {
  const int width = map.width, height = map.height;
  // Twice: a pixel whose row and column know nothing finds a filled one in its row.
  for (int pass = 0; pass < 2 && missing_depths(map) > 0; ++pass) {
    std::vector<float> found(map.metres.size(), kMissing);
    for (int y = 0; y < height; ++y) {
      const std::ptrdiff_t start = std::ptrdiff_t{y} * width;
      sweep(map.metres, found, side, start, 1, width);
      sweep(map.metres, found, side, start + width - 1, -1, width);
    }
    for (int x = 0; x < width; ++x) {
      const std::ptrdiff_t last = x + std::ptrdiff_t{height - 1} * width;
      sweep(map.metres, found, side, x, width, height);
      sweep(map.metres, found, side, last, -width, height);
    }
    for (std::size_t i = 0; i < map.metres.size(); ++i) {
      if (is_missing(map.metres[i])) map.metres[i] = found[i];
    }
  }
}

/// A part of the map that hangs together by the sides of pixels. Either each has a depth or none.
struct Piece {
  bool is_hole = false;
  std::size_t size = 0, at_border = 0;  ///< pixels
};

struct Pieces {
  std::vector<Piece> all{};
  std::vector<std::uint32_t> of_pixel{};
};

Pieces pieces_of(const DepthMap& map) {
  constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
  Pieces pieces{.of_pixel = std::vector<std::uint32_t>(map.metres.size(), kNone)};
  const auto width = static_cast<std::size_t>(map.width);
  std::vector<std::size_t> waiting;
  for (std::size_t start = 0; start < map.metres.size(); ++start) {
    if (pieces.of_pixel[start] != kNone) continue;
    const auto number = static_cast<std::uint32_t>(pieces.all.size());
    Piece piece{.is_hole = is_missing(map.metres[start])};
    const auto visit = [&](std::size_t at) {
      if (pieces.of_pixel[at] != kNone || is_missing(map.metres[at]) != piece.is_hole) return;
      pieces.of_pixel[at] = number;
      waiting.push_back(at);
    };
    visit(start);
    while (!waiting.empty()) {
      const std::size_t at = waiting.back(), x = at % width;
      waiting.pop_back();
      const bool has_left = x > 0, has_right = x + 1 < width;
      const bool has_above = at >= width, has_below = at + width < map.metres.size();
      ++piece.size;
      piece.at_border += !(has_left && has_right && has_above && has_below);
      if (has_left) visit(at - 1);
      if (has_right) visit(at + 1);
      if (has_above) visit(at - width);
      if (has_below) visit(at + width);
    }
    pieces.all.push_back(piece);
  }
  return pieces;
}

/// The pixels of holes that are background.
std::vector<bool> background_of(const DepthMap& map) {
  const Pieces pieces = pieces_of(map);
  std::size_t largest_thing = 0;
  for (const Piece& piece : pieces.all) {
    if (!piece.is_hole) largest_thing = std::max(largest_thing, piece.size);
  }
  const auto stripe = static_cast<std::size_t>(std::max(1, std::min(map.width, map.height) / 32));
  const auto is_background = [&](const Piece& piece) {
    if (!piece.is_hole) return false;
    return piece.at_border > 0 ? piece.size > stripe * piece.at_border : piece.size > largest_thing;
  };
  std::size_t background = 0, missing = 0;
  for (const Piece& piece : pieces.all) {
    if (piece.is_hole) missing += piece.size;
    if (is_background(piece)) background += piece.size;
  }
  const bool are_all = 2 * background > missing;
  std::vector<bool> found(map.metres.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Piece& piece = pieces.all[pieces.of_pixel[i]];
    found[i] = are_all ? piece.is_hole : is_background(piece);
  }
  return found;
}

}  // namespace

std::size_t fill_holes(DepthMap& map, Holes holes) {
  if (missing_depths(map) == 0) return 0;
  std::vector<bool> infinite(map.metres.size());
  if (holes == Holes::background) infinite = background_of(map);
  for (std::size_t i = 0; i < infinite.size() && holes == Holes::infinity; ++i) {
    infinite[i] = is_missing(map.metres[i]);
  }
  fill_from_side(map, holes);
  std::size_t count = 0;
  for (std::size_t i = 0; i < infinite.size(); ++i) {
    if (!infinite[i]) continue;
    map.metres[i] = std::numeric_limits<float>::infinity();
    ++count;
  }
  return count;
}

DepthHistogram depth_histogram(const DepthMap& map, bool even) {
  DepthHistogram histogram;
  double least = std::numeric_limits<double>::infinity(), largest = -least;
  for (const float metres : map.metres) {
    histogram.infinite += std::isinf(metres);
    if (!std::isfinite(metres)) continue;
    least = std::min(least, static_cast<double>(metres));
    largest = std::max(largest, static_cast<double>(metres));
  }
  if (!(least <= largest)) return histogram;
  const std::size_t count = least < largest ? kDepthBins : 1;
  const auto border = [&](std::size_t i) {
    const double share = static_cast<double>(i) / static_cast<double>(count);
    if (i == 0) return least;
    if (i == count) return largest;
    return even ? least + share * (largest - least)
                : 1.0 / (1.0 / least + share * (1.0 / largest - 1.0 / least));
  };
  for (std::size_t i = 0; i < count; ++i) histogram.bins.push_back({border(i), border(i + 1), 0});
  for (const float metres : map.metres) {
    if (!std::isfinite(metres)) continue;
    const double z = static_cast<double>(metres);
    const auto bin = std::find_if(histogram.bins.begin(), histogram.bins.end() - 1,
                                  [z](const DepthBin& b) { return z < b.to; });
    ++bin->count;
  }
  return histogram;
}

}  // namespace softfocus
