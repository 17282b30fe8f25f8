#include "tools/bench/effects_repeated_on_gl.h"

#include <array>
#include <optional>

#include "tools/gl/effects_on_gl.h"

namespace softfocus {

struct EffectsRepeatedOnGl::State {
  const Driver& driver;
  GlContext context;
  Shaders shaders{};
  int width, height;
  GlTexture picture{};
  std::optional<GlTexture> velocity{};
  std::array<std::optional<EffectPasses>, 2> passes{};  // of triangles, of quads
  const ChosenEffect* effect = nullptr;
  const GlTarget* result = nullptr;
};

EffectsRepeatedOnGl::EffectsRepeatedOnGl(const Driver& driver, const Image& picture, int threads) {
  naming(driver, [&] {
    state_.reset(new State{.driver = driver,
                           .context = GlContext{driver, threads},
                           .width = picture.width,
                           .height = picture.height});
    state_->picture = upload(picture);
  });
}

EffectsRepeatedOnGl::~EffectsRepeatedOnGl() = default;

std::string EffectsRepeatedOnGl::renderer() const {
  return state_->context.renderer() + ", OpenGL " + state_->context.version();
}

void EffectsRepeatedOnGl::choose(const ChosenEffect& effect, const Image* velocity) {
  state_->effect = &effect;
  state_->velocity.reset();
  if (velocity != nullptr) {
    naming(state_->driver, [&] { state_->velocity = upload(*velocity); });
  }
  for (std::optional<EffectPasses>& passes : state_->passes) {
    passes.emplace(state_->context, state_->shaders);
  }
  state_->passes[1]->draw_quads(true);
  run(true);
  run(false);
}

void EffectsRepeatedOnGl::run(bool as_quad) {
  naming(state_->driver, [&] {
    State& state = *state_;
    state.result = &effect_on_gl(
        *state.passes[as_quad ? 1 : 0], *state.effect->effect, state.effect->parameters,
        {state.picture, state.width, state.height}, state.velocity ? &*state.velocity : nullptr);
    glFinish();
  });
}

Image EffectsRepeatedOnGl::picture() const {
  return naming(state_->driver, [&] { return read_colour(*state_->result, 0); });
}

}  // namespace softfocus
