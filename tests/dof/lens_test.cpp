#include "dof/lens.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "raster/numbers/exact_math.h"

using namespace softfocus;

namespace {

const ThinLens kPortrait{.focal_length_mm = 50.0, .f_number = 2.0, .focus_m = 1.0};

doctest::Approx near(double value) { return doctest::Approx(value).epsilon(1e-9); }

}  // namespace

TEST_CASE("the aperture is the focal length divided by the f-number (eq. 3)") {
  CHECK(aperture_mm(kPortrait) == 25.0);
}

TEST_CASE("the lens law gives the image distance (eq. 1)") {
  // 50 mm focused at 1 m: 50 * 1000 / 950.
  CHECK(image_distance_mm(kPortrait, 1.0) == near(52.631578947368421));
  CHECK(1.0 / 50.0 == near(1.0 / 1000.0 + 1.0 / image_distance_mm(kPortrait, 1.0)));
  CHECK(image_distance_mm(kPortrait, 0.1) == near(100.0));  // at 2 f, life size
  CHECK(image_distance_mm(kPortrait, 0.04) < 0.0);          // nearer than f: virtual
}

TEST_CASE("the circle on film is that of the worked example (eq. 2)") {
  // A = 25, f = 50, z_f = 1000, z = 2000: 25 * 50 * 1000 / (2000 * 950).
  CHECK(coc_on_film_mm(kPortrait, 2.0) == near(0.65789473684210526));
  CHECK(coc_on_film_mm(kPortrait, 1.0) == 0.0);
}

TEST_CASE("both forms of eq. 2 agree at every distance") {
  const double v0 = image_distance_mm(kPortrait, kPortrait.focus_m);
  for (double z = 0.2; z < 50.0; z *= 1.1) {
    const double v = image_distance_mm(kPortrait, z);
    CHECK(coc_on_film_mm(kPortrait, z) == near(aperture_mm(kPortrait) * std::fabs(v - v0) / v));
  }
}

TEST_CASE("focused at the hyperfocal distance, half of it to infinity is sharp (eq. 4)") {
  ThinLens lens = kPortrait;
  lens.focus_m = hyperfocal_m(lens, 0.03);
  CHECK(lens.focus_m == near(50.0 * 50.0 / (2.0 * 0.03) / 1000.0 + 0.05));
  CHECK(coc_on_film_mm(lens, 1e12) == doctest::Approx(0.03).epsilon(1e-6));
  CHECK(sharp_range(lens, 0.03).near_m == near(lens.focus_m / 2.0));
  // An ulp nearer than hyperfocal is enough for a finite, huge limit.
  CHECK(sharp_range(lens, 0.03).far_m > 1e12);
}

TEST_CASE("focused at H/n the sharp range is H/(n+1) to H/(n-1) (eq. 5 and 6)") {
  // The equations leave out the + f of H; a short lens makes that small.
  const double circle_mm = 0.01;
  ThinLens lens{.focal_length_mm = 1.0, .f_number = 1.0, .focus_m = 1.0};
  const double h = hyperfocal_m(lens, circle_mm);
  for (double n = 1.5; n < 10.0; n += 0.5) {
    lens.focus_m = h / n;
    const SharpRange range = sharp_range(lens, circle_mm);
    const double relative_f = 0.001 * n / h;
    CHECK(range.near_m == doctest::Approx(h / (n + 1.0)).epsilon(relative_f));
    CHECK(range.far_m == doctest::Approx(h / (n - 1.0)).epsilon(2.0 * n * relative_f));
  }
}

TEST_CASE("at the limits of the sharp range the circle has the largest allowed size") {
  const SharpRange range = sharp_range(kPortrait, 0.1);
  CHECK(coc_on_film_mm(kPortrait, range.near_m) == near(0.1));
  CHECK(coc_on_film_mm(kPortrait, range.far_m) == near(0.1));
  CHECK(range.near_m < kPortrait.focus_m);
  CHECK(range.far_m > kPortrait.focus_m);
}

