#include <doctest/doctest.h>

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "dof/disc_layers/disc_layers.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// 16 (z - 2) / z: -16 at 1 m, 0 at 2 m, 8 at 4 m.
constexpr DofSettings kLayeredSettings{.coc = {16.0f, 2.0f}, .max_coc_px = 16.0f};
constexpr int kLayeredSize = 96;

Image layered_picture(const Image& scene, const std::vector<ConstImageView>& behind,
                      ThreadPool& pool) {
  DofInput input{scene, kLayeredSettings, {}};
  input.behind = behind;
  Image result = random_scene_image(scene.width, scene.height, 99);
  layered(input, result, pool);
  return result;
}

// Stripes in focus, a pixel in eight white.
glm::vec4 stripes(int x) { return glm::vec4{glm::vec3{x % 8 == 0 ? 1.0f : 0.0f}, 2.0f}; }

template <class TexelAt>
Image square_of(const TexelAt& texel_at) {
  Image image = make_image(Format::rgba16f, kLayeredSize, kLayeredSize);
  for (int y = 0; y < kLayeredSize; ++y) {
    for (int x = 0; x < kLayeredSize; ++x) store_texel(image, x, y, texel_at(x, y), {});
  }
  return image;
}

bool in_bar(int x) { return x >= 42 && x < 54; }

}  // namespace

TEST_CASE("layered: without layers behind it is disc-layers") {
  ThreadPool pool(2);
  const Image scene = random_scene_image(70, 45, 7);
  Image expected = make_image(Format::rgba16f, 70, 45);
  disc_layers({scene, kLayeredSettings, {}}, expected, pool);
  CHECK(equal(layered_picture(scene, {}, pool), expected));
}

TEST_CASE("layered: the same bits on every vector unit and for any number of threads") {
  struct Size {
    int width, height;
  };
  for (const Size size : {Size{1, 1}, {17, 15}, {70, 45}, {129, 31}}) {
    const Image scene = random_scene_image(size.width, size.height, 7);
    const Image second = random_scene_image(size.width, size.height, 8);
    const Image third = random_scene_image(size.width, size.height, 9);
    ThreadPool scalar(1, Isa::scalar);
    const Image expected = layered_picture(scene, {second, third}, scalar);
    for (const Isa isa : available_isas()) {
      ThreadPool pool(3, isa);
      INFO(std::string{isa_name(isa)}, ", ", size.width, "x", size.height);
      CHECK(equal(layered_picture(scene, {second, third}, pool), expected));
    }
  }
}

// A bar narrower than its circle hides a part of the lens everywhere; what is seen past it is
// what is there, line for line.
TEST_CASE("layered: a texture behind something near stays where it is") {
  ThreadPool pool(2);
  const auto bar = [](int x, int) { return in_bar(x) ? glm::vec4{0, 0, 0, 1} : stripes(x); };
  const Image scene = square_of(bar);
  const Image behind = square_of([](int x, int) { return stripes(x); });
  const Image picture = layered_picture(scene, {behind}, pool);
  for (const int x : {40, 48}) {
    CHECK(load_texel(picture, x, 48).x > 0.3f);
    for (const int beside : {x - 2, x + 2}) CHECK(load_texel(picture, beside, 48).x < 0.02f);
  }
}

TEST_CASE(
    "layered: a layer that lies right behind the one before hides nothing, the next one does") {
  ThreadPool pool(2);
  const auto bar = [](int x, int) { return in_bar(x) ? glm::vec4{0, 0, 0, 1} : stripes(x); };
  const Image scene = square_of(bar);
  // The bar's own far side, and then the wall.
  const Image inside = square_of([](int x, int) {
    return in_bar(x) ? glm::vec4{0, 5, 0, 1.01f} : stripes(x);
  });
  const Image wall = square_of([](int x, int) { return stripes(x); });
  CHECK(equal(layered_picture(scene, {inside, wall}, pool), layered_picture(scene, {wall}, pool)));
}

TEST_CASE("layered: something near that hides something near") {
  ThreadPool pool(2);
  // Red at 1 m before green at 1.6 m (r = -4) before black.
  const Image scene = square_of([](int x, int) {
    return in_bar(x) ? glm::vec4{1, 0, 0, 1} : glm::vec4{0, 0, 0, 2};
  });
  const Image behind = square_of([](int x, int) {
    return in_bar(x) ? glm::vec4{0, 1, 0, 1.6f} : glm::vec4{0, 0, 0, 2};
  });
  const glm::vec4 middle = load_texel(layered_picture(scene, {behind}, pool), 48, 48);
  // The bar covers half of its disc.
  CHECK(middle.x == doctest::Approx(0.47).epsilon(0.05));
  CHECK(middle.x + middle.y == doctest::Approx(1.0).epsilon(0.02));
}
