#include "tools/gl/shadows_repeated_on_gl.h"

#include "tools/gl/shadows_on_gl.h"

namespace softfocus {

struct ShadowsRepeatedOnGl::State {
  const Driver& driver;
  GlContext context;
  GlShadows shadows;
};

ShadowsRepeatedOnGl::ShadowsRepeatedOnGl(const Driver& driver, const MaskDraws& draws, int lights,
                                         int width, int height, int threads) {
  naming(driver, [&] {
    state_.reset(new State{driver, GlContext{driver, threads}, {}});
    state_->shadows = make_gl_shadows(state_->context, Shaders{}, draws, lights, width, height);
  });
}

ShadowsRepeatedOnGl::~ShadowsRepeatedOnGl() = default;

std::string ShadowsRepeatedOnGl::renderer() const {
  return state_->context.renderer() + ", OpenGL " + state_->context.version();
}

void ShadowsRepeatedOnGl::draw() {
  softfocus::draw(state_->shadows);
  glFinish();
}

std::vector<std::uint8_t> ShadowsRepeatedOnGl::mask(std::span<const std::uint8_t> dark) const {
  return naming(state_->driver, [&] { return read_mask(state_->shadows, dark); });
}

}  // namespace softfocus
