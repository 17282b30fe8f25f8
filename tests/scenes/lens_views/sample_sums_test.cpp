#include "scenes/lens_views/sample_sums.h"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

const Profile kIeee{};

Image picture_of(int width, int height, glm::vec4 value) {
  Image picture = make_image(Format::rgba16f, width, height);
  clear_image(picture, value, kIeee);
  return picture;
}

/// Any halves at all: infinities, NaN, subnormals and both zeros among them.
Image random_picture(int width, int height, test::Random& random) {
  Image picture = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (std::uint16_t& half : row<std::uint16_t>(picture, y)) {
      half = static_cast<std::uint16_t>(random.next());
    }
  }
  return picture;
}

bool same_bits(const SampleSums& a, const SampleSums& b) {
  for (std::size_t i = 0; i < a.totals.size(); ++i) {
    const double x = a.totals[i], y = b.totals[i];
    if (std::isnan(x) && std::isnan(y)) continue;  // whose signs differ between processors
    if (std::bit_cast<std::uint64_t>(x) != std::bit_cast<std::uint64_t>(y)) return false;
  }
  return a.totals.size() == b.totals.size();
}

}  // namespace

TEST_CASE("sums are the same on every vector unit and any number of threads" *
          doctest::test_suite("threads")) {
  test::Random random;
  for (const int width : {1, 3, 16, 17, 50}) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{3}, std::size_t{8}}) {
      std::vector<Image> pictures;
      for (std::size_t i = 0; i < count; ++i) pictures.push_back(random_picture(width, 5, random));
      SampleSums plain = make_sample_sums(width, 5);
      ThreadPool one{1, Isa::scalar};
      add_pictures(pictures, plain, one);
      add_pictures(pictures, plain, one);
      for (const Isa isa : available_isas()) {
        for (const int threads : {1, 3}) {
          ThreadPool pool{threads, isa};
          SampleSums sums = make_sample_sums(width, 5);
          add_pictures(pictures, sums, pool);
          add_pictures(pictures, sums, pool);
          CHECK(same_bits(sums, plain));
          CHECK(sums.count == static_cast<int>(2 * count));
        }
      }
    }
  }
}

TEST_CASE("means are the same on every vector unit, rounded either way") {
  test::Random random{23};
  ThreadPool plain{1, Isa::scalar};
  for (const int width : {1, 5, 64, 67, 150}) {
    SampleSums sums = make_sample_sums(width, 3);
    for (double& total : sums.totals)
      total = random.between(-40.0, 40.0) * random.between(0.0, 1.0);
    sums.count = 7;
    const Image depth = picture_of(width, 3, {1.0f, 2.0f, 3.0f, 4.0f});
    for (const char* name : {"ieee", "llvmpipe"}) {
      const Profile profile = test::profile_named(name);
      const Image expected = mean_picture(sums, depth, profile, plain);
      for (const Isa isa : available_isas()) {
        ThreadPool pool{2, isa};
        CHECK(equal(mean_picture(sums, depth, profile, pool), expected));
      }
    }
  }
}

TEST_CASE("the mean of one picture is that picture, -0 and infinities included") {
  test::Random random;
  ThreadPool pool{2};
  std::vector<Image> pictures{random_picture(40, 20, random)};
  for (int y = 0; y < 20; ++y) {
    for (std::uint16_t& half : row<std::uint16_t>(pictures[0], y)) {
      if ((half & 0x7FFF) > kHalfInfinity) half = kHalfNan;  // all that a picture holds of NaN
    }
  }
  SampleSums sums = make_sample_sums(40, 20);
  add_pictures(pictures, sums, pool);
  CHECK(equal(mean_picture(sums, pictures[0], kIeee, pool), pictures[0]));
}

TEST_CASE("the mean of 65,536 equal pictures is that picture") {
  ThreadPool pool{1};
  const glm::vec4 value{0.30004883f, 0.33325195f, 60000.0f, 2.0f};
  const std::vector<Image> pictures(kSampleGroup, picture_of(5, 1, value));
  SampleSums sums = make_sample_sums(5, 1);
  for (int i = 0; i < 65536 / kSampleGroup; ++i) add_pictures(pictures, sums, pool);
  CHECK(sums.count == 65536);
  CHECK(equal(mean_picture(sums, pictures[0], kIeee, pool), pictures[0]));
}

TEST_CASE("alpha is that of the depths, whatever the samples have there") {
  ThreadPool pool{1};
  const std::vector<Image> pictures{picture_of(4, 4, {0.5f, 0.5f, 0.5f, 1.0f})};
  SampleSums sums = make_sample_sums(4, 4);
  add_pictures(pictures, sums, pool);
  const Image mean = mean_picture(sums, picture_of(4, 4, glm::vec4{7.0f}), kIeee, pool);
  CHECK(load_texel(mean, 2, 3) == glm::vec4{0.5f, 0.5f, 0.5f, 7.0f});
}

TEST_CASE("half-sets differ by the root of the mean square of their means' difference") {
  ThreadPool pool{2};
  SampleSums sums = make_sample_sums(6, 2);
  const std::vector<Image> first(2, picture_of(6, 2, {0.5f, 0.25f, 0.0f, 1.0f}));
  const std::vector<Image> second(2, picture_of(6, 2, {1.5f, 0.25f, 2.0f, 1.0f}));
  add_pictures(first, sums, pool);
  const SampleSums half = sums;
  add_pictures(second, sums, pool);
  CHECK(half_set_rms(half, sums, pool) == doctest::Approx(std::sqrt((1.0 + 0.0 + 4.0) / 3.0)));
}
