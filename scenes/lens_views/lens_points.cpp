#include "scenes/lens_views/lens_points.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "raster/numbers/exact_math.h"

namespace softfocus {
namespace {

std::uint32_t reversed(std::uint32_t bits) {
  bits = bits >> 16 | bits << 16;
  bits = (bits & 0xFF00FF00u) >> 8 | (bits & 0x00FF00FFu) << 8;
  bits = (bits & 0xF0F0F0F0u) >> 4 | (bits & 0x0F0F0F0Fu) << 4;
  bits = (bits & 0xCCCCCCCCu) >> 2 | (bits & 0x33333333u) << 2;
  return (bits & 0xAAAAAAAAu) >> 1 | (bits & 0x55555555u) << 1;
}

// Each bit is turned depending on those above it: Owen's scrambling, by Laine and Karras's
// hash, in which a bit depends on those below it, with the bits reversed.
std::uint32_t scrambled(std::uint32_t bits, std::uint32_t seed) {
  std::uint32_t x = reversed(bits) + seed;
  x ^= x * 0x6C50B47Cu;
  x ^= x * 0xB82F1E52u;
  x ^= x * 0xC7AFE638u;
  x ^= x * 0x8D22F6E6u;
  return reversed(x);
}

// Sobol's second axis: column k of the generator is row k of Pascal's triangle modulo 2.
std::uint32_t sobol(std::uint32_t index) {
  std::uint32_t column = 1u << 31, bits = 0;
  for (; index != 0; index >>= 1, column ^= column >> 1) {
    if ((index & 1u) != 0) bits ^= column;
  }
  return bits;
}

// Sobol's third axis, of the polynomial x^2 + x + 1: v_k = v_(k-1) ^ v_(k-2) ^ v_(k-2) / 4.
std::uint32_t sobol_third(std::uint32_t index) {
  std::uint32_t column = 1u << 31, next = 3u << 30, bits = 0;
  for (; index != 0; index >>= 1) {
    if ((index & 1u) != 0) bits ^= column;
    const std::uint32_t after = next ^ column ^ column >> 2;
    column = next;
    next = after;
  }
  return bits;
}

double centred_fraction(std::uint32_t bits, std::uint32_t seed) {
  constexpr std::uint32_t kHalf = 1u << 31;
  return static_cast<double>(scrambled(bits, seed) ^ scrambled(0, seed) ^ kHalf) * 0x1p-32;
}

constexpr std::uint32_t kLensSeries = 0;
constexpr std::uint32_t kPixelSeries = 1;
constexpr std::uint32_t kShutterSeed = 7;

}  // namespace

glm::dvec2 square_point(std::uint32_t index, std::uint32_t series) {
  const std::uint32_t seed = 2 * series;
  return {centred_fraction(reversed(index), seed + 1), centred_fraction(sobol(index), seed + 2)};
}

double shutter_point(std::uint32_t index) {
  return centred_fraction(sobol_third(index), kShutterSeed);
}

ApertureMap::ApertureMap(ApertureShape shape) {
  if (shape.blades == 0) return;
  for (int i = 0; i <= shape.blades; ++i) {
    const double degrees = 90.0 + 360.0 * i / shape.blades;
    corners_.emplace_back(exact_math::cos_degrees(degrees), exact_math::sin_degrees(degrees));
  }
}

glm::dvec2 ApertureMap::operator()(glm::dvec2 square) const {
  const double a = 2.0 * square.x - 1.0;
  const double b = 2.0 * square.y - 1.0;
  if (a == 0.0 && b == 0.0) return {0.0, 0.0};
  const bool sideways = std::fabs(a) > std::fabs(b);
  const double radius = sideways ? a : b;  // negative: on the other side
  const double degrees = sideways ? 45.0 * (b / a) : 90.0 - 45.0 * (a / b);
  if (corners_.empty()) {
    return {radius * exact_math::cos_degrees(degrees), radius * exact_math::sin_degrees(degrees)};
  }
  const double around = degrees / 360.0 + (radius < 0.0 ? 0.5 : 0.0);
  const double turn = around < 0.0 ? around + 1.0 : around;
  const auto blades = static_cast<double>(corners_.size() - 1);
  const double corner = std::fmin(std::floor(turn * blades), blades - 1.0);
  const auto at = static_cast<std::size_t>(corner);
  const double along = turn * blades - corner;
  return (corners_[at] + (corners_[at + 1] - corners_[at]) * along) * std::fabs(radius);
}

std::vector<glm::dvec2> lens_points(ApertureShape shape, int count) {
  const ApertureMap map{shape};
  std::vector<glm::dvec2> points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    points.push_back(map(square_point(static_cast<std::uint32_t>(i), kLensSeries)));
  }
  return points;
}

std::vector<glm::dvec2> pixel_offsets(bool jitter, int count) {
  std::vector<glm::dvec2> offsets(static_cast<std::size_t>(count), glm::dvec2{0.0});
  if (!jitter) return offsets;
  // Both sequences halve the square in the same order; shuffled within blocks of 2^k,
  // this one keeps its evenness and loses the order.
  const auto shuffled = [](std::uint32_t i) {
    constexpr std::uint32_t kShuffle = 5;
    return scrambled(i, kShuffle) ^ scrambled(0, kShuffle);
  };
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    offsets[i] = square_point(shuffled(static_cast<std::uint32_t>(i)), kPixelSeries) - 0.5;
  }
  return offsets;
}

