#include "dof/measure/difference.h"

#include <doctest/doctest.h>

#include <cmath>

#include "dof/show.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

TEST_CASE("a picture does not differ from itself") {
  const Image a = random_scene_image(31, 17, 1);
  const Difference d = compare_images(a, a);
  CHECK(d.values == 31u * 17u * 4u);
  CHECK(d.differing == 0);
  CHECK(d.max_ulp == 0);
  CHECK(d.ulp_histogram[0] == d.values);
  CHECK(std::isinf(d.psnr_db));
  CHECK(d.first_x == -1);
}

TEST_CASE("each differing value is counted, placed and sorted by its distance") {
  const Image a = random_scene_image(31, 17, 1);
  Image b = a;
  row<std::uint16_t>(b, 3)[4 * 5 + 1] ^= 1;  // 1 half-ULP
  row<std::uint16_t>(b, 9)[4 * 2 + 3] += 6;  // alpha counts too
  const Difference d = compare_images(a, b);
  CHECK(d.differing == 2);
  CHECK(d.max_ulp == 6);
  CHECK(d.ulp_histogram[1] == 1);  // 1
  CHECK(d.ulp_histogram[3] == 1);  // 4 to 7
  CHECK(d.first_x == 5);
  CHECK(d.first_y == 3);
  CHECK(d.first_channel == 1);
}

TEST_CASE("PSNR has its textbook value") {
  Image a = make_image(Format::rgba16f, 4, 4);
  Image b = make_image(Format::rgba16f, 4, 4);
  clear_image(a, {0.5f, 0.5f, 0.5f, 1.0f}, {});
  clear_image(b, {0.25f, 0.25f, 0.25f, 1.0f}, {});
  // Every error is 1/4: -10 log10(1/16).
  CHECK(compare_images(a, b).psnr_db == doctest::Approx(12.041199826559248));
}

TEST_CASE("the difference picture is black exactly where the pictures agree") {
  const Image a = random_scene_image(12, 9, 2);
  Image b = a;
  row<std::uint16_t>(b, 4)[4 * 7] += 1;
  const Image picture = difference_picture(a, b);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 12; ++x) {
      const glm::vec4 t = load_texel(picture, x, y);
      CHECK((t.x + t.y + t.z > 0.0f) == (x == 7 && y == 4));
    }
  }
}

TEST_CASE("the grey map is black in focus and white at the largest circle") {
  Image scene = make_image(Format::rgba16f, 3, 1);
  store_texel(scene, 0, 0, {1, 1, 1, 2.0f}, {});   // in focus
  store_texel(scene, 1, 0, {1, 1, 1, 4.0f}, {});   // half of the circle at infinity
  store_texel(scene, 2, 0, {1, 1, 1, 0.25f}, {});  // far past the largest
  ThreadPool pool{2};
  const Image map = show_coc(scene, {8.0f, 2.0f}, 16.0f, pool);
  CHECK(load_texel(map, 0, 0).x == 0.0f);
  CHECK(load_texel(map, 1, 0).x == 0.25f);
  CHECK(load_texel(map, 2, 0).x == 1.0f);
  CHECK(load_texel(map, 1, 0).w == 4.0f);
}

TEST_CASE("the depth view runs from black at near to white at far") {
  Image scene = make_image(Format::rgba16f, 3, 1);
  store_texel(scene, 0, 0, {0, 0, 0, 0.5f}, {});
  store_texel(scene, 1, 0, {0, 0, 0, 2.0f / 3.0f}, {});  // 1/z half-way between 2 and 1
  store_texel(scene, 2, 0, {0, 0, 0, 1.0f}, {});
  ThreadPool pool{2};
  const Image view = show_depth(scene, 0.5f, 1.0f, pool);
  CHECK(load_texel(view, 0, 0).x == 0.0f);
  CHECK(load_texel(view, 1, 0).x == doctest::Approx(0.5f).epsilon(0.001));
  CHECK(load_texel(view, 2, 0).x == 1.0f);
}
