#include "scenes/lens_views/shard.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "scenes/lens_views/accumulation.h"

namespace softfocus {

int most_shards(int samples) { return (samples + kSampleGroup - 1) / kSampleGroup; }

SampleRange samples_of(const Shard& shard, int samples) {
  const std::int64_t groups = most_shards(samples);
  assert(shard.number >= 1 && shard.number <= shard.count && shard.count <= groups);
  const auto end_of = [&](int number) {
    const auto group = static_cast<int>(groups * number / shard.count);
    return std::min(kSampleGroup * group, samples);
  };
  return {end_of(shard.number - 1), end_of(shard.number)};
}

SampleSums accumulation_sums(const LensViewInput& input, SampleRange range, ThreadPool& pool) {
  assert(!input.sampling.until && !input.sampling.by_tile);
  assert(range.begin % kSampleGroup == 0 && range.end <= input.sampling.samples);
  AccumulationBuffer buffer = make_accumulation_buffer(input, pool);
  place_views(buffer, input.sampling);
  SampleSums sums = make_sample_sums(input.pinhole.width, input.pinhole.height);
  for (int begin = range.begin; begin < range.end; begin += kLensViewGroup) {
    add_lens_views(buffer, input, begin, std::min(begin + kLensViewGroup, range.end), sums, pool);
    if (input.progress) input.progress(sums.count);
  }
  return sums;
}

bool are_exact(const SampleSums& sums) {
  constexpr double kLargestExact = 0x1p29;
  constexpr std::size_t kSums = 4;
  for (std::size_t i = 0; i < sums.totals.size(); ++i) {
    const bool is_alpha = i % kSums == 3;
    const double total = sums.totals[i];
    if (!is_alpha && std::isfinite(total) && total > kLargestExact) return false;
  }
  return true;
}

}  // namespace softfocus
