#pragma once
// The samples of one picture shared out among machines: each shard sums some of them, and the sums
// of all shards together are those of one run, bit by bit.
//
// Why it does not matter who adds what: a half is a multiple of 2^-24, and so is the binary32 sum
// of a group of halves, even where it is rounded. A binary64 holds every multiple of 2^-24 up to
// 2^29. Light is never below 0, so a total up to 2^29 was rounded nowhere on its way, whatever the
// order. 8192 samples of the brightest half stay below that. The rays of ray-traced and the spread
// views of filtered-views are no halves: their sums are rounded, and depend on the order.

#include "scenes/lens_views/lens_view_method.h"
#include "scenes/lens_views/sample_sums.h"

namespace softfocus {

/// One of `count` parts of a work; the first is number 1.
struct Shard {
  int number = 1;
  int count = 1;
};

/// The samples `begin` to `end` - 1.
struct SampleRange {
  int begin = 0;
  int end = 0;
};

/// How many shards have something to do: one for each group of kSampleGroup samples.
int most_shards(int samples);

/// A shard's samples, of so many: whole groups, equally many but for one. At most most_shards().
SampleRange samples_of(const Shard& shard, int samples);

/// The sums of these samples of accumulation(), which takes `input.sampling.samples`. Neither with
/// Sampling::until nor with Sampling::by_tile. `begin` is a multiple of kSampleGroup.
SampleSums accumulation_sums(const LensViewInput& input, SampleRange range, ThreadPool& pool);

/// Whether no total of accumulation() was rounded. Infinity and NaN are what they are in any order.
bool are_exact(const SampleSums& sums);

}  // namespace softfocus
