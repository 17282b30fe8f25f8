#include "tools/gl/temporal_on_gl.h"

#include <array>

#include "raster/temporal/forward_reproject.h"

namespace softfocus {

GlTarget reverse_reproject_on_gl(const GlContext& context, const Shaders& shaders,
                                 const ReprojectSettings& settings,
                                 const ReprojectTextures& textures, int width, int height) {
  GlTarget target = make_target(std::array{Format::rgba16f}, width, height, false);
  const GlProgram program = link_program(context, shaders, "fullscreen.vert", "reproject.frag");
  set_texture(program, "depths", 0, textures.depths);
  set_texture(program, "velocity", 1, textures.velocity);
  set_texture(program, "before", 2, textures.before);
  set_texture(program, "frames", 3, textures.frames);
  set_uniform(program, "depth_tolerance", used_depth_tolerance(settings));
  set_uniform(program, "reach", settings.takes_neighbours ? 1 : 0);
  set_uniform(program, "cubic", settings.is_cubic ? 1 : 0);
  draw_fullscreen(target, program);
  return target;
}

GlTarget accumulate_on_gl(const GlContext& context, const Shaders& shaders,
                          const AccumulateSettings& settings, const GlTexture& now,
                          const GlTexture& old, int width, int height) {
  constexpr float kNeighbours = 9.0f;
  GlTarget target = make_target(std::array{Format::rgba16f, Format::r32f}, width, height, false);
  const GlProgram program = link_program(context, shaders, "fullscreen.vert", "accumulate.frag");
  set_texture(program, "now", 0, now);
  set_texture(program, "old", 1, old);
  set_uniform(program, "box", static_cast<int>(settings.box));
  set_uniform(program, "deviations", settings.deviations);
  set_uniform(program, "least_share", settings.least_share);
  set_uniform(program, "samples", kNeighbours);
  draw_fullscreen(target, program);
  return target;
}

GlTarget refresh_on_gl(const GlContext& context, const Shaders& shaders, int groups, int turn,
                       const GlTexture& drawn, const GlTexture& found, int width, int height) {
  GlTarget target = make_target(std::array{Format::rgba16f, Format::r32f}, width, height, false);
  const GlProgram program = link_program(context, shaders, "fullscreen.vert", "refresh.frag");
  set_texture(program, "drawn", 0, drawn);
  set_texture(program, "found", 1, found);
  set_uniform(program, "groups", groups);
  set_uniform(program, "turn", turn);
  draw_fullscreen(target, program);
  return target;
}

GlTarget forward_reproject_on_gl(const GlContext& context, const Shaders& shaders,
                                 const GlTexture& before, const GlTexture& velocity, int width,
                                 int height) {
  GlTarget target = make_target(std::array{Format::rgba16f}, width, height, true);
  const GlProgram program =
      link_program(context, shaders, "forward_reproject.vert", "forward_reproject.frag");
  set_texture(program, "before", 0, before);
  set_texture(program, "velocity", 1, velocity);
  bind(target);
  glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  glClearDepth(1.0);
  glDepthMask(GL_TRUE);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
  glUseProgram(program);
  glDrawArrays(GL_POINTS, 0, width * height);
  return target;
}

GlTarget fill_holes_on_gl(const GlContext& context, const Shaders& shaders,
                          const GlTexture& scattered, int width, int height) {
  GlTarget target = make_target(std::array{Format::rgba16f}, width, height, false);
  const GlProgram program = link_program(context, shaders, "fullscreen.vert", "fill_holes.frag");
  set_texture(program, "scattered", 0, scattered);
  set_uniform(program, "reach", kHoleReach);
  draw_fullscreen(target, program);
  return target;
}

}  // namespace softfocus
