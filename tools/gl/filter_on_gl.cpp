#include "tools/gl/filter_on_gl.h"

#include <array>

#include "dof/one_pass/one_pass.h"
#include "dof/weights.h"

namespace softfocus {
namespace {

void set_settings(const GlProgram& program, const DofSettings& settings) {
  set_uniform(program, "radius_at_infinity_px", settings.coc.radius_at_infinity_px);
  set_uniform(program, "focus_m", settings.coc.focus_m);
  set_uniform(program, "max_coc_px", settings.max_coc_px);
  set_uniform(program, "leak", settings.leak);
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

}  // namespace

bool has_shader(std::string_view method) { return method == "two-pass" || method == "one-pass"; }

GlFilter make_filter(const GlContext& context, const Shaders& shaders, std::string_view method,
                     const DofSettings& settings, int width, int height) {
  if (!has_shader(method)) {
    throw DriverError("the method " + std::string(method) + " has no shader");
  }
  const bool rings = method == "one-pass";
  GlFilter filter;
  filter.program =
      link_program(context, shaders, "fullscreen.vert", rings ? "one_pass.frag" : "two_pass.frag");
  set_settings(filter.program, settings);
  int taps = tap_count(settings.max_coc_px);
  if (rings) {
    const std::vector<RingTap> ring = ring_taps(settings.max_coc_px);
    filter.ring_taps = upload(ring_tap_image(ring));
    taps = static_cast<int>(ring.size());
  }
  set_uniform(filter.program, "taps", taps);
  for (int pass = 0; pass < (rings ? 1 : 2); ++pass) {
    filter.targets.push_back(make_target(std::array{Format::rgba16f}, width, height, false));
  }
  return filter;
}

void run_filter(const GlFilter& filter, const GlTexture& scene) {
  const GlTexture* source = &scene;
  if (filter.ring_taps != 0) set_texture(filter.program, "ring_taps", 1, filter.ring_taps);
  glm::ivec2 direction{1, 0};  // of two-pass; one-pass has none
  for (const GlTarget& target : filter.targets) {
    set_texture(filter.program, "source", 0, *source);
    set_uniform(filter.program, "direction", direction);
    draw_fullscreen(target, filter.program);
    source = &target.colour[0];
    direction = {0, 1};
  }
}

GlTarget filter_on_gl(const GlContext& context, const Shaders& shaders, std::string_view method,
                      const DofSettings& settings, const GlTexture& scene, int width, int height) {
  GlFilter filter = make_filter(context, shaders, method, settings, width, height);
  run_filter(filter, scene);
  return std::move(filter.targets.back());
}

}  // namespace softfocus
