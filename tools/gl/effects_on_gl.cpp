#include "tools/gl/effects_on_gl.h"

#include <array>
#include <utility>

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
}

}  // namespace

GlTarget bloom_on_gl(const GlContext& context, const Shaders& shaders,
                     const BloomSettings& settings, const GlTexture& picture, int width,
                     int height) {
  const auto program = [&](std::string_view fragment) {
    return link_program(context, shaders, "fullscreen.vert", fragment);
  };
  const BrightPass pass = bright_pass_of(settings);
  std::vector<GlTarget> levels;
  levels.push_back(colour_target(width, height));
  const GlProgram bright = program("bloom_bright.frag");
  set_bright_pass(bright, pass);
  set_uniform(bright, "steady", pass.is_steady ? 1 : 0);
  set_texture(bright, "source", 0, picture);
  draw_fullscreen(levels[0], bright);

  const GlProgram down = program("downsample.frag");
  for (int i = 0; i < settings.levels; ++i) {
    const GlTarget& above = levels.back();
    GlTarget half = colour_target((above.width + 1) / 2, (above.height + 1) / 2);
    set_texture(down, "source", 0, above.colour[0]);
    draw_fullscreen(half, down);
    if (i == 0 && pass.is_steady) {
      GlTarget mean = colour_target(half.width, half.height);
      const GlProgram divide = program("bloom_divide.frag");
      set_texture(divide, "source", 0, half.colour[0]);
      draw_fullscreen(mean, divide);
      half = std::move(mean);
    }
    levels.push_back(std::move(half));
  }
  const GlProgram up = program("upsample.frag");
  for (std::size_t i = levels.size() - 1; i-- > 0;) {
    GlTarget wider = colour_target(levels[i].width, levels[i].height);
    set_texture(up, "source", 0, levels[i + 1].colour[0]);
    set_texture(up, "own", 1, levels[i].colour[0]);
    set_uniform(up, "share", i == 0 ? 1.0f : settings.spread);
    draw_fullscreen(wider, up);
    levels[i] = std::move(wider);
  }
  GlTarget result = colour_target(width, height);
  const GlProgram combine = program("bloom_combine.frag");
  set_bright_pass(combine, pass);
  set_uniform(combine, "strength", settings.strength);
  set_texture(combine, "source", 0, picture);
  set_texture(combine, "scattered", 1, levels[0].colour[0]);
  draw_fullscreen(result, combine);
  return result;
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
