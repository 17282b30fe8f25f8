// Stages `bloom`, `lens-flare` and `tone-map`: the same picture with the effect on both sides.

#include <array>

#include "raster/effects/bloom.h"
#include "raster/effects/lens_flare.h"
#include "raster/images/image.h"
#include "scenes/draw/velocity.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/effects_on_gl.h"
#include "tools/gl/scene_on_gl.h"
#include "tools/gl/temporal_on_gl.h"

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
  add("any-bits", true, true, {{.levels = 3}, 64, 64, true});
  add("any-bits-steady", true, true, {{.levels = 3, .is_steady = true}, 64, 64, true});
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

// Stages `velocity`, `reproject` and `motion-blur`: how pictures move, and are blurred by it, on
// both sides.

namespace {

struct MotionCase {
  std::string scene;
  int width, height;
  double frame;
  double from_frame, to_frame;
};

MotionSpan span_of(const Scene& scene, const MotionCase& what) {
  return {instant_at(scene, what.from_frame, what.width, what.height),
          instant_at(scene, what.to_frame, what.width, what.height)};
}

void velocity_both(const Bench& bench, Tally& tally, const MotionCase& what) {
  const Scene& scene = loaded_scene(what.scene);
  const Instant shown = instant_at(scene, what.frame, what.width, what.height);
  const MotionSpan span = span_of(scene, what);
  GlScene on_gl{bench.gl, bench.shaders, scene};
  add_pictures(
      tally, on_gl.draw_velocity(shown, span, what.width, what.height),
      draw_velocity(scene, shown, span, what.width, what.height, bench.profile, bench.pool));
}

void reproject_both(const Bench& bench, Tally& tally, const MotionCase& what, bool any_bits) {
  Scene scene = loaded_scene(what.scene);
  scene.camera.orbit_degrees_per_frame = 1.5;
  const Instant shown = instant_at(scene, what.frame, what.width, what.height);
  Image picture = draw_scene(scene, shown.camera, what.frame, what.width, what.height,
                             bench.profile, bench.pool);
  RandomNumbers random{81};
  for (int y = 0; any_bits && y < picture.height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(picture, y)) {
      if (random.below(4) == 0) value = static_cast<std::uint16_t>(random.word());
    }
  }
  const CameraMotion motion =
      camera_motion(scene, shown.camera, span_of(scene, what), what.width, what.height);
  const GlTarget target = camera_velocity_on_gl(bench.gl, bench.shaders, motion, upload(picture),
                                                what.width, what.height);
  Image emulated = make_image(Format::rg16f, what.width, what.height);
  camera_velocity(motion, picture, emulated, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated);
}

struct BlurCase {
  std::string scene;  ///< none: motions at random
  int width, height;
  MotionBlurSettings settings;
};

Image random_picture(Format format, int width, int height, float most, RandomNumbers& random) {
  Image image = make_image(format, width, height);
  for (int y = 0; y < height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(image, y)) {
      const float least = format == Format::rg16f ? -most : 0.0f;
      value =
          random.below(40) == 0
              ? static_cast<std::uint16_t>(random.word())
              : float_to_half(random.between(least, most * 0.01f * static_cast<float>(1 + y % 100)),
                              HalfRounding::nearest_even);
    }
  }
  return image;
}

void blur_both(const Bench& bench, Tally& tally, const BlurCase& what) {
  const auto [scene_name, width, height, settings] = what;
  RandomNumbers random{83};
  Image picture, velocity;
  if (scene_name.empty()) {
    picture = random_picture(Format::rgba16f, width, height, 4.0f, random);
    velocity = random_picture(Format::rg16f, width, height, 30.0f, random);
  } else {
    Scene scene = loaded_scene(scene_name);
    scene.camera.orbit_degrees_per_frame = 3.0;
    const Instant shown = instant_at(scene, 7.0, width, height);
    picture = draw_scene(scene, shown.camera, 7.0, width, height, bench.profile, bench.pool);
    velocity = draw_velocity(scene, shown, {instant_at(scene, 6.0, width, height), shown}, width,
                             height, bench.profile, bench.pool);
  }
  const GlTexture on_gl = upload(picture), velocity_on_gl = upload(velocity);
  Image emulated = make_image(Format::rgba16f, width, height);
  EffectPasses passes{bench.gl, bench.shaders};
  const GlMovingPicture of{on_gl, velocity_on_gl, width, height};
  const GlTarget& target = motion_blur_on_gl(passes, settings, of);
  motion_blur(settings, picture, velocity, emulated, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated, "by tiles");
  const GlTarget& simple =
      motion_blur_along_own_on_gl(passes, settings.shutter, settings.samples, of);
  motion_blur_along_own(settings.shutter, settings.samples, picture, velocity, emulated,
                        bench.profile, bench.pool);
  add_pictures(tally, read_colour(simple, 0), emulated, "simple");
}

void add_blur_cases(std::vector<Case>& cases) {
  for (const MotionFilter filter : {MotionFilter::one_way, MotionFilter::two_ways}) {
    const char* suffix = filter == MotionFilter::one_way ? "-2012" : "";
    const auto add = [&](const std::string& name, bool quick, bool slow_too, BlurCase what) {
      what.settings.filter = filter;
      cases.push_back({"motion-blur", name + suffix, quick, slow_too,
                       [=](const Bench& bench, Tally& tally) { blur_both(bench, tally, what); }});
    };
    add("cube-room-128x96", true, true, {"cube-room", 128, 96, {.radius_px = 16}});
    add("any-bits-61x43", true, true,
        {"", 61, 43, {.shutter = 1.0f, .samples = 5, .radius_px = 7}});
    add("sphere-world-512x512", false, false, {"sphere-world", 512, 512, {.shutter = 1.0f}});
    add("one-pixel", false, true, {"", 1, 1, {.samples = 1}});
  }
}

}  // namespace

void add_motion_cases(std::vector<Case>& cases) {
  const auto name_of = [](const MotionCase& what) {
    return what.scene + '-' + std::to_string(what.width) + 'x' + std::to_string(what.height);
  };
  const auto add_velocity = [&](const MotionCase& what, bool quick, bool slow_too) {
    cases.push_back({"velocity", name_of(what), quick, slow_too,
                     [=](const Bench& bench, Tally& tally) { velocity_both(bench, tally, what); }});
  };
  add_velocity({"cube-room", 128, 96, 7, 6, 7}, true, true);
  add_velocity({"foliage", 97, 61, 7, 6.75, 7.25}, true, true);  // holes
  add_velocity({"sphere-world", 128, 96, 7, 6, 7}, false, true);
  add_velocity({"figures", 1, 1, 3, 2, 3}, false, true);
  add_velocity({"cube-room", 512, 512, 7, 0, 14}, false, false);
  add_velocity({"glass", 333, 517, 31, 30, 31}, false, false);
  const auto add_reproject = [&](const MotionCase& what, bool quick, bool slow_too,
                                 bool any_bits = false) {
    cases.push_back(
        {"reproject", name_of(what) + (any_bits ? "-any-bits" : ""), quick, slow_too,
         [=](const Bench& bench, Tally& tally) { reproject_both(bench, tally, what, any_bits); }});
  };
  add_reproject({"lattice", 128, 96, 7, 6, 7}, true, true);
  add_reproject({"figures", 97, 61, 7, 6.5, 7.5}, false, true, true);
  add_reproject({"sphere-world", 512, 512, 7, 6, 7}, false, false);
  add_blur_cases(cases);
}

}  // namespace softfocus
