#include "scenes/lens_views/shutter_times.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "scenes/lens_views/few_pixel_offsets.h"
#include "scenes/lens_views/lens_points.h"

namespace softfocus {
namespace {

// An offset lies within half a pixel, a point of the lens within 1: both sets as wide.
constexpr double kOffsetWeight = 2.0;

std::vector<double> evenly_spread(std::vector<double> times) {
  std::vector<std::size_t> order(times.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return times[a] < times[b]; });
  for (std::size_t column = 0; column < order.size(); ++column) {
    times[order[column]] = middle_of_column(column, order.size());
  }
  return times;
}

// Pairs the times from `begin` on anew, with those before as they are.
void pair_times(std::span<const glm::dvec2> lens_points, std::span<const glm::dvec2> offsets,
                std::span<double> times, std::size_t begin) {
  std::vector<double> of_views = centred_distances(lens_points);
  const std::vector<double> of_offsets = centred_distances(offsets);
  for (std::size_t i = 0; i < of_views.size(); ++i) of_views[i] += kOffsetWeight * of_offsets[i];
  std::vector<glm::dvec2> on_a_line;
  for (const double time : times) on_a_line.emplace_back(time, 0.0);
  const std::vector<std::size_t> time_of =
      independent_pairing(std::move(of_views), centred_distances(on_a_line), begin);
  for (std::size_t i = begin; i < times.size(); ++i) times[i] = on_a_line[time_of[i]].x;
}

}  // namespace

std::vector<double> shutter_times(std::span<const glm::dvec2> lens_points,
                                  std::span<const glm::dvec2> offsets) {
  std::vector<double> times = evenly_spread(shutter_sequence(static_cast<int>(lens_points.size())));
  if (times.size() <= kMostFewLensPoints) pair_times(lens_points, offsets, times, 0);
  return times;
}

std::vector<double> growing_shutter_times(std::span<const glm::dvec2> lens_points,
                                          std::span<const glm::dvec2> offsets,
                                          std::span<const int> sizes) {
  std::vector<double> times = shutter_sequence(sizes.back());
  std::size_t begin = 0;
  for (const int size : sizes) {
    const auto count = static_cast<std::size_t>(size);
    pair_times(lens_points.first(count), offsets.first(count), std::span{times}.first(count),
               begin);
    begin = count;
  }
  return times;
}

std::vector<double> shutter_sequence(int count) {
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    times.push_back(shutter_point(static_cast<std::uint32_t>(i)) - 0.5);
  }
  return times;
}

}  // namespace softfocus
