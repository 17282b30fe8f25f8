#pragma once
// A frame that a GL driver draws and filters again and again in this process: what
// `bench --vs` times. Uploads, links and allocates when it is made, and reads back only when
// asked for the picture.

#include <memory>
#include <string>

#include "raster/images/image.h"
#include "tools/bench/work.h"
#include "tools/gl/driver.h"

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
  void filter();  ///< what was drawn, or the work's picture; nothing for the pinhole method
  void finish();  ///< waits until all of it is done: glFinish

  /// What the last filter() made.
  Image picture() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace softfocus
