#include "dof/transparent.h"

#include <doctest/doctest.h>

#include <string>

#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// 16 (z - 2) / z: -16 at 1 m, 0 at 2 m, 8 at 4 m.
constexpr DofSettings kGlassSettings{.coc = {16.0f, 2.0f}, .max_coc_px = 16.0f};
constexpr int kGlassSize = 64;

Image plain(float grey, float depth_m) {
  return grey_depth_picture(kGlassSize, kGlassSize, [&](int, int) {
    return std::pair{grey, depth_m};
  });
}

// Stripes, a pixel in eight white.
Image striped(float depth_m) {
  return grey_depth_picture(kGlassSize, kGlassSize, [&](int x, int) {
    return std::pair{x % 8 == 0 ? 1.0f : 0.0f, depth_m};
  });
}

Image through(const char* method, const Image& scene, std::span<const TransparentLayer> layers) {
  ThreadPool pool{2};
  return apply(*find_method(method),
               {.scene = scene, .settings = kGlassSettings, .profile = {}, .transparent = layers},
               pool);
}

}  // namespace

TEST_CASE("transparent layers: every method lays a level pane over a level wall exactly") {
  const Image wall = plain(0.5f, 4.0f), colour = plain(0.125f, 1.0f), opacity = plain(0.25f, 1.0f);
  const TransparentLayer pane{colour, opacity};
  for (const Method& method : methods()) {
    const Image picture = through(std::string{method.name}.c_str(), wall, {&pane, 1});
    CAPTURE(std::string{method.name});
    CHECK(load_texel(picture, 32, 32).x == doctest::Approx(0.5).epsilon(0.002));
    CHECK(load_texel(picture, 32, 32).w == 4.0f);
  }
}

TEST_CASE("transparent layers: the nearest is laid over last") {
  const Image wall = plain(0.0f, 4.0f);
  const Image black = plain(0.0f, 3.0f), light = plain(0.5f, 1.0f);
  const Image half_far = plain(0.5f, 3.0f), half_near = plain(0.5f, 1.0f);
  const TransparentLayer layers[] = {{light, half_near}, {black, half_far}};
  CHECK(load_texel(through("pinhole", wall, layers), 9, 9).x == 0.5f);
  const TransparentLayer turned[] = {{black, half_far}, {light, half_near}};
  CHECK(load_texel(through("pinhole", wall, turned), 9, 9).x == 0.25f);
}

TEST_CASE("transparent layers: without any the result is the method's own") {
  const Image wall = random_scene_image(kGlassSize, kGlassSize, 4);
  const Image nothing = plain(0.0f, 4.0f);
  const TransparentLayer empty{nothing, nothing};
  for (const char* method : {"two-pass", "disc-layers", "scatter"}) {
    CHECK(equal(through(method, wall, {&empty, 1}), through(method, wall, {})));
  }
}

TEST_CASE("transparent layers: a blurred pane leaves what is in focus behind it sharp") {
  const Image wall = striped(2.0f);
  const Image colour = plain(0.0f, 1.0f), opacity = plain(0.5f, 1.0f);
  const TransparentLayer pane{colour, opacity};
  for (const char* method : {"two-pass", "one-pass", "disc-layers", "layered", "ring-bucket"}) {
    CAPTURE(std::string{method});
    const Image picture = through(method, wall, {&pane, 1});
    CHECK(load_texel(picture, 32, 32).x == doctest::Approx(0.5).epsilon(0.02));
    CHECK(load_texel(picture, 36, 32).x == doctest::Approx(0.0).epsilon(0.02));
  }
}

TEST_CASE("transparent layers: a pane in focus is sharp before a blurred wall") {
  const Image wall = striped(4.0f);
  const auto print = [](float of) {
    return grey_depth_picture(kGlassSize, kGlassSize, [of](int x, int) {
      return x >= 32 ? std::pair{of, 2.0f} : std::pair{0.0f, 4.0f};
    });
  };
  const Image colour = print(0.25f), opacity = print(0.5f);
  const TransparentLayer pane{colour, opacity};
  for (const char* method : {"two-pass", "disc-layers", "layered"}) {
    CAPTURE(std::string{method});
    const Image alone = through(method, wall, {});
    const Image picture = through(method, wall, {&pane, 1});
    for (const int x : {4, 20, 28, 35, 44, 60}) {
      const float behind = load_texel(alone, x, 32).x;
      CHECK(load_texel(picture, x, 32).x ==
            doctest::Approx(x < 32 ? behind : 0.25f + 0.5f * behind).epsilon(0.02));
    }
  }
}

TEST_CASE("transparent layers: the same bits on every vector unit and for any threads") {
  const Image wall = random_scene_image(70, 45, 4);
  const Image colour = random_scene_image(70, 45, 5), opacity = random_scene_image(70, 45, 5);
  const TransparentLayer pane{colour, opacity};
  const auto by = [&](int threads, Isa isa) {
    ThreadPool pool{threads, isa};
    return apply(
        *find_method("two-pass"),
        {.scene = wall, .settings = kGlassSettings, .profile = {}, .transparent = {&pane, 1}},
        pool);
  };
  const Image expected = by(1, Isa::scalar);
  for (const Isa isa : available_isas()) {
    for (const int threads : {1, 3}) CHECK(equal(by(threads, isa), expected));
  }
}

TEST_CASE("transparent layers: what is no layer of the scene is refused") {
  const Image wall = plain(0.0f, 4.0f), small = random_scene_image(8, 8, 1);
  Image result = plain(0.0f, 4.0f);
  const TransparentLayer right{wall, wall}, wrong{wall, small};
  DofInput input{.scene = wall, .settings = kGlassSettings, .profile = {}};
  input.transparent = {&right, 1};
  CHECK(input_error(input, result) == nullptr);
  input.transparent = {&wrong, 1};
  CHECK(std::string{input_error(input, result)} == "a layer has not the scene's size and format");
  const std::vector<TransparentLayer> many(5, right);
  input.transparent = many;
  CHECK(std::string{input_error(input, result)} == "there are more than 4 transparent layers");
  const std::vector<float> radii(kGlassSize * kGlassSize, 1.0f);
  input.transparent = {&right, 1};
  input.radii_px = radii;
  CHECK(input_error(input, result) != nullptr);
}
