#include "dof/measure/flicker.h"

#include <doctest/doctest.h>

#include <vector>

#include "tests/support/measure_pictures.h"

using namespace softfocus;
using doctest::Approx;

namespace {

/// Stripes that move by one pixel a frame, over `offset`.
std::vector<Image> moving_stripes(double offset) {
  std::vector<Image> frames;
  frames.reserve(4);
  for (int t = 0; t < 4; ++t) {
    frames.push_back(
        grey_picture(12, 5, [=](int x, int) { return offset + ((x + t) % 4 < 2 ? 0.25 : 0.0); }));
  }
  return frames;
}

}  // namespace

TEST_CASE("flicker: none where the motion is the truth's") {
  const auto frames = moving_stripes(0.25);
  CHECK(flicker(frames, frames, clamped_tone()) == 0.0);
}

TEST_CASE("flicker: none for an error that stays") {
  // All the time a quarter too bright, and yet as steady as the truth.
  CHECK(flicker(moving_stripes(0.5), moving_stripes(0.25), clamped_tone()) == 0.0);
}

TEST_CASE("flicker: of a picture that blinks before a still truth, how much it blinks") {
  const std::vector<Image> still(4, plain_grey(6, 6, 0.5f));
  const std::vector<Image> blinking{plain_grey(6, 6, 0.5f), plain_grey(6, 6, 0.625f),
                                    plain_grey(6, 6, 0.5f), plain_grey(6, 6, 0.625f)};
  CHECK(flicker(blinking, still, clamped_tone()) == Approx(0.125).epsilon(1e-12));
  CHECK(flicker(still, blinking, clamped_tone()) == Approx(0.125).epsilon(1e-12));
}

TEST_CASE("flicker: what does not move when it should flickers as much") {
  const auto truth = moving_stripes(0.0);
  const std::vector<Image> still(4, truth.front());
  // Each frame, half of the stripes' pixels change by a quarter.
  CHECK(flicker(still, truth, clamped_tone()) == Approx(0.125).epsilon(1e-12));
}

TEST_CASE("flicker: the mean over steps, pixels and channels") {
  const std::vector<Image> truth(3, plain_grey(4, 4, 0.5f));
  std::vector<Image> frames = truth;
  store_texel(frames[2], 1, 1, {0.5f, 1.0f, 0.5f, 2.0f}, {});
  // 0.5 in one channel of one pixel of 16, in one step of two.
  CHECK(flicker(frames, truth, clamped_tone()) == Approx(0.5 / 3.0 / 16.0 / 2.0).epsilon(1e-12));
}

TEST_CASE("flicker: depth in alpha is not looked at") {
  const std::vector<Image> truth(2, plain_grey(4, 4, 0.5f));
  std::vector<Image> frames = truth;
  set_depth(frames[1], [](int, int) { return 0.25f; });
  CHECK(flicker(frames, truth, clamped_tone()) == 0.0);
}
