#include "tools/gl/motion_on_gl.h"

#include <array>

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

}  // namespace softfocus
