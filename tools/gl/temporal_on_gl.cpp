#include "tools/gl/temporal_on_gl.h"

#include <array>
#include <variant>

#include "raster/temporal/forward_reproject.h"

namespace softfocus {
namespace {

constexpr std::array kPictureAndFrames{Format::rgba16f, Format::r32f};

const GlTarget& make_on_gl(EffectPasses& passes, const TemporalAa& settings,
                           const GlFrameSources& of) {
  const GlTarget& found = reverse_reproject_on_gl(passes, settings.reproject, of);
  return accumulate_on_gl(passes, settings.average, of.drawn, found.colour[0], of.width, of.height);
}

const GlTarget& make_on_gl(EffectPasses& passes, const Refresh& settings,
                           const GlFrameSources& of) {
  const GlTarget& found =
      reverse_reproject_on_gl(passes, own_depth_cubic(settings.depth_tolerance), of);
  return refresh_on_gl(passes, settings.groups, of.turn, of.drawn, found.colour[0], of.width,
                       of.height);
}

const GlTarget& make_on_gl(EffectPasses& passes, const Reproject& settings,
                           const GlFrameSources& of) {
  const GlTarget* found =
      settings.forward
          ? &forward_reproject_on_gl(passes, of.before, of.velocity, of.width, of.height)
          : &reverse_reproject_on_gl(passes, own_depth_cubic(settings.depth_tolerance), of);
  if (settings.holes == UnseenPixels::drawn) {
    constexpr int kNoTurn = -1;
    return refresh_on_gl(passes, 1, kNoTurn, of.drawn, found->colour[0], of.width, of.height);
  }
  if (!settings.forward) {
    found = &put_depths_on_gl(passes, of.drawn, found->colour[0], of.width, of.height);
  }
  return settings.holes == UnseenPixels::filled
             ? fill_holes_on_gl(passes, found->colour[0], of.width, of.height)
             : *found;
}

}  // namespace

const GlTarget& make_frame_on_gl(EffectPasses& passes, const FrameEffect& effect,
                                 const GlFrameSources& sources) {
  passes.begin();
  return std::visit(
      [&](const auto& settings) -> const GlTarget& {
        return make_on_gl(passes, settings, sources);
      },
      effect);
}

const GlTarget& reverse_reproject_on_gl(EffectPasses& passes, const ReprojectSettings& settings,
                                        const GlFrameSources& sources) {
  const GlTarget& target = passes.target(sources.width, sources.height);
  const GlProgram& program = passes.program("reproject.frag");
  set_texture(program, "depths", 0, sources.drawn);
  set_texture(program, "velocity", 1, sources.velocity);
  set_texture(program, "before", 2, sources.before);
  set_texture(program, "frames", 3, sources.frames);
  set_uniform(program, "depth_tolerance", used_depth_tolerance(settings));
  set_uniform(program, "reach", settings.takes_neighbours ? 1 : 0);
  set_uniform(program, "cubic", settings.is_cubic ? 1 : 0);
  passes.draw(target, program);
  return target;
}

const GlTarget& accumulate_on_gl(EffectPasses& passes, const AccumulateSettings& settings,
                                 const GlTexture& now, const GlTexture& old, int width,
                                 int height) {
  constexpr float kNeighbours = 9.0f;
  const GlTarget& target = passes.target(kPictureAndFrames, width, height, false);
  const GlProgram& program = passes.program("accumulate.frag");
  set_texture(program, "now", 0, now);
  set_texture(program, "old", 1, old);
  set_uniform(program, "box", static_cast<int>(settings.box));
  set_uniform(program, "deviations", settings.deviations);
  set_uniform(program, "least_share", settings.least_share);
  set_uniform(program, "samples", kNeighbours);
  passes.draw(target, program);
  return target;
}

const GlTarget& refresh_on_gl(EffectPasses& passes, int groups, int turn, const GlTexture& drawn,
                              const GlTexture& found, int width, int height) {
  const GlTarget& target = passes.target(kPictureAndFrames, width, height, false);
  const GlProgram& program = passes.program("refresh.frag");
  set_texture(program, "drawn", 0, drawn);
  set_texture(program, "found", 1, found);
  set_uniform(program, "groups", groups);
  set_uniform(program, "turn", turn);
  passes.draw(target, program);
  return target;
}

const GlTarget& forward_reproject_on_gl(EffectPasses& passes, const GlTexture& before,
                                        const GlTexture& velocity, int width, int height) {
  const GlTarget& target = passes.target(std::array{Format::rgba16f}, width, height, true);
  const GlProgram& program = passes.program_of("forward_reproject.vert", "forward_reproject.frag");
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

const GlTarget& fill_holes_on_gl(EffectPasses& passes, const GlTexture& scattered, int width,
                                 int height) {
  const GlTarget& target = passes.target(width, height);
  const GlProgram& program = passes.program("fill_holes.frag");
  set_texture(program, "scattered", 0, scattered);
  set_uniform(program, "reach", kHoleReach);
  passes.draw(target, program);
  return target;
}

const GlTarget& put_depths_on_gl(EffectPasses& passes, const GlTexture& drawn,
                                 const GlTexture& found, int width, int height) {
  const GlTarget& target = passes.target(width, height);
  const GlProgram& program = passes.program("put_depths.frag");
  set_texture(program, "drawn", 0, drawn);
  set_texture(program, "found", 1, found);
  passes.draw(target, program);
  return target;
}

}  // namespace softfocus
