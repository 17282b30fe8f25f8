#include "tools/gl/effects_on_gl.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace softfocus {
namespace {

GlTarget colour_target(int width, int height) {
  return make_target(std::array{Format::rgba16f}, width, height, false);
}

void set_bright_pass(const GlProgram& program, const BrightPass& pass) {
  set_uniform(program, "threshold", pass.threshold);
  set_uniform(program, "begin", pass.begin);
  set_uniform(program, "double_knee", pass.double_knee);
  set_uniform(program, "square_factor", pass.square_factor);
  set_uniform(program, "beyond", pass.beyond);
}

/// Passes of these effects, each into a target of its own.
struct Passes {
  const GlContext& context;
  const Shaders& shaders;

  GlProgram program(std::string_view fragment) const {
    return link_program(context, shaders, "fullscreen.vert", fragment);
  }

  GlTarget bright(const BrightPass& pass, const GlTexture& picture, int width, int height) const {
    GlTarget target = colour_target(width, height);
    const GlProgram bright = program("bloom_bright.frag");
    set_bright_pass(bright, pass);
    set_uniform(bright, "steady", pass.is_steady ? 1 : 0);
    set_texture(bright, "source", 0, picture);
    draw_fullscreen(target, bright);
    return target;
  }

  GlTarget halved(const GlTarget& above) const {
    GlTarget half = colour_target((above.width + 1) / 2, (above.height + 1) / 2);
    const GlProgram down = program("downsample.frag");
    set_texture(down, "source", 0, above.colour[0]);
    draw_fullscreen(half, down);
    return half;
  }

  GlTarget widened(const GlTarget& from, const GlTarget& own, float share) const {
    GlTarget wider = colour_target(own.width, own.height);
    const GlProgram up = program("upsample.frag");
    set_texture(up, "source", 0, from.colour[0]);
    set_texture(up, "own", 1, own.colour[0]);
    set_uniform(up, "share", share);
    draw_fullscreen(wider, up);
    return wider;
  }

  GlTarget added(const BrightPass& pass, float strength, const GlTexture& picture,
                 const GlTarget& scattered) const {
    GlTarget result = colour_target(scattered.width, scattered.height);
    const GlProgram combine = program("bloom_combine.frag");
    set_bright_pass(combine, pass);
    set_uniform(combine, "strength", strength);
    set_texture(combine, "source", 0, picture);
    set_texture(combine, "scattered", 1, scattered.colour[0]);
    draw_fullscreen(result, combine);
    return result;
  }

  GlTarget convolved(const GlTarget& light, const Kernel& kernel) const {
    Image table = make_image(Format::r32f, kernel.width, kernel.height);
    const float* weight = kernel.weights.data();
    for (int y = 0; y < table.height; ++y) {
      for (float& value : row<float>(table, y)) value = *weight++;
    }
    const GlTexture weights = upload(table);
    GlTarget filtered = colour_target(light.width, light.height);
    const GlProgram program_of_kernel = program("kernel.frag");
    set_texture(program_of_kernel, "source", 0, light.colour[0]);
    set_texture(program_of_kernel, "weights", 1, weights);
    set_uniform(program_of_kernel, "guard", glm::ivec2{0, 0});
    draw_fullscreen(filtered, program_of_kernel);
    return filtered;
  }

  GlTarget halo_of(const GlTarget& light, float radius_px) const {
    if (radius_px <= kMostHaloRadiusPx) return convolved(light, halo_kernel(radius_px));
    return widened(halo_of(halved(light), 0.5f * radius_px), light, 1.0f);
  }

  GlTarget copied(const CopiesPass& pass, const GlTarget& source, const GlTexture& own) const {
    constexpr int kNumbers = 6;
    Image table = make_image(Format::r32f, kNumbers, static_cast<int>(pass.copies.size()));
    for (int y = 0; y < table.height; ++y) {
      const ScaledCopy& copy = pass.copies[static_cast<std::size_t>(y)];
      const std::array numbers{copy.scale.x,  copy.scale.y,  copy.scale.z,
                               copy.colour.x, copy.colour.y, copy.colour.z};
      std::copy(numbers.begin(), numbers.end(), row<float>(table, y).begin());
    }
    const GlTexture copies = upload(table);
    GlTarget target = colour_target(source.width, source.height);
    const GlProgram copy = program("scaled_copies.frag");
    set_uniform(copy, "anchor_and_fade",
                glm::vec4{pass.anchor.x, pass.anchor.y, pass.fade.x, pass.fade.y});
    set_texture(copy, "source", 0, source.colour[0]);
    set_texture(copy, "own", 1, own);
    set_texture(copy, "copies", 2, copies);
    draw_fullscreen(target, copy);
    return target;
  }
};

}  // namespace

