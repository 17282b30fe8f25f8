#include "scenes/lens_views/samples_by_tile.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "raster/numbers/half.h"
#include "scenes/lens_views/few_pixel_offsets.h"
#include "scenes/lens_views/lens_points.h"
#include "scenes/lens_views/sample_sums.h"
#include "scenes/lens_views/shutter_times.h"

namespace softfocus {
namespace {

// A half's bits as a signed number: of those from 0 to 1 in their order; what is below 0 is less,
// what is above 1, and NaN, more.
constexpr std::int16_t kOne = 0x3C00;

std::vector<std::int16_t> brightness_table() {
  std::vector<std::int16_t> table;
  for (std::int16_t half = 0; half <= kOne; ++half) {
    const float value = half_to_float(static_cast<std::uint16_t>(half));
    table.push_back(static_cast<std::int16_t>(
        std::floor(std::sqrt(value) * static_cast<float>(kBrightnessSteps) + 0.5f)));
  }
  return table;
}

}  // namespace

std::uint64_t squared_difference(std::span<const std::uint16_t* const> views, int pixels) {
  static const std::vector<std::int16_t> brightness = brightness_table();
  constexpr int kRun = 64;  // halves, of 16 pixels
  std::uint64_t sum = 0;
  for (int begin = 0; begin < 4 * pixels; begin += kRun) {
    const int count = std::min(kRun, 4 * pixels - begin);
    std::array<std::int16_t, kRun> least{}, most{};
    least.fill(kOne);
    for (const std::uint16_t* view : views) {
      for (int i = 0; i < count; ++i) {
        const auto half = static_cast<std::int16_t>(view[begin + i]);
        const auto at = static_cast<std::size_t>(i);
        least[at] = std::min(least[at], half);
        most[at] = std::max(most[at], half);
      }
    }
    for (int i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (i % 4 == 3 || least[at] == most[at]) continue;
      const auto low = static_cast<std::size_t>(std::max<std::int16_t>(least[at], 0));
      const auto high = static_cast<std::size_t>(std::min(most[at], kOne));
      const int apart = brightness[high] - brightness[low];
      sum += static_cast<std::uint64_t>(apart * apart);
    }
  }
  return sum;
}

namespace {

constexpr int kGrowth = 8;

// In brightness, 0 to 1.
constexpr double kLeastDifference = 0.015;

std::vector<int> tiles_with_at_least(std::span<const int> counts, int samples) {
  std::vector<int> tiles;
  for (std::size_t tile = 0; tile < counts.size(); ++tile) {
    if (counts[tile] >= samples) tiles.push_back(static_cast<int>(tile));
  }
  return tiles;
}

double mean_count(const SampleSums& sums) {
  double total = 0.0;
  for (int y = 0; y < sums.height; y += kSumTile) {
    for (int x = 0; x < sums.width; x += kSumTile) {
      const int pixels = std::min(kSumTile, sums.width - x) * std::min(kSumTile, sums.height - y);
      total += static_cast<double>(pixels) * count_at(sums, x, y);
    }
  }
  return total / (static_cast<double>(sums.width) * sums.height);
}

}  // namespace

std::vector<int> tile_sample_sizes(int most) {
  std::vector<int> sizes;
  for (int size = kFirstTileViews; size < most; size *= kGrowth) {
    if (!sizes.empty() && size > most / 4) break;
    sizes.push_back(size);
  }
  sizes.push_back(most);
  return sizes;
}

int tile_samples(std::uint64_t squares, int pixels, std::span<const int> sizes) {
  const double mean = static_cast<double>(squares) / (3.0 * pixels);
  double enough = kLeastDifference * kLeastDifference * kBrightnessSteps * kBrightnessSteps;
  const double growth = std::sqrt(double{kGrowth} * kGrowth * kGrowth);
  std::size_t size = 0;
  for (; size + 1 < sizes.size() && mean > enough; ++size) enough *= growth;
  return sizes[size];
}

void place_growing_views(AccumulationBuffer& buffer, const Sampling& sampling) {
  const int most = sampling.samples;
  const bool opens = sampling.shutter_frames > 0.0;
  buffer.times.clear();
  if (most > kMostFewLensPoints) {
    buffer.points = lens_points(sampling.aperture, most);
    buffer.offsets = pixel_offsets(sampling.jitter, most);
    if (opens) buffer.times = times_in_frames(shutter_sequence(most), sampling.shutter_frames);
    return;
  }
  const std::vector<int> sizes = tile_sample_sizes(most);
  buffer.points = growing_lens_points(sampling.aperture, sizes);
  buffer.offsets =
      sampling.jitter ? growing_pixel_offsets(buffer.points, sizes) : pixel_offsets(false, most);
  if (!opens) return;
  buffer.times = times_in_frames(growing_shutter_times(buffer.points, buffer.offsets, sizes),
                                 sampling.shutter_frames);
}

SampledPicture accumulation_by_tile(AccumulationBuffer& buffer, const LensViewInput& input,
                                    ThreadPool& pool) {
  place_growing_views(buffer, input.sampling);
  const int most = input.sampling.samples;
  const std::vector<int> sizes = tile_sample_sizes(most);
  SampleSums sums = make_sample_sums(input.pinhole.width, input.pinhole.height);
  std::vector<int> counts(static_cast<std::size_t>(sums.tiles_x) *
                          static_cast<std::size_t>((sums.height + kSumTile - 1) / kSumTile));
  const auto look = [&](int tile, const Rectangle& area,
                        std::span<const std::uint16_t* const> views) {
    const int pixels = (area.x_end - area.x_begin) * (area.y_end - area.y_begin);
    counts[static_cast<std::size_t>(tile)] =
        tile_samples(squared_difference(views, pixels), pixels, sizes);
  };
  add_lens_views(buffer, input, 0, sizes.front(), sums, pool, {}, look);
  while (sums.count < most) {
    if (input.progress) input.progress(sums.count);
    const int step = sums.count < kLensViewGroup ? kSampleGroup : kLensViewGroup;
    const int end = std::min(sums.count + step, most);
    const std::vector<int> tiles = tiles_with_at_least(counts, end);
    if (tiles.empty()) break;
    add_lens_views(buffer, input, sums.count, end, sums, pool, tiles);
  }
  sums.tile_counts = std::move(counts);
  return picture_by_tile(sums, input, pool);
}

SampledPicture picture_by_tile(const SampleSums& sums, const LensViewInput& input,
                               ThreadPool& pool) {
  SampledPicture result;
  result.picture = mean_picture(sums, input.pinhole, input.profile, pool);
  result.samples = *std::max_element(sums.tile_counts.begin(), sums.tile_counts.end());
  result.mean_samples = mean_count(sums);
  return result;
}

}  // namespace softfocus
