// Stages `two-pass`, `one-pass` and their tiled forms: the same picture filtered by both sides.

#include <array>
#include <cmath>

#include "dof/dof.h"
#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/filter_on_gl.h"

namespace softfocus {
namespace {

// The picture that is filtered.
enum class TestPicture {
  figures,  ///< a drawn scene
  cube_room,
  sphere_world,
  random,   ///< random colours, random depths
  steps,    ///< random colours on a few depths, in blocks: silhouettes
  islands,  ///< random colours in focus, and single pixels before it, of all radii
  special,  ///< half subnormals, 65504, infinities and NaN; zero, infinite and NaN depths
};

Image drawn(const char* name, int width, int height, const Bench& bench) {
  const Scene& scene = loaded_scene(name);
  return draw_scene(scene, camera_matrices(scene.camera, 5, width, height), 5, width, height,
                    bench.profile, bench.pool);
}

Image make_picture(TestPicture kind, int width, int height, unsigned seed, const Bench& bench) {
  if (kind == TestPicture::figures) return drawn("figures", width, height, bench);
  if (kind == TestPicture::cube_room) return drawn("cube-room", width, height, bench);
  if (kind == TestPicture::sphere_world) return drawn("sphere-world", width, height, bench);
  static constexpr std::array<float, 6> kDepths{0.5f, 1.0f, 1.9f, 2.0f, 4.0f, 50.0f};
  static constexpr std::array<std::uint16_t, 13> kSpecialColours{
      0x0000, 0x8000, 0x0001, 0x03FF, 0x83FF, 0x0400, 0x3C00,
      0x3555, 0x7BFF, 0xFBFF, 0x7C00, 0xB800, 0x7E00};
  static constexpr std::array<std::uint16_t, 9> kSpecialDepths{
      0x0000, 0x8000, 0x0001, 0x3C00, 0x4000, 0x4880, 0x7BFF, 0x7C00, 0x7E00};
  RandomNumbers random{seed};
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (int x = 0; x < width; ++x) {
      std::uint16_t* texel = &values[static_cast<std::size_t>(4 * x)];
      for (int i = 0; i < 3; ++i) {
        texel[i] =
            kind == TestPicture::special && random.below(8) == 0
                ? kSpecialColours[static_cast<std::size_t>(random.below(kSpecialColours.size()))]
                : float_to_half(random.between(0.0f, 3.0f), HalfRounding::nearest_even);
      }
      float depth = random.between(0.3f, 20.0f);
      if (kind == TestPicture::steps) {
        depth = kDepths[static_cast<std::size_t>((x / 7 * 31 + y / 5 * 17) % 6)];
      }
      texel[3] = float_to_half(depth, HalfRounding::nearest_even);
      if (kind == TestPicture::islands) {
        texel[3] = float_to_half(random.below(75 + 2 * x) == 0 ? random.between(1.0f, 2.0f) : 2.0f,
                                 HalfRounding::nearest_even);
      }
      if (kind == TestPicture::special && random.below(4) == 0) {
        texel[3] = kSpecialDepths[static_cast<std::size_t>(random.below(kSpecialDepths.size()))];
      }
    }
  }
  return image;
}

struct FilterCase {
  TestPicture picture;
  int width;
  int height;
  DofSettings settings;
  int tile_px = kFilterTilePx;  ///< of the tiled form
};

void filter_both(const Bench& bench, Tally& tally, const char* method, FilterForm form,
                 const FilterCase& what) {
  const Image picture = make_picture(what.picture, what.width, what.height, 4711, bench);
  const GlTexture texture = upload(picture);
  const GlFilter filter = make_filter(bench.gl, bench.shaders, method, form, what.settings,
                                      what.width, what.height, what.tile_px);
  run_filter(filter, texture);
  add_pictures(tally, read_colour(filter.targets.back(), 0),
               apply(*find_method(method), {picture, what.settings, bench.profile}, bench.pool));
}

DofSettings focused(float radius_at_infinity_px, float focus_m, float max_coc_px,
                    float leak = 1.0f) {
  return {{radius_at_infinity_px, focus_m}, max_coc_px, leak};
}

void add_filter_cases(const char* method, FilterForm form, std::vector<Case>& cases) {
  const bool rings = method == std::string_view("one-pass");
  const bool tiled = form == FilterForm::tiled;
  const std::string stage = std::string{method} + (tiled ? "-tiled" : "");
  const auto add = [&](const std::string& name, bool quick, bool slow_too, const FilterCase& what) {
    cases.push_back(
        {stage, name, quick && (!tiled || what.picture == TestPicture::islands || what.width == 1),
         slow_too,
         [=](const Bench& bench, Tally& tally) { filter_both(bench, tally, method, form, what); }});
  };
  for (const int radius : {1, 4, 16, 64}) {
    const DofSettings lens =
        focused(static_cast<float>(radius) * 1.5f, 2.0f, static_cast<float>(radius));
    const std::string name = "radius" + std::to_string(radius);
    const bool heavy = rings && radius == 64;
    add("random-64x64-" + name, !heavy, radius <= (rings ? 4 : 16),
        {TestPicture::random, 64, 64, lens});
    add("steps-160x120-" + name, false, radius <= 4, {TestPicture::steps, 160, 120, lens});
    if (heavy) continue;
    add("figures-512x512-" + name, false, false, {TestPicture::figures, 512, 512, lens});
    add("figures-1024x1024-" + name, false, false, {TestPicture::figures, 1024, 1024, lens});
  }
  add("special-values", true, true, {TestPicture::special, 64, 64, focused(6.0f, 2.0f, 4.0f)});
  add("special-values-radius16", false, !rings,
      {TestPicture::special, 64, 64, focused(24.0f, 2.0f, 16.0f)});
  add("cube-room-512x512-radius16", false, false,
      {TestPicture::cube_room, 512, 512, focused(24.0f, 2.0f, 16.0f)});
  add("sphere-world-512x512-radius16", false, false,
      {TestPicture::sphere_world, 512, 512, focused(24.0f, 2.0f, 16.0f)});
  if (tiled) {
    add("islands-60x40-tiles5", true, true,
        {TestPicture::islands, 60, 40, focused(18.0f, 2.0f, 12.0f), 5});
    add("islands-150x131-tiles5", false, false,
        {TestPicture::islands, 150, 131, focused(18.0f, 2.0f, 12.0f), 5});
  }
  add("special-values-odd", false, true, {TestPicture::special, 33, 51, focused(6.0f, 2.0f, 4.0f)});
  add("odd-333x517", false, false, {TestPicture::steps, 333, 517, focused(12.0f, 2.0f, 8.0f)});
  add("wide-1024x512", false, false, {TestPicture::figures, 1024, 512, focused(12.0f, 2.0f, 8.0f)});
  add("one-pixel", true, true, {TestPicture::random, 1, 1, focused(12.0f, 2.0f, 8.0f)});
  add("one-column", true, true, {TestPicture::random, 1, 300, focused(12.0f, 2.0f, 8.0f)});
  add("lens-nothing-in-focus", false, true,
      {TestPicture::random, 48, 48, focused(4000.0f, 1000.0f, 8.0f)});
  add("lens-all-sharp", false, true, {TestPicture::random, 48, 48, focused(1e-6f, 2.0f, 8.0f)});
  add("lens-half-pixel-radius", false, true,
      {TestPicture::random, 48, 48, focused(3.0f, 2.0f, 0.5f)});
  add("lens-fractional-radius", true, true,
      {TestPicture::random, 48, 48, focused(9.0f, 2.0f, 6.7f)});
  add("lens-no-filter", false, true, {TestPicture::random, 48, 48, focused(3.0f, 2.0f, 0.0f)});
  add("lens-no-leak", false, true, {TestPicture::steps, 48, 48, focused(9.0f, 2.0f, 6.0f, 0.0f)});
  add("lens-leak-0.3", true, true, {TestPicture::steps, 48, 48, focused(9.0f, 2.0f, 6.0f, 0.3f)});
  add("lens-huge-leak", false, true,
      {TestPicture::steps, 48, 48, focused(9.0f, 2.0f, 6.0f, 1e30f)});
}

}  // namespace

void add_filter_cases(std::vector<Case>& cases) {
  for (const FilterForm form : kFilterForms) {
    for (const char* method : {"two-pass", "one-pass"}) add_filter_cases(method, form, cases);
  }
}

}  // namespace softfocus
