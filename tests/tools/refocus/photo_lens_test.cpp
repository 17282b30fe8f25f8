// The lens as photographers say it.

#include "tools/refocus/photo_lens.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "dof/parameters.h"
#include "tools/cli/errors.h"
#include "tools/options/parameter_options.h"

using namespace softfocus;

namespace {

double metres(const std::string& text) { return parse_parameter("--x", text, parameter::kFocus); }

/// 20 x 10 of depth 4, with a 6 x 6 square of depth 2 in it and one pixel of depth 1 in that.
DepthMap square_depths() {
  DepthMap map{20, 10, std::vector<float>(200, 4.0f)};
  for (std::size_t y = 2; y < 8; ++y) {
    for (std::size_t x = 2; x < 8; ++x) map.metres[20 * y + x] = 2.0f;
  }
  map.metres[20 * 5 + 5] = 1.0f;
  return map;
}

SettledLens settled(const PhotoLens& photo) { return settle_lens(photo, {}, {}, square_depths()); }

}  // namespace

TEST_CASE("lengths are read with their units") {
  CHECK(metres("2.5") == 2.5);
  CHECK(metres("2.5m") == 2.5);
  CHECK(metres("250cm") == 2.5);
  CHECK(metres("2500mm") == 2.5);
  CHECK(metres("10ft") == doctest::Approx(3.048));
  CHECK(metres("10in") == doctest::Approx(0.254));
  for (const char* text : {"50", "50mm", "5cm", "0.05m"}) {
    CHECK(parse_parameter("--x", text, parameter::kFocalLength) == 50.0);
  }
  for (const char* text : {"2.5km", "m", "", "2,5m", "-1m", "2.5 m", "infm", "1e10m"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(metres(text), UsageError);
  }
}

TEST_CASE("f-numbers are read as they are written") {
  for (const char* text : {"1.8", "f/1.8", "f1.8"}) {
    CHECK(parse_parameter("--x", text, parameter::kFNumber) == 1.8);
  }
  CHECK_THROWS_AS(parse_parameter("--x", "f/", parameter::kFNumber), UsageError);
  CHECK_THROWS_AS(parse_parameter("--x", "g/2", parameter::kFNumber), UsageError);
}

TEST_CASE("the circle on a full-frame sensor is the one on film, in pixels") {
  PhotoLens photo;
  photo.lens.given = {{1.5, 85.0, 1.4}};  // focus, focal length, f-number
  photo.sensor = Sensor{"full-frame", 36.0, 24.0};
  const DepthMap map{300, 200, std::vector<float>(60000, 3.0f)};
  const SettledLens lens = settle_lens(photo, {}, {}, map);
  const double on_film_px = coc_on_film_mm(lens.lens, 3.0) / 24.0 * 200.0;
  CHECK(static_cast<double>(coc_radius_px(lens.coc, 3.0f)) == doctest::Approx(on_film_px / 2.0));
}

TEST_CASE("a picture upright has the sensor upright, one of another shape the largest part of it") {
  PhotoLens photo;
  photo.lens.given[&ThinLens::focus_m] = 2.0;
  photo.sensor = Sensor{"full-frame", 36.0, 24.0};
  const auto at_infinity = [&](int width, int height) {
    const DepthMap map{width, height,
                       std::vector<float>(static_cast<std::size_t>(width * height), 3.0f)};
    return settle_lens(photo, {}, {}, map).coc.radius_at_infinity_px;
  };
  CHECK(at_infinity(200, 300) == at_infinity(300, 200));
  CHECK(at_infinity(300, 100) == at_infinity(300, 200));  // cut above and below
  CHECK(at_infinity(200, 200) == at_infinity(300, 200));  // cut left and right
}

TEST_CASE("--focal-px and --fov say the same field of view") {
  PhotoLens photo;
  photo.lens.given[&ThinLens::focus_m] = 2.0;
  const DepthMap map = square_depths();
  const SettledLens by_pixels = settle_lens(photo, {}, 5.0, map);  // half of the height: 90 degrees
  photo.fov_y_degrees = 90.0;
  const SettledLens by_degrees = settle_lens(photo, {}, {}, map);
  CHECK(by_pixels.coc.radius_at_infinity_px == by_degrees.coc.radius_at_infinity_px);
  CHECK(by_pixels.fov_y_degrees == doctest::Approx(90.0));
}

TEST_CASE("a field of view by degrees has the bits of pixel_coc()") {
  PhotoLens photo;
  photo.lens.given[&ThinLens::focus_m] = 1.1;
  photo.fov_y_degrees = 28.0;
  const SettledLens lens = settled(photo);
  CHECK(lens.coc.radius_at_infinity_px ==
        pixel_coc(lens.lens, 28.0, 10, 1.0).radius_at_infinity_px);
}

TEST_CASE("focus at a pixel is the median around it") {
  PhotoLens photo;
  photo.focus_at = Pixel{5, 5};
  CHECK(settled(photo).coc.focus_m == 2.0f);  // one pixel of another depth changes nothing
  photo.focus_at = Pixel{15, 5};
  CHECK(settled(photo).coc.focus_m == 4.0f);
  photo.focus_at = Pixel{20, 5};
  CHECK_THROWS_AS(settled(photo), UsageError);
}

TEST_CASE("focus on the nearest, and in the middle if nothing is said") {
  PhotoLens photo;
  CHECK(settled(photo).coc.focus_m == 4.0f);
  photo.focus_nearest = true;
  CHECK(settled(photo).coc.focus_m == 1.0f);
}

TEST_CASE("focus where nothing has a depth is refused") {
  PhotoLens photo;
  const DepthMap map{4, 4, std::vector<float>(16, std::numeric_limits<float>::infinity())};
  CHECK_THROWS_AS(settle_lens(photo, {}, {}, map), UsageError);
  photo.focus_nearest = true;
  CHECK_THROWS_AS(settle_lens(photo, {}, {}, map), UsageError);
}

TEST_CASE("the blur at infinity alone is a lens") {
  PhotoLens photo;
  photo.blur_at_infinity_px = 12.0;
  photo.lens.given[&ThinLens::focus_m] = 2.0;
  const SettledLens lens = settled(photo);
  CHECK_FALSE(lens.has_lens);
  CHECK(lens.coc.radius_at_infinity_px == 12.0f);
  CHECK(coc_radius_px(lens.coc, 4.0f) == 6.0f);
}

TEST_CASE(
    "a range in focus is sharp, and beyond it circles are those of a lens focused at its end") {
  const ThinLens near_lens{.focal_length_mm = 50, .f_number = 2, .focus_m = 1.0};
  const ThinLens far_lens{.focal_length_mm = 50, .f_number = 2, .focus_m = 3.0};
  const PixelCoc at_near = pixel_coc(near_lens, 40, 1000, 1),
                 at_far = pixel_coc(far_lens, 40, 1000, 1);
  DepthMap map{7, 1, {0.5f, 0.9f, 1.0f, 2.0f, 3.0f, 5.0f, std::numeric_limits<float>::infinity()}};
  const DepthMap before = map;
  move_range_into_focus(map, {1.0, 3.0});
  for (std::size_t i = 0; i < 7; ++i) {
    CAPTURE(i);
    const float z = before.metres[i];
    // As infinity over infinity is no number: a depth far beyond any.
    const auto radius = [](const PixelCoc& coc, float at) {
      return coc_radius_px(coc, std::fmin(at, 1e30f));
    };
    const float expected = z < 1.0f ? radius(at_near, z) : z > 3.0f ? radius(at_far, z) : 0.0f;
    CHECK(radius(at_near, map.metres[i]) == doctest::Approx(expected).epsilon(1e-5));
  }
}