namespace {

// Larger sets begin more evenly. FLIP is the same after twice as many steps.
constexpr int kStepsOfLargeSets = 30;
constexpr int kSteps = 100;
constexpr int kLargeSet = 65;
constexpr double kStep = 0.5;
constexpr double kMomentum = 0.5;

// (1 - t)^(1/2) = sum c_k t^k. The mean distance from a point to those of the disc grows with the
// point's distance r from the centre by -2 sum c_k c_(k+1) r^(2k+1), which is the integral over
// the disc's edge with both factors of |1 - r e^(i angle)| expanded. Past these terms it is off by
// less than 10^-3 at the edge, where no point lies.
constexpr int kTerms = 16;

constexpr std::array<double, kTerms> disc_terms() {
  std::array<double, kTerms> terms{};
  double c = 1.0;
  for (int k = 0; k < kTerms; ++k) {
    const double next = c * (k - 0.5) / (k + 1);
    terms[static_cast<std::size_t>(k)] = -2.0 * c * next;
    c = next;
  }
  return terms;
}

constexpr std::array<double, kTerms> kDiscTerms = disc_terms();

// The gradient of a point's mean distance to those of the aperture. Of a polygon it is the mean of
// -|point - edge| times the edge's normal, by the divergence theorem.
class MeanDistance {
 public:
  explicit MeanDistance(ApertureShape shape) {
    if (shape.blades == 0) return;
    constexpr int kNodes = 128;
    const int per_edge = (kNodes + shape.blades - 1) / shape.blades;
    std::vector<glm::dvec2> corners;
    for (int i = 0; i <= shape.blades; ++i) {
      const double degrees = 90.0 + 360.0 * i / shape.blades;
      corners.emplace_back(exact_math::cos_degrees(degrees), exact_math::sin_degrees(degrees));
    }
    const double area = 0.5 * shape.blades * exact_math::sin_degrees(360.0 / shape.blades);
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const glm::dvec2 step = (corners[i + 1] - corners[i]) / static_cast<double>(per_edge);
      for (int k = 0; k < per_edge; ++k) {
        nodes_.push_back({corners[i] + step * (k + 0.5), glm::dvec2{step.y, -step.x} / area});
      }
    }
  }

  glm::dvec2 gradient(glm::dvec2 point) const {
    if (nodes_.empty()) {
      const double square = point.x * point.x + point.y * point.y;
      double slope = 0.0;
      for (std::size_t k = kDiscTerms.size(); k-- > 0;) slope = slope * square + kDiscTerms[k];
      return point * slope;
    }
    glm::dvec2 sum{0.0};
    for (const Node& node : nodes_) {
      const glm::dvec2 apart = point - node.at;
      sum -= node.outward * std::sqrt(apart.x * apart.x + apart.y * apart.y);
    }
    return sum;
  }

 private:
  struct Node {
    glm::dvec2 at;
    glm::dvec2 outward;  // the normal, as long as the node's part of the edge, over the area
  };
  std::vector<Node> nodes_;  // none: a disc
};

void add_repulsion(std::span<const glm::dvec2> points, std::span<glm::dvec2> gradients) {
  const auto count = static_cast<double>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const glm::dvec2 apart = points[i] - points[j];
      const double distance = std::sqrt(apart.x * apart.x + apart.y * apart.y);
      if (distance == 0.0) continue;
      const glm::dvec2 unit = apart * (1.0 / (count * distance));
      gradients[i] -= unit;
      gradients[j] += unit;
    }
  }
}

// To multiples of 2^-32 whose sum is 0.
void centre(std::span<glm::dvec2> points) {
  constexpr double kUnits = 0x1p32;
  for (int axis = 0; axis < 2; ++axis) {
    double mean = 0.0;
    for (const glm::dvec2 point : points) mean += point[axis] / static_cast<double>(points.size());
    std::int64_t sum = 0;
    for (glm::dvec2& point : points) {
      const double units = std::floor((point[axis] - mean) * kUnits + 0.5);
      sum += static_cast<std::int64_t>(units);
      point[axis] = units;
    }
    for (glm::dvec2& point : points) {
      const std::int64_t excess = sum > 0 ? 1 : sum < 0 ? -1 : 0;
      sum -= excess;
      point[axis] = (point[axis] - static_cast<double>(excess)) / kUnits;
    }
  }
}

}  // namespace

std::vector<glm::dvec2> few_lens_points(ApertureShape shape, int count) {
  return growing_lens_points(shape, std::array{count});
}

std::vector<glm::dvec2> growing_lens_points(ApertureShape shape, std::span<const int> sizes) {
  const int count = sizes.back();
  assert(count >= 1 && count <= kMostLensPointsOfSet);
  const MeanDistance to_aperture{shape};
  std::vector<glm::dvec2> points = lens_points(shape, count);
  std::vector<glm::dvec2> gradients(points.size());
  std::vector<glm::dvec2> moves(points.size(), glm::dvec2{0.0});
  std::vector<double> sets(points.size());  // that a point is in
  for (const int size : sizes) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) sets[i] += 1.0;
  }
  const int steps = count < kLargeSet ? kSteps : kStepsOfLargeSets;
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      gradients[i] = to_aperture.gradient(points[i]) * sets[i];
    }
    for (const int size : sizes) {
      const auto in_set = static_cast<std::size_t>(size);
      add_repulsion(std::span{points}.first(in_set), std::span{gradients}.first(in_set));
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      moves[i] = moves[i] * kMomentum - gradients[i] * (kStep / sets[i]);
      points[i] += moves[i];
    }
  }
  std::size_t begin = 0;
  for (const int size : sizes) {
    const auto end = static_cast<std::size_t>(size);
    centre(std::span{points}.subspan(begin, end - begin));
    begin = end;
  }
  return points;
}

std::vector<glm::dvec2> lens_points_for(ApertureShape shape, int count) {
  return count <= kMostFewLensPoints ? few_lens_points(shape, count) : lens_points(shape, count);
}

}  // namespace softfocus
