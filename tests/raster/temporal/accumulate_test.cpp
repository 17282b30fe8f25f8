#include "raster/temporal/accumulate.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/raster_helpers.h"
#include "tests/support/temporal_pictures.h"

using namespace softfocus;
using test::profile_named;

namespace {

constexpr HistoryBox kBoxes[] = {HistoryBox::none, HistoryBox::extent, HistoryBox::variance};

struct Averaged {
  Image picture, frames;
};

Averaged averaged(const AccumulateSettings& settings, const Image& now, const Image& old) {
  ThreadPool pool{2};
  Averaged result{make_image(Format::rgba16f, now.width, now.height),
                  make_image(Format::r32f, now.width, now.height)};
  accumulate(settings, now, old, result.picture, result.frames, {}, pool);
  return result;
}

Image plain(float red, float green, float blue, float alpha) {
  Image image = make_image(Format::rgba16f, 12, 9);
  clear_image(image, {red, green, blue, alpha}, {});
  return image;
}

}  // namespace

TEST_CASE("a running average is a new + (1 - a) old, to half a step of the halves") {
  const Image now = test::random_patches(31, 22, 1);
  const Image old = test::with_counts(test::random_patches(31, 22, 2), 3);
  const Averaged result = averaged({0.2f, HistoryBox::none}, now, old);
  double worst = 0.0;
  for (int y = 0; y < 22; ++y) {
    for (int x = 0; x < 31; ++x) {
      const glm::dvec4 fresh{load_texel(now, x, y)}, before{load_texel(old, x, y)};
      const double share = before.w > 0.0 ? std::max(1.0 / (before.w + 1.0), 0.2) : 1.0;
      for (int c = 0; c < 3; ++c) {
        worst =
            std::max(worst, std::fabs(share * fresh[c] + (1.0 - share) * before[c] -
                                      static_cast<double>(load_texel(result.picture, x, y)[c])));
      }
      CHECK(load_texel(result.picture, x, y).w == load_texel(now, x, y).w);
      CHECK(static_cast<double>(load_texel(result.frames, x, y).x) == before.w + 1.0);
    }
  }
  CHECK(worst < 0x1p-12 + 1e-6);
}

TEST_CASE("a constant stays constant, to the bit, whatever the box") {
  for (const HistoryBox box : kBoxes) {
    for (const float light : {0.0f, 0.1f, 0.7f, 3.0f, 60000.0f}) {
      const Image now = plain(light, light * 0.5f, light * 0.3f, 4.0f);
      Image old = now;
      for (int frame = 1; frame < 40; ++frame) {
        for (int y = 0; y < old.height; ++y) {
          for (int x = 0; x < old.width; ++x) {
            glm::vec4 texel = load_texel(old, x, y);
            texel.w = static_cast<float>(frame);
            store_texel(old, x, y, texel, {});
          }
        }
        old = averaged({0.05f, box}, now, old).picture;
        REQUIRE(equal(old, now));
      }
    }
  }
}

TEST_CASE("without history, and with one that is not finite, the frame is shown as it is") {
  const Image now = test::random_patches(12, 9, 4);
  CHECK(equal(averaged({}, now, plain(1.0f, 1.0f, 1.0f, 0.0f)).picture, now));
  CHECK(equal(averaged({}, now, plain(1.0f, INFINITY, 1.0f, 3.0f)).picture, now));
  CHECK(equal(averaged({}, now, plain(NAN, 1.0f, 1.0f, 3.0f)).picture, now));
}

TEST_CASE("a box takes away what no neighbour shows now, and no box leaves a trail") {
  const Image now = plain(0.25f, 0.25f, 0.25f, 2.0f), old = plain(1.0f, 0.0f, 0.0f, 50.0f);
  CHECK(equal(averaged({0.1f, HistoryBox::extent}, now, old).picture, now));
  CHECK(equal(averaged({0.1f, HistoryBox::variance}, now, old).picture, now));
  CHECK(load_texel(averaged({0.1f, HistoryBox::none}, now, old).picture, 5, 5).x > 0.9f);
}

TEST_CASE("a box keeps what lies between the neighbours") {
  Image now = make_image(Format::rgba16f, 9, 9);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 9; ++x) {
      const float grey = (x + y) % 2 == 0 ? 0.0f : 1.0f;
      store_texel(now, x, y, {grey, grey, grey, 1.0f}, {});
    }
  }
  Image old = now;
  clear_image(old, {0.5f, 0.5f, 0.5f, 1.0f}, {});
  const Image kept = averaged({0.5f, HistoryBox::none}, now, old).picture;
  for (const HistoryBox box : kBoxes) CHECK(equal(averaged({0.5f, box}, now, old).picture, kept));
}

TEST_CASE("a step of light is nine tenths gone after 22 frames, and sooner with a box") {
  // Nothing moves, and the light halves.
  const Image before = test::random_patches(32, 32, 9);
  Image after = before;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const glm::vec4 texel = load_texel(before, x, y);
      store_texel(after, x, y, {0.5f * texel.x, 0.5f * texel.y, 0.5f * texel.z, texel.w}, {});
    }
  }
  const auto next = [&](HistoryBox box, Image average) {
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        glm::vec4 texel = load_texel(average, x, y);
        texel.w = 100.0f;
        store_texel(average, x, y, texel, {});
      }
    }
    return averaged({0.1f, box}, after, average).picture;
  };
  const auto distance = [&](const Image& a, const Image& b) {
    double sum = 0.0;
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        const glm::vec4 off = load_texel(a, x, y) - load_texel(b, x, y);
        sum += static_cast<double>(off.x * off.x + off.y * off.y + off.z * off.z);
      }
    }
    return std::sqrt(sum);
  };
  const auto frames_until_gone = [&](HistoryBox box) {
    // A box cuts outliers, so the average need not come to the frame itself.
    Image last = after;
    for (int i = 0; i < 100; ++i) last = next(box, std::move(last));
    Image average = before;
    int frames = 0;
    while (distance(average, last) > 0.1 * distance(before, last) && frames < 100) {
      average = next(box, std::move(average));
      ++frames;
    }
    return frames;
  };
  CHECK(frames_until_gone(HistoryBox::none) == 22);
  CHECK(frames_until_gone(HistoryBox::extent) == 15);
  CHECK(frames_until_gone(HistoryBox::variance) == 10);
}

TEST_CASE("a running average has the same bits in all vectors, also of what is not finite") {
  for (const char* profile : {"ieee", "d3d11", "swiftshader"}) {
    for (const Isa isa : available_isas()) {
      for (const int width : {1, 3, 16, 19, 70}) {
        for (const int height : {1, 33}) {
          Image now = test::random_patches(width, height, 6);
          Image old = test::with_counts(test::random_patches(width, height, 7), 8);
          for (Image* image : {&now, &old}) test::spoil(*image);
          ThreadPool pool{2, isa}, of_four{1, Isa::scalar};
          Image expected = make_image(Format::rgba16f, width, height), result = expected;
          Image expected_frames = make_image(Format::r32f, width, height), frames = expected_frames;
          for (const HistoryBox box : kBoxes) {
            const AccumulateSettings settings{0.1f, box, 0.75f};
            const Profile by = profile_named(profile);
            accumulate(settings, now, old, expected, expected_frames, by, of_four);
            accumulate(settings, now, old, result, frames, by, pool);
            REQUIRE(equal(result, expected));
            REQUIRE(equal(frames, expected_frames));
          }
        }
      }
    }
  }
}
