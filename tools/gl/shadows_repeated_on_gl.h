#pragma once
// Projected shadows that a GL driver draws again and again in this process: what `shadows --vs`
// times. Uploads, links and allocates when it is made.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scenes/shadows/shadow_mask.h"
#include "tools/gl/driver/driver.h"

namespace softfocus {

class ShadowsRepeatedOnGl {
 public:
  /// Opens the driver; Mesa's get that number of threads. Throws DriverError.
  ShadowsRepeatedOnGl(const Driver& driver, const MaskDraws& draws, int lights, int width,
                      int height, int threads);
  ~ShadowsRepeatedOnGl();

  /// GL_RENDERER and GL_VERSION.
  std::string renderer() const;

  void draw();  ///< returns when all is done: glFinish
  std::vector<std::uint8_t> mask(std::span<const std::uint8_t> dark) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace softfocus
