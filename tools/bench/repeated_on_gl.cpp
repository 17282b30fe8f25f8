#include "tools/bench/repeated_on_gl.h"

#include <array>
#include <optional>

#include "tools/gl/filter_on_gl.h"
#include "tools/gl/scene_on_gl.h"

namespace softfocus {

struct RepeatedOnGl::State {
  const Driver& driver;
  const BenchWork& work;
  GlContext context;
  Shaders shaders{};
  std::optional<GlScene> scene{};  // with `drawn`
  GlTarget drawn{};
  GlTarget copy{};                // what copy_and_filter() reads
  GlTexture uploaded{};           // else
  std::vector<GlFilter> forms{};  // as in kFilterForms; none: nothing is filtered
};

RepeatedOnGl::RepeatedOnGl(const Driver& driver, const BenchWork& work, int threads) {
  naming(driver, [&] {
    state_.reset(new State{driver, work, GlContext{driver, threads}});
    State& state = *state_;
    const auto [width, height] = work.size;
    if (work.scene) {
      state.scene.emplace(state.context, state.shaders, *work.scene);
      state.drawn = make_scene_target(width, height);
      if (work.copies) {
        state.copy = make_target(std::array{Format::rgba16f}, width, height, false);
      }
    } else {
      state.uploaded = upload(work.picture);
    }
    if (work.method.name() == "pinhole") return;
    for (const FilterForm form : kFilterForms) {
      state.forms.push_back(make_filter(state.context, state.shaders, work.method.name(), form,
                                        work.settings, width, height));
    }
  });
}

RepeatedOnGl::~RepeatedOnGl() = default;

std::string RepeatedOnGl::renderer() const {
  return state_->context.renderer() + ", OpenGL " + state_->context.version();
}

void RepeatedOnGl::draw() {
  naming(state_->driver,
         [&] { state_->scene->draw(state_->work.view, state_->work.frame, state_->drawn); });
}

void RepeatedOnGl::finish() { glFinish(); }

std::vector<std::string> RepeatedOnGl::forms() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < state_->forms.size(); ++i) {
    names.emplace_back(form_name(kFilterForms[i]));
  }
  return names;
}

void RepeatedOnGl::filter(std::size_t form) {
  naming(state_->driver, [&] {
    run_filter(state_->forms[form],
               state_->work.scene ? state_->drawn.colour[0] : state_->uploaded);
  });
}

void RepeatedOnGl::copy_and_filter(std::size_t form) {
  naming(state_->driver, [&] {
    const GlTexture& copy = state_->copy.colour[0];
    copy_colour(state_->drawn, copy);
    run_filter(state_->forms[form], copy, &copy);
  });
}

Image RepeatedOnGl::picture(std::size_t form) const {
  return naming(state_->driver, [&] {
    if (!state_->forms.empty()) return read_colour(state_->forms[form].targets.back(), 0);
    return state_->work.scene ? read_colour(state_->drawn, 0) : state_->work.picture;
  });
}

}  // namespace softfocus
