// Stages `velocity`, `reproject` and `motion-blur`: how pictures move, and are blurred by it, on
// both sides.

#include "scenes/draw/velocity.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/motion_on_gl.h"
#include "tools/gl/scene_on_gl.h"

namespace softfocus {
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
