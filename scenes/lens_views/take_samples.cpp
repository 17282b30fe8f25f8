#include "scenes/lens_views/take_samples.h"

#include <algorithm>
#include <bit>

namespace softfocus {
namespace {

// Two sets of four points can agree by chance.
constexpr int kFirstComparison = 16;

bool is_power_of_two(int n) { return std::has_single_bit(static_cast<unsigned>(n)); }

}  // namespace

SampledPicture take_samples(const LensViewInput& input, const AddSamples& add_samples, int step,
                            ThreadPool& pool) {
  const Sampling& sampling = input.sampling;
  SampleSums sums = make_sample_sums(input.pinhole.width, input.pinhole.height);
  SampleSums first_half;
  SampledPicture result;
  while (sums.count < sampling.samples) {
    // Small steps up to the first comparison, which needs the first half.
    const int next = sums.count + (sums.count < kFirstComparison ? kSampleGroup : step);
    add_samples(sums.count, std::min(next, sampling.samples), sums);
    if (input.progress) input.progress(sums.count);
    if (!sampling.until || !is_power_of_two(sums.count)) continue;
    if (sums.count >= kFirstComparison) {
      result.half_set_rms = half_set_rms(first_half, sums, pool);
      if (*result.half_set_rms <= *sampling.until) break;
    }
    first_half = sums;
  }
  result.samples = sums.count;
  result.picture = mean_picture(sums, input.pinhole, input.profile, pool);
  return result;
}

}  // namespace softfocus
