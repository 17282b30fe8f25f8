#pragma once
// Effects that a GL driver runs again and again on one picture: what `bench --effect --vs` times.

#include <memory>
#include <string>

#include "raster/effects/effect.h"
#include "raster/images/image.h"
#include "tools/gl/driver.h"

namespace softfocus {

class EffectsRepeatedOnGl {
 public:
  /// Opens the driver; Mesa's get that number of threads. Throws DriverError.
  EffectsRepeatedOnGl(const Driver& driver, const Image& picture, int threads);
  ~EffectsRepeatedOnGl();

  /// GL_RENDERER and GL_VERSION.
  std::string renderer() const;

  /// Chooses what run() does: links and makes what it needs. Throws DriverError for an effect
  /// without a shader. The velocity is RG16F of the picture's size, or null if it reads none.
  void choose(const ChosenEffect& effect, const Image* velocity);
  /// Returns when it is done: glFinish. Each pass is a triangle, or a quad of two.
  void run(bool as_quad);
  Image picture() const;  ///< that the last run() made

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace softfocus
