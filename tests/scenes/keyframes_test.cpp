#include "scenes/draw/frame_matrices.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/random.h"

using namespace softfocus;
using test::Random;

namespace {

using Keys = std::vector<Keyframe>;

Keys random_keys(Random& random) {
  Keys keys;
  double frame = 0.0;
  for (int i = 0; i < 6; ++i) {
    frame += 0.5 + random.between(0.0, 20.0);
    keys.push_back({frame, 0.5 + random.between(0.0, 10.0)});
  }
  return keys;
}

}  // namespace

TEST_CASE("a key's own value comes back exactly, and stands before the first and after the last") {
  Random random{1};
  for (const Easing easing : {Easing::linear, Easing::smooth}) {
    const Keys keys = random_keys(random);
    for (const Keyframe& key : keys) CHECK(value_at(keys, easing, key.frame) == key.value);
    CHECK(value_at(keys, easing, 0.0) == keys.front().value);
    CHECK(value_at(keys, easing, 1e9) == keys.back().value);
    CHECK(value_at(Keys{{5.0, 2.0}}, easing, 7.0) == 2.0);
  }
}

TEST_CASE("linear: the way is in proportion to the frames") {
  const Keys keys{{1.0, 2.0}, {5.0, 4.0}, {9.0, 0.0}};
  CHECK(value_at(keys, Easing::linear, 2.0) == 2.5);
  CHECK(value_at(keys, Easing::linear, 4.5) == 3.75);
  CHECK(value_at(keys, Easing::linear, 7.0) == 2.0);
}

TEST_CASE("smooth: two keys are joined by the cubic that begins and ends at rest") {
  const Keys keys{{10.0, 2.0}, {20.0, 6.0}};
  for (int i = 0; i <= 10; ++i) {
    const double t = i / 10.0;
    CHECK(value_at(keys, Easing::smooth, 10.0 + i) ==
          doctest::Approx(2.0 + 4.0 * (3.0 * t * t - 2.0 * t * t * t)).epsilon(1e-14));
  }
}

TEST_CASE("smooth: keys on a line with rest at its ends run at the line's speed between") {
  const Keys keys{{0.0, 0.0}, {1.0, 1.0}, {2.0, 2.0}, {3.0, 3.0}};
  for (const double frame : {1.0, 1.25, 1.5, 1.9, 2.0}) {
    CHECK(value_at(keys, Easing::smooth, frame) == doctest::Approx(frame).epsilon(1e-14));
  }
}

TEST_CASE("smooth: the way from key to key never turns, and its speed does not jump") {
  Random random{2};
  for (int time = 0; time < 100; ++time) {
    const Keys keys = random_keys(random);
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
      const double sign = keys[i + 1].value > keys[i].value ? 1.0 : -1.0;
      double before = keys[i].value;
      for (int step = 1; step <= 50; ++step) {
        const double frame = keys[i].frame + (keys[i + 1].frame - keys[i].frame) * step / 50.0;
        const double value = value_at(keys, Easing::smooth, frame);
        CHECK(sign * (value - before) >= -1e-12);
        before = value;
      }
    }
    for (const Keyframe& key : keys) {
      const double e = 1e-5;
      const double left = key.value - value_at(keys, Easing::smooth, key.frame - e);
      const double right = value_at(keys, Easing::smooth, key.frame + e) - key.value;
      CHECK(std::abs(left - right) / e < 1e-2);
    }
  }
}

TEST_CASE("smooth: time run backwards is the way run backwards") {
  Random random{3};
  const Keys keys = random_keys(random);
  Keys mirrored;
  for (auto key = keys.rbegin(); key != keys.rend(); ++key) {
    mirrored.push_back({200.0 - key->frame, key->value});
  }
  for (int i = 0; i < 190; ++i) {
    const double frame = 0.7 * i;
    CHECK(value_at(keys, Easing::smooth, frame) ==
          doctest::Approx(value_at(mirrored, Easing::smooth, 200.0 - frame)).epsilon(1e-12));
  }
}

TEST_CASE("smooth: the same bits on every machine") {
  const Keys keys{{1.0, 2.0}, {20.0, 3.5}, {48.0, 6.0}};
  CHECK(value_at(keys, Easing::smooth, 7.0) == 0x1.1f7f1d5ee0fd3p+1);
  CHECK(value_at(keys, Easing::smooth, 31.0) == 0x1.2c574b9b3ba3ep+2);
}

TEST_CASE("the lens at a frame has the values of its keys") {
  SceneLens lens;
  lens.lens.focal_length_mm = 85.0;
  lens.keys[&ThinLens::focus_m] = {{0.0, 2.0}, {10.0, 4.0}};
  CHECK(lens_at(lens, 5.0).focus_m == 3.0);
  CHECK(lens_at(lens, 5.0).f_number == lens.lens.f_number);
  CHECK(lens_at(lens, 5.0).focal_length_mm == 85.0);
  lens.keys[&ThinLens::f_number] = {{5.0, 8.0}};
  CHECK(lens_at(lens, 0.0).f_number == 8.0);
}
