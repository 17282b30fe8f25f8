#pragma once
// Effects that a GL driver runs again and again on one picture: what `bench --effect --vs` times.

#include <memory>
#include <string>
#include <vector>

#include "raster/effects/effect.h"
#include "raster/images/image.h"
#include "raster/temporal/frame_passes.h"
#include "tools/gl/driver/driver.h"

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
  /// The passes of a frame that is made from those before, in place of an effect.
  void choose(const FrameEffect& effect, const FrameSources& sources);
  /// Returns when it is done: glFinish. Each pass is a triangle, or a quad of two.
  void run(bool as_quad);
  /// The last run()'s picture, and for some effects the number of frames that each pixel is made
  /// of.
  std::vector<Image> pictures() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace softfocus
