#include "scenes/lens_views/shard.h"

#include <doctest/doctest.h>

#include <limits>

#include "scenes/lens_views/accumulation.h"
#include "scenes/load/load_scene.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

/// The totals of b are added to those of a, as a file's are.
void add(SampleSums& a, const SampleSums& b) {
  for (std::size_t i = 0; i < a.totals.size(); ++i) a.totals[i] += b.totals[i];
  a.count += b.count;
}

SampleSums sum_of(std::span<const Image> pictures, ThreadPool& pool) {
  SampleSums sums = make_sample_sums(pictures[0].width, pictures[0].height);
  for (std::size_t first = 0; first < pictures.size(); first += kSampleGroup) {
    const std::size_t count = std::min<std::size_t>(kSampleGroup, pictures.size() - first);
    add_pictures(pictures.subspan(first, count), sums, pool);
  }
  return sums;
}

}  // namespace

TEST_CASE("shards: whole groups, each in one shard, equally many but for one") {
  for (const int samples : {1, 7, 8, 9, 64, 100, 8192, kMostSamples}) {
    for (const int count : {1, 2, 3, 5, 8, 100, 8192}) {
      if (count > most_shards(samples)) continue;
      int next = 0, fewest = kMostSamples, most = 0;
      for (int number = 1; number <= count; ++number) {
        const SampleRange range = samples_of({number, count}, samples);
        CHECK(range.begin == next);
        CHECK(range.begin % kSampleGroup == 0);
        const int groups = most_shards(range.end - range.begin);
        fewest = std::min(fewest, groups);
        most = std::max(most, groups);
        next = range.end;
      }
      CHECK(next == samples);
      CHECK(fewest >= 1);
      CHECK(most - fewest <= 1);
    }
  }
}

TEST_CASE("shards: sums of any halves from 0 on are the same however they are grouped") {
  test::Random random{51};
  ThreadPool pool{2};
  const int samples = 83;
  std::vector<Image> pictures;
  for (int i = 0; i < samples; ++i) {
    pictures.push_back(make_image(Format::rgba16f, 21, 3));
    for (int y = 0; y < 3; ++y) {
      // From the least subnormal to infinity.
      for (std::uint16_t& half : row<std::uint16_t>(pictures.back(), y)) {
        half = static_cast<std::uint16_t>(random.next() % 0x7C01u);
      }
    }
  }
  const SampleSums whole = sum_of(pictures, pool);
  CHECK(are_exact(whole));
  for (const int count : {2, 3, 11}) {
    for (const bool from_the_last : {false, true}) {
      SampleSums joined = make_sample_sums(21, 3);
      for (int i = 1; i <= count; ++i) {
        const Shard shard{from_the_last ? count + 1 - i : i, count};
        const SampleRange range = samples_of(shard, samples);
        add(joined,
            sum_of(std::span{pictures}.subspan(static_cast<std::size_t>(range.begin),
                                               static_cast<std::size_t>(range.end - range.begin)),
                   pool));
      }
      CHECK(joined.count == samples);
      CHECK(joined.totals == whole.totals);
    }
  }
}

TEST_CASE("shards: sums that may have been rounded are known") {
  SampleSums sums = make_sample_sums(3, 2);
  *sums_at(sums, 2, 1) = 0x1p29;
  CHECK(are_exact(sums));
  *sums_at(sums, 2, 1) = std::numeric_limits<double>::infinity();
  CHECK(are_exact(sums));
  sums_at(sums, 2, 1)[3] = 0x1p40;  // alpha, which nobody reads
  CHECK(are_exact(sums));
  *sums_at(sums, 2, 1) = 0x1p29 + 0x1p-20;
  CHECK_FALSE(are_exact(sums));
}

TEST_CASE("shards: their sums are those of accumulation, with jitter and transparent surfaces") {
  const int width = 70, height = 40;
  const Profile profile{};
  ThreadPool pool{2};
  for (const char* name : {"figures", "glass"}) {
    CAPTURE(name);
    const Scene scene = load_scene(name, scene_search_path({}));
    const CameraMatrices camera = camera_matrices(scene.camera, 0.0, width, height);
    const Image pinhole = draw_scene(scene, camera, 0.0, width, height, profile, pool);
    // The second are points of the sequence, which is not made for their number.
    for (const int samples : {44, 280}) {
      const LensViewInput input{scene,
                                camera,
                                0.0,
                                pinhole,
                                scene.lens.lens.focus_m,
                                aperture_radius_m(scene.lens.lens, scene.lens.coc_scale),
                                {.samples = samples, .jitter = true, .aperture = {5}},
                                profile,
                                {}};
      SampleSums joined = make_sample_sums(width, height);
      for (const int number : {2, 1, 3}) {
        add(joined, accumulation_sums(input, samples_of({number, 3}, samples), pool));
      }
      CHECK(equal(mean_picture(joined, pinhole, profile, pool), accumulation(input, pool).picture));
    }
  }
}
