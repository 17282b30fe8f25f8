#include "tools/gl/frame_on_gl.h"

#include "tools/gl/filter_on_gl.h"
#include "tools/gl/scene_on_gl.h"
#include "tools/gl/shadows_on_gl.h"

namespace softfocus {

struct FrameOnGl::State {
  const Driver& driver;
  GlContext context;
  Shaders shaders;
};

FrameOnGl::FrameOnGl(const Driver& driver, Shaders shaders) {
  naming(driver, [&] { state_.reset(new State{driver, GlContext{driver}, std::move(shaders)}); });
}

FrameOnGl::~FrameOnGl() = default;

std::string FrameOnGl::renderer() const {
  return state_->context.renderer() + ", OpenGL " + state_->context.version();
}

Image FrameOnGl::draw(const Scene& scene, const CameraMatrices& view, double frame, int width,
                      int height) {
  return naming(state_->driver, [&] {
    GlScene on_gl{state_->context, state_->shaders, scene};
    const GlTarget target = make_scene_target(width, height);
    on_gl.draw(view, frame, target);
    return read_colour(target, 0);
  });
}

std::vector<Image> FrameOnGl::draw_layers(const Scene& scene, const CameraMatrices& view,
                                          double frame, int width, int height, std::size_t layers) {
  return naming(state_->driver, [&] {
    GlScene on_gl{state_->context, state_->shaders, scene};
    return on_gl.draw_layers(view, frame, width, height, layers);
  });
}

Image FrameOnGl::filter(const Method& method, const DofSettings& settings, const Image& scene) {
  if (method.name == "pinhole") return scene;
  return naming(state_->driver, [&] {
    const GlTarget result = filter_on_gl(state_->context, state_->shaders, method.name, settings,
                                         upload(scene), scene.width, scene.height);
    return read_colour(result, 0);
  });
}

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

struct MapsRepeatedOnGl::State {
  const Driver& driver;
  GlContext context;
  std::vector<GlMap> maps;
};

MapsRepeatedOnGl::MapsRepeatedOnGl(const Driver& driver, std::span<const MapCasters> maps,
                                   int threads) {
  naming(driver, [&] {
    state_.reset(new State{driver, GlContext{driver, threads}, {}});
    for (const MapCasters& map : maps) {
      state_->maps.push_back(make_gl_map(state_->context, Shaders{}, map.settings));
      for (const std::vector<CutCasters>& casters : map.sides) {
        add_side(state_->maps.back(), casters);
      }
    }
  });
}

MapsRepeatedOnGl::~MapsRepeatedOnGl() = default;

std::string MapsRepeatedOnGl::renderer() const {
  return state_->context.renderer() + ", OpenGL " + state_->context.version();
}

void MapsRepeatedOnGl::draw() {
  for (const GlMap& map : state_->maps) softfocus::draw(map);
  glFinish();
}

Image MapsRepeatedOnGl::nearness(std::size_t map, std::size_t side) const {
  return naming(state_->driver,
                [&] { return read_colour(state_->maps[map].sides[side].target, 0); });
}

}  // namespace softfocus
