#include "scenes/lens_views/samples_by_tile.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <utility>

#include "scenes/lens_views/lens_points.h"
#include "scenes/lens_views/sample_sums.h"
#include "scenes/load/load_scene.h"
#include "tests/support/lens_view_scenes.h"

using namespace softfocus;
using test::Drawn;
using test::sample_scene;
using test::square_scene;

namespace {

Scene built_in(const char* name) { return load_scene(name, scene_search_path({})); }

// All tiles with the first `samples` of `most` views.
Image with_as_many(const Scene& scene, const Sampling& sampling, int samples, const Image& pinhole,
                   ThreadPool& pool) {
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, pinhole.width, pinhole.height);
  const LensViewInput input{scene,
                            camera,
                            0.0,
                            pinhole,
                            scene.lens.lens.focus_m,
                            aperture_radius_m(scene.lens.lens, 1.0),
                            sampling,
                            {},
                            {}};
  AccumulationBuffer buffer = make_accumulation_buffer(input, pool);
  place_growing_views(buffer, sampling);
  SampleSums sums = make_sample_sums(pinhole.width, pinhole.height);
  while (sums.count < samples) {
    add_lens_views(buffer, input, sums.count, std::min(sums.count + kSampleGroup, samples), sums,
                   pool);
  }
  return mean_picture(sums, pinhole, {}, pool);
}

