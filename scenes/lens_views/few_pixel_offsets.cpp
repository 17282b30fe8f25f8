#include "scenes/lens_views/few_pixel_offsets.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

#include "scenes/lens_views/lens_points.h"

namespace softfocus {
namespace {

// Up to 64 points all rounds but the last few hardly change anything; more take too long.
constexpr int kPairingRounds = 8;
constexpr int kPairingRoundsOfLargeSets = 2;
constexpr std::size_t kLargePairing = 65;

using Offsets = std::vector<glm::dvec2>;

// From |x| + |y| <= 1, the aperture of four blades, to the pixel.
Offsets square_set(std::span<const int> sizes) {
  Offsets offsets = growing_lens_points({4}, sizes);
  for (glm::dvec2& p : offsets) p = glm::dvec2{p.x + p.y, p.x - p.y} * 0.5;
  return offsets;
}

void spread_over_columns(Offsets& offsets, int axis) {
  std::vector<std::size_t> order(offsets.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const double of_a = offsets[a][axis], of_b = offsets[b][axis];
    return of_a < of_b || (of_a == of_b && a < b);
  });
  for (std::size_t column = 0; column < order.size(); ++column) {
    offsets[order[column]][axis] = middle_of_column(column, order.size());
  }
}

// Which offset each point of the lens has, and both sets' centred distances.
struct Pairing {
  std::vector<double> of_points, of_offsets;
  std::vector<std::size_t> offset_of;
};

// What exchanging the offsets of two points adds to half the sum.
double gain(const Pairing& pairing, std::size_t i, std::size_t j) {
  const std::size_t n = pairing.offset_of.size();
  const double* points_i = &pairing.of_points[i * n];
  const double* points_j = &pairing.of_points[j * n];
  const std::size_t offset_i = pairing.offset_of[i], offset_j = pairing.offset_of[j];
  const double* offsets_i = &pairing.of_offsets[offset_i * n];
  const double* offsets_j = &pairing.of_offsets[offset_j * n];
  double change = 0.5 * (points_i[i] - points_j[j]) * (offsets_j[offset_j] - offsets_i[offset_i]);
  for (std::size_t k = 0; k < n; ++k) {
    if (k == i || k == j) continue;
    const std::size_t offset_k = pairing.offset_of[k];
    change += (points_i[k] - points_j[k]) * (offsets_j[offset_k] - offsets_i[offset_k]);
  }
  return change;
}

bool exchange(Pairing& pairing, std::size_t begin) {
  constexpr double kLeast = -1e-12;
  bool changed = false;
  for (std::size_t i = begin; i < pairing.offset_of.size(); ++i) {
    for (std::size_t j = begin; j < i; ++j) {
      if (gain(pairing, i, j) >= kLeast) continue;
      std::swap(pairing.offset_of[i], pairing.offset_of[j]);
      changed = true;
    }
  }
  return changed;
}

// Pairs the offsets from `begin` on anew, with those before as they are.
void pair_offsets(std::span<const glm::dvec2> lens_points, std::span<glm::dvec2> offsets,
                  std::size_t begin) {
  const std::vector<std::size_t> offset_of =
      independent_pairing(centred_distances(lens_points), centred_distances(offsets), begin);
  const Offsets before{offsets.begin(), offsets.end()};
  for (std::size_t i = begin; i < offsets.size(); ++i) offsets[i] = before[offset_of[i]];
}

}  // namespace

std::vector<double> centred_distances(std::span<const glm::dvec2> points) {
  const std::size_t n = points.size();
  const auto share = 1.0 / static_cast<double>(n);
  std::vector<double> distances, means(n);
  distances.reserve(n * n);
  double mean = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const glm::dvec2 apart = points[i] - points[j];
      distances.push_back(std::sqrt(apart.x * apart.x + apart.y * apart.y));
      means[i] += distances.back() * share;
    }
    mean += means[i] * share;
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) distances[i * n + j] += mean - means[i] - means[j];
  }
  return distances;
}

std::vector<std::size_t> independent_pairing(std::vector<double> of_first,
                                             std::vector<double> of_second, std::size_t begin) {
  Pairing pairing{std::move(of_first), std::move(of_second), {}};
  pairing.offset_of.resize(static_cast<std::size_t>(std::sqrt(pairing.of_points.size()) + 0.5));
  std::iota(pairing.offset_of.begin(), pairing.offset_of.end(), std::size_t{0});
  const int rounds =
      pairing.offset_of.size() < kLargePairing ? kPairingRounds : kPairingRoundsOfLargeSets;
  for (int round = 0; round < rounds && exchange(pairing, begin); ++round) {
  }
  return std::move(pairing.offset_of);
}

double middle_of_column(std::size_t column, std::size_t columns) {
  const auto n = static_cast<double>(columns);
  return std::trunc((2.0 * static_cast<double>(column) + 1.0 - n) / (2.0 * n) * 0x1p32) * 0x1p-32;
}

std::vector<glm::dvec2> few_pixel_offsets(std::span<const glm::dvec2> lens_points) {
  assert(!lens_points.empty() && lens_points.size() <= kMostFewLensPoints);
  Offsets offsets = square_set(std::array{static_cast<int>(lens_points.size())});
  for (const int axis : {0, 1}) spread_over_columns(offsets, axis);
  pair_offsets(lens_points, offsets, 0);
  return offsets;
}

std::vector<glm::dvec2> growing_pixel_offsets(std::span<const glm::dvec2> lens_points,
                                              std::span<const int> sizes) {
  assert(lens_points.size() == static_cast<std::size_t>(sizes.back()));
  Offsets offsets = square_set(sizes);
  std::size_t begin = 0;
  for (const int size : sizes) {
    const auto count = static_cast<std::size_t>(size);
    pair_offsets(lens_points.first(count), std::span{offsets}.first(count), begin);
    begin = count;
  }
  return offsets;
}

std::vector<glm::dvec2> view_offsets(bool jitter, std::span<const glm::dvec2> lens_points) {
  if (jitter && lens_points.size() <= kMostFewLensPoints) return few_pixel_offsets(lens_points);
  return pixel_offsets(jitter, static_cast<int>(lens_points.size()));
}

}  // namespace softfocus
