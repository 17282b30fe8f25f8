// Shadows that take a part of the light's share.

#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/draw/shadowed_layers.h"
#include "tests/support/shadow_scene.h"

using namespace softfocus;

namespace {

constexpr int kWidth = 120, kHeight = 80;

Scene darkened(ShadowKind kind, float darkness) {
  Scene scene = test::shadow_scene(kind);
  for (Light& light : scene.lights) light.shadow_darkness = darkness;
  return scene;
}

struct Shown {
  Image picture;
  PreparedScene prepared;
};

Shown shown(const Scene& scene, ThreadPool& pool) {
  Shown made{make_image(Format::rgba16f, kWidth, kHeight), prepare_scene(scene, {}, pool)};
  draw_scene(made.prepared, camera_matrices(scene.camera, 5.0, kWidth, kHeight), 5.0, made.picture,
             pool);
  return made;
}

bool same_pixel(const Image& a, const Image& b, int x, int y) {
  return std::memcmp(row<std::uint16_t>(a, y).data() + 4 * x,
                     row<std::uint16_t>(b, y).data() + 4 * x, 8) == 0;
}

}  // namespace

TEST_CASE("a shadow of darkness 1/2 has the bits of the scene whose light has half its colour") {
  ThreadPool pool{2};
  const Shown made = shown(darkened(ShadowKind::projected, 0.5f), pool);
  const std::vector<std::uint8_t>& mask = made.prepared.shadows->masks[0];
  std::size_t in_shadow = 0;
  for (unsigned of = 0; of < 4; ++of) {
    Scene dimmed = darkened(ShadowKind::none, 1.0f);
    for (std::size_t i = 0; i < 2; ++i) {
      if ((of >> i & 1) != 0) dimmed.lights[i].colour *= 0.5f;
    }
    const Image expected = shown(dimmed, pool).picture;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (mask[static_cast<std::size_t>(kWidth * y + x)] != of) continue;
        in_shadow += of != 0 ? 1 : 0;
        REQUIRE(same_pixel(made.picture, expected, x, y));
      }
    }
  }
  CHECK(in_shadow > 500);
}

TEST_CASE("shadows of darkness 0 are none, to the bit") {
  ThreadPool pool{2};
  CHECK(equal(shown(darkened(ShadowKind::projected, 0.0f), pool).picture,
              shown(darkened(ShadowKind::none, 1.0f), pool).picture));
}

TEST_CASE("where a map's kernel is partly in shadow, darkness takes a part of that part") {
  ThreadPool pool{2};
  Scene scene = darkened(ShadowKind::map, 0.25f);
  scene.lights.resize(1);
  scene.lights[0].map = {.size = 256, .kernel = 5};
  const Shown made = shown(scene, pool);
  set_shadows(scene, ShadowKind::none);
  const Image lit = shown(scene, pool).picture;
  scene.lights[0].colour *= 0.75f;
  const Image dimmed = shown(scene, pool).picture;
  std::size_t partly = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const std::uint8_t share =
          made.prepared.shadows->shares[0][0][static_cast<std::size_t>(kWidth * y + x)];
      if (share == 0) continue;
      ++partly;
      const float part = static_cast<float>(share) / 25.0f;
      const float with = load_texel<Format::rgba16f>(lit, x, y).x;
      const float without = load_texel<Format::rgba16f>(dimmed, x, y).x;
      REQUIRE(
          load_texel<Format::rgba16f>(made.picture, x, y).x ==
          half_to_float(float_to_half(with + part * (without - with), HalfRounding::nearest_even)));
    }
  }
  CHECK(partly > 100);
}
