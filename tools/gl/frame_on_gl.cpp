#include "tools/gl/frame_on_gl.h"

#include "tools/gl/filter_on_gl.h"
#include "tools/gl/scene_on_gl.h"

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

}  // namespace softfocus
