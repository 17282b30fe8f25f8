#include "tools/gl/filter_on_gl.h"

#include <array>

#include "dof/one_pass.h"
#include "dof/weights.h"

namespace softfocus {
namespace {

void set_settings(const GlProgram& program, const DofSettings& settings) {
  set_uniform(program, "radius_at_infinity_px", settings.coc.radius_at_infinity_px);
  set_uniform(program, "focus_m", settings.coc.focus_m);
  set_uniform(program, "max_coc_px", settings.max_coc_px);
  set_uniform(program, "leak", settings.leak);
}

GlTarget make_filter_target(int width, int height) {
  return make_target(std::array{Format::rgba16f}, width, height, false);
}

GlTarget two_pass_on_gl(const GlContext& context, const Shaders& shaders,
                        const DofSettings& settings, const GlTexture& scene, int width,
                        int height) {
  const GlProgram program = link_program(context, shaders, "fullscreen.vert", "two_pass.frag");
  set_settings(program, settings);
  set_uniform(program, "taps", tap_count(settings.max_coc_px));

  const GlTarget between = make_filter_target(width, height);
  set_texture(program, "source", 0, scene);
  set_uniform(program, "direction", glm::ivec2{1, 0});
  draw_fullscreen(between, program);

  GlTarget result = make_filter_target(width, height);
  set_texture(program, "source", 0, between.colour[0]);
  set_uniform(program, "direction", glm::ivec2{0, 1});
  draw_fullscreen(result, program);
  return result;
}

// The taps as a texture of whole rows, the last one filled up with zeros.
Image ring_tap_image(const std::vector<RingTap>& taps) {
  constexpr int kColumns = 256;
  const int count = static_cast<int>(taps.size());
  Image image = make_image(Format::rgba32f, kColumns, count / kColumns + 1);
  for (int i = 0; i < count; ++i) {
    const RingTap& tap = taps[static_cast<std::size_t>(i)];
    float* texel = &row<float>(image, i / kColumns)[static_cast<std::size_t>(i % kColumns * 4)];
    texel[0] = static_cast<float>(tap.dx);
    texel[1] = static_cast<float>(tap.dy);
    texel[2] = tap.distance_px;
  }
  return image;
}

GlTarget one_pass_on_gl(const GlContext& context, const Shaders& shaders,
                        const DofSettings& settings, const GlTexture& scene, int width,
                        int height) {
  const std::vector<RingTap> taps = ring_taps(settings.max_coc_px);
  const GlProgram program = link_program(context, shaders, "fullscreen.vert", "one_pass.frag");
  const GlTexture tap_texture = upload(ring_tap_image(taps));
  set_settings(program, settings);
  set_texture(program, "source", 0, scene);
  set_texture(program, "ring_taps", 1, tap_texture);
  set_uniform(program, "taps", static_cast<int>(taps.size()));
  GlTarget result = make_filter_target(width, height);
  draw_fullscreen(result, program);
  return result;
}

}  // namespace

bool has_shader(std::string_view method) { return method == "two-pass" || method == "one-pass"; }

GlTarget filter_on_gl(const GlContext& context, const Shaders& shaders, std::string_view method,
                      const DofSettings& settings, const GlTexture& scene, int width, int height) {
  if (method == "two-pass") {
    return two_pass_on_gl(context, shaders, settings, scene, width, height);
  }
  if (method == "one-pass") {
    return one_pass_on_gl(context, shaders, settings, scene, width, height);
  }
  throw DriverError("the method " + std::string(method) + " has no shader");
}

}  // namespace softfocus