bool same_tile(const Image& a, const Image& b, int left, int top) {
  for (int y = top; y < std::min(top + kSumTile, a.height); ++y) {
    for (int x = left; x < std::min(left + kSumTile, a.width); ++x) {
      if (load_texel(a, x, y) != load_texel(b, x, y)) return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("samples by tile: sizes grow eightfold, and the last is the most") {
  using Sizes = std::vector<int>;
  CHECK(tile_sample_sizes(1) == Sizes{1});
  CHECK(tile_sample_sizes(8) == Sizes{8});
  CHECK(tile_sample_sizes(9) == Sizes{8, 9});
  CHECK(tile_sample_sizes(64) == Sizes{8, 64});
  CHECK(tile_sample_sizes(255) == Sizes{8, 255});
  CHECK(tile_sample_sizes(256) == Sizes{8, 64, 256});
  CHECK(tile_sample_sizes(65536) == Sizes{8, 64, 512, 4096, 65536});
}

TEST_CASE("samples by tile: the more the first views differ, the more a tile takes") {
  const std::vector<int> sizes{8, 64, 256};
  const auto samples = [&](double difference) {
    const double steps = difference * kBrightnessSteps;
    return tile_samples(static_cast<std::uint64_t>(steps * steps * 3.0 * 100.0), 100, sizes);
  };
  CHECK(samples(0.0) == 8);
  CHECK(samples(0.0149) == 8);
  CHECK(samples(0.0151) == 64);
  CHECK(samples(0.071) == 64);
  CHECK(samples(0.072) == 256);
  CHECK(samples(1.0) == 256);
}

TEST_CASE("samples by tile: a flat scene in focus takes the first views in every tile") {
  ThreadPool pool{2};
  const Scene scene = square_scene(test::kTestLens.focus_m, 9.0);
  const Drawn drawn =
      sample_scene(scene, "accumulation", {.samples = 64, .by_tile = true}, 150, 100, pool);
  CHECK(drawn.sampled.samples == kFirstTileViews);
  CHECK(drawn.sampled.mean_samples.value() == kFirstTileViews);
  CHECK(equal(drawn.sampled.picture, drawn.pinhole));
}

TEST_CASE("samples by tile: a silhouette out of focus takes many, the tiles beside it few") {
  ThreadPool pool{2};
  // A square of about 40 pixels in the middle one of five by five tiles.
  const Scene scene = square_scene(8.0, 0.7);
  const int size = 5 * kSumTile;
  const Drawn drawn =
      sample_scene(scene, "accumulation", {.samples = 64, .by_tile = true}, size, size, pool,
                   {.focal_length_mm = 50, .f_number = 4.0, .focus_m = 2.0});
  CHECK(drawn.sampled.samples == 64);
  CHECK(drawn.sampled.mean_samples.value() == doctest::Approx((24.0 * 8 + 64) / 25));
}

TEST_CASE("samples by tile: each tile is that of a picture with as many samples everywhere") {
  ThreadPool pool{2};
  const Scene scene = built_in("random:104");
  const int width = 400, height = 400;  // parts of tiles
  for (const bool jitter : {false, true}) {
    const Sampling sampling{.samples = 40, .jitter = jitter, .aperture = {7}, .by_tile = true};
    const Drawn drawn =
        sample_scene(scene, "accumulation", sampling, width, height, pool, scene.lens.lens);
    const Image few = with_as_many(scene, sampling, 8, drawn.pinhole, pool);
    const Image many = with_as_many(scene, sampling, 40, drawn.pinhole, pool);
    for (int top = 0; top < height; top += kSumTile) {
      for (int left = 0; left < width; left += kSumTile) {
        CHECK((same_tile(drawn.sampled.picture, few, left, top) ||
               same_tile(drawn.sampled.picture, many, left, top)));
      }
    }
    CHECK(drawn.sampled.mean_samples.value() > 8.0);
    CHECK(drawn.sampled.mean_samples.value() < 40.0);
    CHECK(!equal(drawn.sampled.picture, many));
  }
}

TEST_CASE("samples by tile: the same bits for any number of threads and on every vector unit" *
          doctest::test_suite("threads long")) {
  const Scene scene = built_in("figures");
  const Sampling sampling{.samples = 24, .jitter = true, .by_tile = true};
  ThreadPool one{1, Isa::scalar};
  for (const char* method : {"accumulation", "filtered-views"}) {
    const auto picture = [&](ThreadPool& pool) {
      return sample_scene(scene, method, sampling, 150, 100, pool, scene.lens.lens).sampled;
    };
    const SampledPicture expected = picture(one);
    for (const Isa isa : available_isas()) {
      ThreadPool pool{3, isa};
      const SampledPicture found = picture(pool);
      CHECK(equal(found.picture, expected.picture));
      CHECK(found.mean_samples == expected.mean_samples);
    }
  }
}

TEST_CASE("samples by tile: of filtered views each tile is that of so many filtered views") {
  ThreadPool pool{2};
  const Scene scene = built_in("figures");
  const int width = 330, height = 200;
  for (const int most : {20, 40}) {  // of 40 none is spread
    const auto picture = [&](const Sampling& sampling) {
      return sample_scene(scene, "filtered-views", sampling, width, height, pool, scene.lens.lens)
          .sampled;
    };
    const SampledPicture found = picture({.samples = most, .by_tile = true});
    const Image few = picture({.samples = 8}).picture;
    const Image many = picture({.samples = most}).picture;
    CHECK(found.samples == most);
    CHECK(found.mean_samples.value() > 8.0);
    CHECK(found.mean_samples.value() < most);
    for (int top = 0; top < height; top += kSumTile) {
      for (int left = 0; left < width; left += kSumTile) {
        CHECK((same_tile(found.picture, few, left, top) ||
               same_tile(found.picture, many, left, top)));
      }
    }
  }
}

TEST_CASE("samples by tile: as few as the first views are those of the usual picture") {
  ThreadPool pool{2};
  const Scene scene = built_in("cube-room");
  for (const char* method : {"accumulation", "filtered-views"}) {
    const auto picture = [&](const Sampling& sampling) {
      return sample_scene(scene, method, sampling, 70, 50, pool, scene.lens.lens).sampled.picture;
    };
    CHECK(equal(picture({.samples = 6, .by_tile = true}), picture({.samples = 6})));
  }
}

TEST_CASE("growing lens points: each size's first points are a set about the centre") {
  const std::vector<int> sizes{8, 64, 256};
  const auto points = growing_lens_points({}, sizes);
  REQUIRE(points.size() == 256);
  for (const int size : sizes) {
    glm::dvec2 sum{0.0};
    double squares = 0.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
      sum += points[i];
      squares += points[i].x * points[i].x + points[i].y * points[i].y;
    }
    CHECK(sum == glm::dvec2{0.0});
    CHECK(squares / size == doctest::Approx(0.5).epsilon(0.05));
  }
  CHECK(growing_lens_points({5}, std::vector<int>{17}) == few_lens_points({5}, 17));
}
