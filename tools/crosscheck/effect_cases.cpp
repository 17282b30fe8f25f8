// Stages `bloom`, `lens-flare` and `tone-map`: the same picture with the effect on both sides.

#include <array>

#include "raster/effects/bloom.h"
#include "raster/effects/lens_flare.h"
#include "raster/images/image.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/effects_on_gl.h"

namespace softfocus {
namespace {

/// Mostly dark, with bright pixels, and if asked for halves of any bits.
Image lights(int width, int height, unsigned seed, bool any_bits) {
  RandomNumbers random{seed};
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(image, y)) {
      const float most = random.below(20) == 0 ? 50.0f : 1.5f;
      value = any_bits && random.below(32) == 0
                  ? static_cast<std::uint16_t>(random.word())
                  : float_to_half(random.between(0.0f, most), HalfRounding::nearest_even);
    }
  }
  return image;
}

struct BloomCase {
  BloomSettings settings;
  int width;
  int height;
  bool any_bits = false;
};

void bloom_both(const Bench& bench, Tally& tally, const BloomCase& what) {
  const Image source = lights(what.width, what.height, 77, what.any_bits);
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTexture picture = upload(source);
  const GlTarget& target = bloom_on_gl(passes, what.settings, {picture, what.width, what.height});
  Image emulated = make_image(Format::rgba16f, what.width, what.height);
  bloom(what.settings, source, emulated, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated);
}

void bloom_by_gaussian_both(const Bench& bench, Tally& tally, const GaussianBloomSettings& settings,
                            int width, int height) {
  const Image source = lights(width, height, 78, true);
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTexture picture = upload(source);
  const GlTarget& target = bloom_by_gaussian_on_gl(passes, settings, {picture, width, height});
  Image emulated = make_image(Format::rgba16f, width, height);
  bloom_by_gaussian(settings, source, emulated, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated);
}

void lens_flare_both(const Bench& bench, Tally& tally, const LensFlareSettings& settings, int width,
                     int height) {
  const Image source = lights(width, height, 79, false);
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTexture picture = upload(source);
  const GlTarget& target = lens_flare_on_gl(passes, settings, {picture, width, height});
  Image emulated = make_image(Format::rgba16f, width, height);
  lens_flare(settings, source, emulated, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated);
}

void tone_map_both(const Bench& bench, Tally& tally, const ToneCurve& curve) {
  Image source = make_image(Format::rgba16f, 256, 64);
  std::uint16_t next = 0;
  for (int y = 0; y < source.height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(source, y)) value = next++;
  }
  constexpr float kExposure = 1.3f;
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTexture picture = upload(source);
  const GlTarget& target =
      tone_map_on_gl(passes, curve, kExposure, {picture, source.width, source.height});
  Image emulated = make_image(Format::rgba16f, source.width, source.height);
  tone_map(curve, kExposure, source, emulated, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated);
}

}  // namespace

void add_effect_cases(std::vector<Case>& cases) {
  const auto add = [&](const char* name, bool quick, bool slow_too, const BloomCase& what) {
    cases.push_back({"bloom", name, quick, slow_too,
                     [=](const Bench& bench, Tally& tally) { bloom_both(bench, tally, what); }});
  };
  add("64x48", true, true, {{.levels = 3}, 64, 48});
  add("odd-61x43-steady", true, true, {{.levels = 4, .is_steady = true}, 61, 43});
  add("no-knee", false, true, {{.threshold = 0.8f, .knee = 0.0f, .levels = 2}, 64, 64});
  add("all-light", false, true, {{.threshold = 0.0f, .knee = 0.0f, .levels = 2}, 64, 64});
  add("512x512", false, false, {{}, 512, 512});
  add("any-bits", false, true, {{.levels = 3}, 64, 64, true});
  add("any-bits-steady", false, true, {{.levels = 3, .is_steady = true}, 64, 64, true});
  add("one-pixel", true, true, {{.levels = 3}, 1, 1});
  const auto add_gaussian = [&](const char* name, bool quick, bool slow_too, double sigma_px,
                                int width, int height) {
    cases.push_back({"bloom", name, quick, slow_too, [=](const Bench& bench, Tally& tally) {
                       bloom_by_gaussian_both(bench, tally, {.sigma_px = sigma_px}, width, height);
                     }});
  };
  add_gaussian("gaussian-64x48", true, true, 2.0, 64, 48);
  // More weights than a shader has as uniforms.
  add_gaussian("gaussian-wide-61x43", false, true, 16.0, 61, 43);
  add_gaussian("gaussian-512x512", false, false, 8.0, 512, 512);
  add_gaussian("gaussian-one-pixel", true, true, 8.0, 1, 1);
  const auto add_flare = [&](const char* name, bool quick, bool slow_too,
                             const LensFlareSettings& settings, int width, int height) {
    cases.push_back({"lens-flare", name, quick, slow_too, [=](const Bench& bench, Tally& tally) {
                       lens_flare_both(bench, tally, settings, width, height);
                     }});
  };
  add_flare("64x48", true, true, {.strength = 1.0f}, 64, 48);
  add_flare("odd-61x43-all", false, true,
            {.strength = 1.0f, .ghosts = 8, .fringe = 0.3f, .halo = 0.4f, .rays = 1.0f}, 61, 43);
  add_flare("wide-textures", false, true,
            {.strength = 1.0f, .aperture = 0.5f, .halo = 1.0f, .streak_px = 400.0f}, 96, 128);
  add_flare("lights-own-shape", false, true, {.strength = 1.0f, .aperture = 0.0f}, 64, 64);
  add_flare("beyond", false, true, {.beyond_m = 0.7f, .strength = 1.0f, .ghosts = 2}, 64, 64);
  add_flare("streaks-alone", false, true,
            {.strength = 1.0f, .ghosts = 0, .halo = 0.0f, .streak_px = 30.0f, .rays = 0.0f}, 64,
            64);
  add_flare("512x512", false, false, {}, 512, 512);
  add_flare("one-pixel", true, true, {}, 1, 1);
  for (const NamedToneCurve& named : kToneCurves) {
    cases.push_back({"tone-map", std::string{named.name} + "-every-half", true, true,
                     [curve = named.curve](const Bench& bench, Tally& tally) {
                       tone_map_both(bench, tally, curve);
                     }});
  }
}

}  // namespace softfocus
