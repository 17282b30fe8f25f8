#include "raster/temporal/refresh.h"

#include <doctest/doctest.h>

#include <array>

#include "tests/support/raster_helpers.h"
#include "tests/support/temporal_pictures.h"

using namespace softfocus;

TEST_CASE("a frame draws about 1 of n pixels, whole quads, and n frames draw each pixel once") {
  ThreadPool pool{2};
  constexpr int kGroups = 8, kSide = 64;
  Image drawn = make_image(Format::rgba16f, kSide, kSide), found = drawn, result = drawn;
  clear_image(drawn, {1.0f, 0.0f, 0.0f, 2.0f}, {});
  clear_image(found, {0.0f, 1.0f, 0.0f, 5.0f}, {});
  Image frames = make_image(Format::r32f, kSide, kSide);
  std::array<int, std::size_t{kSide} * kSide> times{};
  int torn = 0;
  for (int turn = 0; turn < kGroups; ++turn) {
    const std::int64_t count = refresh(kGroups, turn, drawn, found, result, frames, {}, pool);
    CHECK(count > kSide * kSide / kGroups / 2);
    CHECK(count < kSide * kSide / kGroups * 2);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const glm::vec4 texel = load_texel(result, x, y);
        const bool is_anew = texel.x == 1.0f;
        CHECK(texel.w == 2.0f);
        if (is_anew) ++times[static_cast<std::size_t>(y * kSide + x)];
        if (is_anew != (load_texel(result, x / 2 * 2, y / 2 * 2).x == 1.0f)) ++torn;
        CHECK(load_texel(frames, x, y).x == (is_anew ? 1.0f : 6.0f));
      }
    }
  }
  CHECK(torn == 0);
  CHECK(std::all_of(times.begin(), times.end(), [](int n) { return n == 1; }));
}

TEST_CASE("what was not found is drawn, whatever its group") {
  ThreadPool pool{1};
  const Image drawn = test::random_patches(16, 16, 1);
  const Image found = make_image(Format::rgba16f, 16, 16);
  Image result = found, frames = make_image(Format::r32f, 16, 16);
  CHECK(refresh(8, 3, drawn, found, result, frames, {}, pool) == 256);
  CHECK(equal(result, drawn));
}

TEST_CASE("a refresh has the same bits in all vectors") {
  for (const char* profile : {"ieee", "d3d11"}) {
    for (const Isa isa : available_isas()) {
      for (const int width : {1, 16, 53}) {
        Image drawn = test::random_patches(width, 19, 3);
        Image found = test::with_counts(test::random_patches(width, 19, 4), 5);
        for (Image* image : {&drawn, &found}) test::spoil(*image);
        ThreadPool pool{2, isa}, of_four{1, Isa::scalar};
        Image expected = make_image(Format::rgba16f, width, 19), result = expected;
        Image expected_frames = make_image(Format::r32f, width, 19), frames = expected_frames;
        const Profile by = test::profile_named(profile);
        const auto count = refresh(5, 2, drawn, found, expected, expected_frames, by, of_four);
        CHECK(refresh(5, 2, drawn, found, result, frames, by, pool) == count);
        REQUIRE(equal(result, expected));
        REQUIRE(equal(frames, expected_frames));
      }
    }
  }
}
