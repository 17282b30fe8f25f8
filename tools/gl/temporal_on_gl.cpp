#include "tools/gl/temporal_on_gl.h"

#include <array>
#include <variant>

#include "raster/temporal/forward_reproject.h"

namespace softfocus {

GlTarget camera_velocity_on_gl(const GlContext& context, const Shaders& shaders,
                               const CameraMotion& motion, const GlTexture& picture, int width,
                               int height) {
  GlTarget target = make_target(std::array{Format::rg16f}, width, height, false);
  const GlProgram program =
      link_program(context, shaders, "fullscreen.vert", "camera_velocity.frag");
  set_uniform(program, "to_turn", motion.to.turn);
  set_uniform(program, "to_shift", motion.to.shift);
  set_uniform(program, "from_turn", motion.from.turn);
  set_uniform(program, "from_shift", motion.from.shift);
  set_uniform(program, "pixel",
              glm::vec2{2.0f / static_cast<float>(width), 2.0f / static_cast<float>(height)});
  set_uniform(program, "half_size_px", motion.half_size_px);
  set_uniform(program, "near_m", motion.near_m);
  set_uniform(program, "background_m", motion.background_m);
  set_texture(program, "source", 0, picture);
  draw_fullscreen(target, program);
  return target;
}

const GlTarget& motion_blur_on_gl(EffectPasses& passes, const MotionBlurSettings& settings,
                                  const GlMovingPicture& of) {
  passes.begin();
  const MotionBlurPass pass = pass_of(settings);
  const bool two_ways = pass.filter == MotionFilter::two_ways;
  const GlTarget& spread = passes.target(of.width, of.height);
  const GlProgram& to_either_side = passes.program("motion_spread.frag");
  set_uniform(to_either_side, "to_half", pass.to_half);
  set_uniform(to_either_side, "most", static_cast<float>(pass.radius_px));
  set_texture(to_either_side, "velocity", 0, of.velocity);
  passes.draw(spread, to_either_side);

  const int size = pass.radius_px;
  const GlTarget& tiles =
      passes.target((of.width + size - 1) / size, (of.height + size - 1) / size);
  const GlProgram& longest = passes.program("motion_tiles.frag");
  set_uniform(longest, "tile_size", size);
  set_texture(longest, "spread", 0, spread.colour[0]);
  passes.draw(tiles, longest);

  const GlTarget& neighbours = passes.target(tiles.width, tiles.height);
  const GlProgram& of_neighbours = passes.program("motion_neighbours.frag");
  set_uniform(of_neighbours, "two_ways", two_ways ? 1 : 0);
  set_texture(of_neighbours, "tiles", 0, tiles.colour[0]);
  passes.draw(neighbours, of_neighbours);

  const GlTarget& result = passes.target(of.width, of.height);
  const GlProgram& blur = passes.program("motion_blur.frag", two_ways ? "#define TWO_WAYS\n" : "");
  set_uniform(blur, "samples", pass.samples);
  set_uniform(blur, "way_step", pass.step);
  set_uniform(blur, "tile_size", size);
  set_uniform(blur, "inverse_depth", pass.inverse_depth);
  if (two_ways) {
    set_uniform(blur, "sample_part", pass.sample_part);
    set_uniform(blur, "across_samples", pass.across_samples);
    set_uniform(blur, "across_part", pass.across_part);
    set_uniform(blur, "across_step", pass.across_step);
  }
  set_texture(blur, "source", 0, of.picture);
  set_texture(blur, "spread", 1, spread.colour[0]);
  set_texture(blur, "tiles", 2, neighbours.colour[0]);
  passes.draw(result, blur);
  return result;
}

const GlTarget& motion_blur_along_own_on_gl(EffectPasses& passes, float shutter, int samples,
                                            const GlMovingPicture& of) {
  passes.begin();
  const GlTarget& result = passes.target(of.width, of.height);
  const GlProgram& blur = passes.program("motion_own.frag");
  set_uniform(blur, "samples", samples);
  set_uniform(blur, "way_step", 2.0f / static_cast<float>(samples));
  set_uniform(blur, "to_half", 0.5f * shutter);
  set_texture(blur, "source", 0, of.picture);
  set_texture(blur, "velocity", 1, of.velocity);
  passes.draw(result, blur);
  return result;
}

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