TEST_CASE("the radius in pixels is negative before the focus, zero on it and positive behind") {
  const PixelCoc coc = pixel_coc(kPortrait, 40.0, 1024, 1.0);
  CHECK(coc_radius_px(coc, 0.5f) < 0.0f);
  CHECK(coc_radius_px(coc, 1.0f) == 0.0f);
  CHECK(coc_radius_px(coc, 2.0f) > 0.0f);
  CHECK(coc_radius_px(coc, 0.0f) == -std::numeric_limits<float>::infinity());
}

TEST_CASE("the radius in pixels is the footprint of rays through the aperture on a pinhole image") {
  // Brute force: a ray from an object on the axis through the aperture's rim. The lens sends
  // it to where a pinhole images the point at which the ray's line meets the focus plane.
  const double fov = 40.0;
  const int height = 1024;
  const double pixels_per_tangent = height / (2.0 * exact_math::tan_degrees(fov / 2.0));
  const PixelCoc coc = pixel_coc(kPortrait, fov, height, 1.0);
  const double rim = aperture_mm(kPortrait) / 2000.0;
  for (double z = 0.3; z < 40.0; z *= 1.3) {
    // The straight line in object space from (0, z) to (rim, 0) at depth z_f.
    const double on_focus_plane = rim * (z - kPortrait.focus_m) / z;
    const double pixels = on_focus_plane / kPortrait.focus_m * pixels_per_tangent;
    CHECK(coc_radius_px(coc, static_cast<float>(z)) == doctest::Approx(pixels).epsilon(1e-5));
  }
}

TEST_CASE("the film's circle, scaled to pixels, is the radius in pixels: the conventions agree") {
  const double fov = 55.0;
  const int height = 720;
  const PixelCoc coc = pixel_coc(kPortrait, fov, height, 1.0);
  const double pixels_per_mm = height / film_height_mm(kPortrait, fov);
  for (double z = 0.3; z < 40.0; z *= 1.3) {
    const double from_film = coc_on_film_mm(kPortrait, z) / 2.0 * pixels_per_mm;
    CHECK(std::fabs(coc_radius_px(coc, static_cast<float>(z))) ==
          doctest::Approx(from_film).epsilon(1e-5));
  }
}

TEST_CASE("with the film at the focal length the two conventions would differ by 5.3 percent") {
  // See docs/lens.md: f = 50 mm and z_f = 1 m.
  const double at_focal_length = 2.0 * 50.0 * exact_math::tan_degrees(20.0);
  CHECK(film_height_mm(kPortrait, 40.0) / at_focal_length == doctest::Approx(1.0526).epsilon(1e-4));
}

TEST_CASE("the CoC scale multiplies the radius") {
  const float once = coc_radius_px(pixel_coc(kPortrait, 40.0, 1024, 1.0), 3.0f);
  CHECK(coc_radius_px(pixel_coc(kPortrait, 40.0, 1024, 2.5), 3.0f) ==
        doctest::Approx(2.5f * once).epsilon(1e-6));
}

TEST_CASE("the radius grows with the picture, so a scene looks the same at every size") {
  const float small = coc_radius_px(pixel_coc(kPortrait, 40.0, 256, 1.0), 3.0f);
  CHECK(coc_radius_px(pixel_coc(kPortrait, 40.0, 1024, 1.0), 3.0f) == 4.0f * small);
}

TEST_CASE("an unusable lens is refused with the reason") {
  CHECK(lens_error(kPortrait) == nullptr);
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, inf, nan}) {
    CHECK(lens_error({bad, 2.0, 1.0}) != nullptr);
    CHECK(lens_error({50.0, bad, 1.0}) != nullptr);
    CHECK(lens_error({50.0, 2.0, bad}) != nullptr);
  }
  CHECK(lens_error({50.0, 2.0, 0.05}) != nullptr);  // focused at the focal length
  CHECK(lens_error({50.0, 2.0, 0.0501}) == nullptr);
}
