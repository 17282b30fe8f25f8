#pragma once
// A frame that a GL driver draws and filters again and again in this process: what
// `bench --vs` times. Uploads, links and allocates when it is made, and reads back only when
// asked for the picture.

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "raster/effects/effect.h"
#include "raster/images/image.h"
#include "raster/temporal/frame_passes.h"
#include "tools/bench/work.h"
#include "tools/gl/driver/driver.h"

namespace softfocus {

class RepeatedOnGl {
 public:
  /// Opens the driver; Mesa's get that number of threads. `work` must outlive it. Throws
  /// DriverError, also for a method without a shader.
  RepeatedOnGl(const Driver& driver, const BenchWork& work, int threads);
  ~RepeatedOnGl();

  /// GL_RENDERER and GL_VERSION.
  std::string renderer() const;

  void draw();    ///< the scene; needs one
  void finish();  ///< waits until all of it is done: glFinish

  /// The forms that the method's shader has on drivers (tools/gl/filter_on_gl.h): "brute-force" and
  /// "tiled". None for the pinhole method, which filters nothing.
  std::vector<std::string> forms() const;

  /// Filters what was drawn, or the work's picture.
  void filter(std::size_t form);

  /// As filter(), but what was drawn is first copied into a texture, and each pass's picture before
  /// the next one reads it. Needs a scene.
  void copy_and_filter(std::size_t form);

  /// The last filter()'s picture by that form. Without forms: the drawn picture, or the work's.
  Image picture(std::size_t form) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Effects that a GL driver runs again and again on one picture: what `bench --effect --vs` times.

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
