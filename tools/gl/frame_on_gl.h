#pragma once
// A frame rendered by a GL driver in this process: what `render --gl` does.

#include <memory>
#include <string>
#include <vector>

#include "dof/dof.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/scene.h"
#include "tools/gl/driver/driver.h"
#include "tools/gl/shaders.h"

namespace softfocus {

class FrameOnGl {
 public:
  /// Opens the driver; throws DriverError.
  FrameOnGl(const Driver& driver, Shaders shaders);
  ~FrameOnGl();

  /// GL_RENDERER and GL_VERSION.
  std::string renderer() const;

  /// As draw_scene(): RGBA16F, depth in alpha.
  Image draw(const Scene& scene, const CameraMatrices& view, double frame, int width, int height);

  /// As softfocus::draw_layers().
  std::vector<Image> draw_layers(const Scene& scene, const CameraMatrices& view, double frame,
                                 int width, int height, std::size_t layers);

  /// As the method's apply(). Throws DriverError for a method that has no shader.
  Image filter(const Method& method, const DofSettings& settings, const Image& scene);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace softfocus
