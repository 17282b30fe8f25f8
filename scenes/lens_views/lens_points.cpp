#include "scenes/lens_views/lens_points.h"

#include <cmath>

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

}  // namespace softfocus
