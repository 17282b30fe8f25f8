// fields: near, focus and far as pictures of their own.

#include "dof/methods/fields.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "dof/scatter/scatter_discs.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// r = 16 (z - 2) / z.
constexpr DofSettings kLens{.coc = {16.0f, 2.0f}, .max_coc_px = 16.0f};
float depth_of(float radius_px) { return 32.0f / (16.0f - radius_px); }

float light_at(const Image& image, int x, int y) { return load_texel(image, x, y).y; }

Image filtered(const Image& scene) {
  ThreadPool pool(2);
  return apply(*find_method("fields"), {scene, kLens, {}}, pool);
}

// The share of the pixel (dx, dy) that the disc covers.
double cover(const ScatterDiscs& discs, std::size_t disc, int dx, int dy) {
  if (std::abs(dy) > discs.reaches[disc]) return 0.0;
  const DiscSpan span = discs.spans[static_cast<std::size_t>(std::abs(dy) * discs.count) + disc];
  if (span.whole == -1) return dx == 0 ? 0.25 * span.eighths - 1.0 : 0.0;
  const int apart = std::abs(dx) - span.whole;
  return apart <= 0 ? 1.0 : apart == 1 ? 0.125 * span.eighths : 0.0;
}

}  // namespace

TEST_CASE("a field's radius is the root of its pixels' mean square") {
  Image scene = make_image(Format::rgba16f, 12, 1);
  set_depth(scene, [](int x, int) { return depth_of(x < 4 ? 3.0f : x < 8 ? 9.0f : -6.0f); });
  const FieldRadii radii = field_radii({scene, kLens, {}});
  CHECK(radii.far_px == doctest::Approx(6.75));  // sqrt(45), in quarters
  CHECK(radii.near_px == doctest::Approx(6.0));
  set_depth(scene, [](int, int) { return 2.0f; });
  CHECK(field_radii({scene, kLens, {}}).far_px == 0.0f);
  CHECK(field_radii({scene, kLens, {}}).near_px == 0.0f);
}

TEST_CASE("far and focus are what the equations say, in binary64") {
  Image scene = random_scene_image(41, 37, 11);
  set_depth(scene, [](int x, int y) {
    const int block = (x / 6 * 7 + y / 5 * 3) % 4;
    return depth_of(block == 0 ? 0.0f : 2.5f * static_cast<float>(block));
  });
  const DofInput input{scene, kLens, {}};
  const float field_px = field_radii(input).far_px;
  const ScatterDiscs discs = make_discs(field_px);
  const auto disc = static_cast<std::size_t>(disc_of(field_px));
  const auto share = [&](int x, int y) {
    const double r = static_cast<double>(coc_radius_px(kLens.coc, load_texel(scene, x, y).w));
    return r > 0.5 ? std::min(1.0, r * r / (static_cast<double>(field_px) * field_px)) : 0.0;
  };
  const Image result = filtered(scene);
  double worst = 0.0;
  for (int y = 0; y < 37; ++y) {
    for (int x = 0; x < 41; ++x) {
      double sum = 0.0, weights = 0.0;
      for (int dy = -12; dy <= 12; ++dy) {
        for (int dx = -12; dx <= 12; ++dx) {
          const int from_x = std::clamp(x + dx, 0, 40), from_y = std::clamp(y + dy, 0, 36);
          const double weight = cover(discs, disc, dx, dy) * share(from_x, from_y);
          sum += weight * static_cast<double>(light_at(scene, from_x, from_y));
          weights += weight;
        }
      }
      const auto own = static_cast<double>(light_at(scene, x, y));
      const double expected = share(x, y) > 0.0 ? own + share(x, y) * (sum / weights - own) : own;
      worst = std::max(worst, std::fabs(expected - static_cast<double>(light_at(result, x, y))));
    }
  }
  CHECK(worst < 0x1p-10);
}

TEST_CASE("the near field is soft on both sides of its outline") {
  // A bright half before a dark one in focus: a disc's edge, half of it at the outline.
  Image scene = make_image(Format::rgba16f, 80, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 80; ++x) {
      const bool near = x < 40;
      const float light = near ? 1.0f : 0.0f;
      store_texel(scene, x, y, {light, light, light, depth_of(near ? -12.0f : 0.0f)}, {});
    }
  }
  const Image result = filtered(scene);
  for (const int d : {0, 3, 6, 9, 11}) {
    // The share of a disc of radius 12 beyond a chord, at a pixel's middle.
    const double t = (d + 0.5) / 12.0;
    const double beyond = (std::acos(t) - t * std::sqrt(1.0 - t * t)) / 3.14159265358979;
    INFO(d, " pixels from the outline");
    CHECK(static_cast<double>(light_at(result, 40 + d, 20)) ==
          doctest::Approx(beyond).epsilon(0.02));
  }
  CHECK(light_at(result, 54, 20) == 0.0f);
  CHECK(light_at(result, 26, 20) == doctest::Approx(1.0f).epsilon(0.001));
}

TEST_CASE("a thing in focus stays sharp before the far field, to the bit") {
  Image scene = random_scene_image(48, 48, 12);
  const auto in_focus = [](int x, int y) { return x / 8 % 2 == y / 8 % 2; };
  set_depth(scene, [&](int x, int y) { return depth_of(in_focus(x, y) ? 0.0f : 10.0f); });
  const Image result = filtered(scene);
  int changed = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x) {
      if (in_focus(x, y)) changed += load_texel(result, x, y) != load_texel(scene, x, y);
    }
  }
  CHECK(changed == 0);
}