GlTarget bloom_on_gl(const GlContext& context, const Shaders& shaders,
                     const BloomSettings& settings, const GlTexture& picture, int width,
                     int height) {
  const Passes passes{context, shaders};
  const BrightPass pass = bright_pass_of(settings);
  std::vector<GlTarget> levels;
  levels.push_back(passes.bright(pass, picture, width, height));
  for (int i = 0; i < settings.levels; ++i) {
    GlTarget half = passes.halved(levels.back());
    if (i == 0 && pass.is_steady) {
      GlTarget mean = colour_target(half.width, half.height);
      const GlProgram divide = passes.program("bloom_divide.frag");
      set_texture(divide, "source", 0, half.colour[0]);
      draw_fullscreen(mean, divide);
      half = std::move(mean);
    }
    levels.push_back(std::move(half));
  }
  for (std::size_t i = levels.size() - 1; i-- > 0;) {
    levels[i] = passes.widened(levels[i + 1], levels[i], i == 0 ? 1.0f : settings.spread);
  }
  return passes.added(pass, settings.strength, picture, levels[0]);
}

GlTarget lens_flare_on_gl(const GlContext& context, const Shaders& shaders,
                          const LensFlareSettings& settings, const GlTexture& picture, int width,
                          int height) {
  const Passes passes{context, shaders};
  std::vector<GlTarget> levels;
  levels.push_back(passes.bright(bright_pass_of(settings), picture, width, height));
  for (int i = 0; i < kFlareHalvings; ++i) levels.push_back(passes.halved(levels.back()));
  const GlTarget& light = levels.back();
  const GlTexture nothing = upload(make_image(Format::rgba16f, light.width, light.height));
  std::vector<GlTarget> steps;
  const auto flare = [&]() -> const GlTexture& {
    return steps.empty() ? nothing : steps.back().colour[0];
  };
  if (settings.streak_px > 0.0f) {
    const float length = settings.streak_px / static_cast<float>(1 << kFlareHalvings);
    steps.push_back(passes.convolved(light, row_kernel(streak_weights(length))));
  }
  if (settings.halo > 0.0f) {
    const float radius_px = settings.halo * 0.5f * static_cast<float>(light.height);
    steps.push_back(passes.added(kNothingBright, 1.0f, flare(), passes.halo_of(light, radius_px)));
  }
  if (settings.rays > 0.0f) {
    const CopiesPass pass = rays_pass(settings.rays, middle_of_light(read_colour(light, 0)));
    const GlTarget once = passes.copied(pass, light, nothing);
    steps.push_back(passes.copied(pass, once, flare()));
  }
  const CopiesPass ghosts = ghosts_pass(settings, light.width, light.height);
  if (!ghosts.copies.empty()) steps.push_back(passes.copied(ghosts, light, flare()));
  if (steps.empty()) {
    steps.push_back(passes.bright(kNothingBright, nothing, light.width, light.height));
  }
  for (std::size_t i = kFlareHalvings; i-- > 0;) {
    steps.push_back(passes.widened(steps.back(), levels[i], 1.0f));
  }
  return passes.added(kNothingBright, settings.strength, picture, steps.back());
}

GlTarget tone_map_on_gl(const GlContext& context, const Shaders& shaders, const ToneCurve& curve,
                        float exposure, const GlTexture& picture, int width, int height) {
  GlTarget result = colour_target(width, height);
  const GlProgram program = link_program(context, shaders, "fullscreen.vert", "tone_map.frag");
  set_uniform(program, "exposure", exposure);
  set_uniform(program, "numerator", glm::vec3{curve.a, curve.b, curve.c});
  set_uniform(program, "denominator", glm::vec3{curve.d, curve.e, curve.f});
  set_uniform(program, "offset", curve.g);
  set_uniform(program, "factor", curve.h);
  set_texture(program, "source", 0, picture);
  draw_fullscreen(result, program);
  return result;
}

}  // namespace softfocus
