#include "tools/bench/repeated_on_gl.h"

#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <optional>
#include <utility>

#include "tools/gl/effects_on_gl.h"
#include "tools/gl/filter_on_gl.h"
#include "tools/gl/pipeline_on_gl.h"
#include "tools/gl/scene_on_gl.h"
#include "tools/gl/temporal_on_gl.h"

namespace softfocus {

struct RepeatedOnGl::State {
  const Driver& driver;
  const BenchWork& work;
  GlContext context;
  Shaders shaders{};
  std::optional<GlScene> scene{};  // with `drawn`
  GlTarget drawn{};
  GlTarget copy{};                         // what copy_and_filter() reads
  GlTexture uploaded{};                    // else
  std::vector<GlFilter> forms{};           // as in kFilterForms; none: nothing is filtered
  std::optional<PipelineOnGl> pipeline{};  // in place of them
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
    if (const Pipeline* pipeline = work.method.filter->pipeline) {
      // What it reads of the picture besides is the emulation's.
      ThreadPool pool{threads};
      const Image picture =
          work.scene ? draw_scene(*work.scene, work.view, work.frame, width, height, {}, pool)
                     : work.picture;
      if (pipeline->by_codes) {
        throw DriverError(pipeline->name +
                          ": its texels are sRGB codes; for bench --vs texels = "
                          "\"linear\" would be right");
      }
      state.pipeline.emplace(state.context, *pipeline, DofInput{picture, work.settings, {}});
      return;
    }
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
  if (state_->pipeline) names.emplace_back("its GLSL");
  for (std::size_t i = 0; i < state_->forms.size(); ++i) {
    names.emplace_back(form_name(kFilterForms[i]));
  }
  return names;
}

void RepeatedOnGl::filter(std::size_t form) {
  naming(state_->driver, [&] {
    const GlTexture& picture = state_->work.scene ? state_->drawn.colour[0] : state_->uploaded;
    if (state_->pipeline) return state_->pipeline->run(picture);
    run_filter(state_->forms[form], picture);
  });
}

void RepeatedOnGl::copy_and_filter(std::size_t form) {
  naming(state_->driver, [&] {
    const GlTexture& copy = state_->copy.colour[0];
    copy_colour(state_->drawn, copy);
    if (state_->pipeline) return state_->pipeline->run(copy);
    run_filter(state_->forms[form], copy, &copy);
  });
}

namespace {

/// A pipeline's result has the picture's depth, whatever it wrote.
Image with_depths(const GlTarget& result, const Image& picture) {
  Image read = read_colour(result, 0);
  if (read.format != picture.format || read.width != picture.width ||
      read.height != picture.height) {
    return read;
  }
  for (int y = 0; y < read.height; ++y) {
    const auto to = row<std::uint16_t>(read, y);
    const auto from = row<std::uint16_t>(picture, y);
    for (std::size_t i = 3; i < to.size(); i += 4) to[i] = from[i];
  }
  return read;
}

}  // namespace

Image RepeatedOnGl::picture(std::size_t form) const {
  return naming(state_->driver, [&] {
    if (state_->pipeline)
      return with_depths(state_->pipeline->result(),
                         state_->work.scene ? read_colour(state_->drawn, 0) : state_->work.picture);
    if (!state_->forms.empty()) return read_colour(state_->forms[form].targets.back(), 0);
    return state_->work.scene ? read_colour(state_->drawn, 0) : state_->work.picture;
  });
}

namespace {

Image image_of(const ConstImageView& view) {
  Image image = make_image(view.format, view.width, view.height);
  const std::size_t row_bytes = bytes_per_texel(view.format) * static_cast<std::size_t>(view.width);
  const ImageView to = image;
  for (int y = 0; y < view.height; ++y) {
    std::memcpy(to.texels + y * to.stride_bytes, view.texels + y * view.stride_bytes, row_bytes);
  }
  return image;
}

}  // namespace

struct EffectsRepeatedOnGl::State {
  const Driver& driver;
  GlContext context;
  Shaders shaders{};
  int width, height;
  GlTexture picture{};
  std::vector<GlTexture> others{};                      // that the passes read
  std::array<std::optional<EffectPasses>, 2> passes{};  // of triangles, of quads
  std::function<const GlTarget&(EffectPasses&)> make{};
  const GlTarget* result = nullptr;

  void choose(std::function<const GlTarget&(EffectPasses&)> what) {
    make = std::move(what);
    for (std::optional<EffectPasses>& each : passes) each.emplace(context, shaders);
    passes[1]->draw_quads(true);
    for (std::optional<EffectPasses>& each : passes) make(*each);
  }
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
  naming(state_->driver, [&] {
    State& state = *state_;
    state.others.clear();
    if (velocity != nullptr) state.others.push_back(upload(*velocity));
    state.choose([&state, &effect](EffectPasses& passes) -> const GlTarget& {
      return effect_on_gl(passes, *effect.effect, effect.parameters,
                          {state.picture, state.width, state.height},
                          state.others.empty() ? nullptr : &state.others[0]);
    });
  });
}

void EffectsRepeatedOnGl::choose(const FrameEffect& effect, const FrameSources& sources) {
  naming(state_->driver, [&] {
    State& state = *state_;
    state.others.clear();
    for (const ConstImageView& source :
         {sources.drawn, sources.velocity, sources.before, sources.frames}) {
      state.others.push_back(upload(image_of(source)));
    }
    state.choose([&state, effect, turn = sources.turn](EffectPasses& passes) -> const GlTarget& {
      return make_frame_on_gl(passes, effect,
                              {state.others[0], state.others[1], state.others[2], state.others[3],
                               turn, state.width, state.height});
    });
  });
}

void EffectsRepeatedOnGl::run(bool as_quad) {
  naming(state_->driver, [&] {
    state_->result = &state_->make(*state_->passes[as_quad ? 1 : 0]);
    glFinish();
  });
}

std::vector<Image> EffectsRepeatedOnGl::pictures() const {
  return naming(state_->driver, [&] {
    std::vector<Image> read;
    for (std::size_t i = 0; i < state_->result->colour.size(); ++i) {
      read.push_back(read_colour(*state_->result, i));
    }
    return read;
  });
}

}  // namespace softfocus
