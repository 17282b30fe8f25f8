#pragma once
// A full-screen pass: a function of the pixel, run for every pixel of a target. On a GPU, a
// full-screen triangle and a fragment shader.

#include <algorithm>
#include <cassert>
#include <glm/vec4.hpp>

#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// Rows that one thread takes at a time.
inline constexpr int kPassRows = 8;

/// Stores kernel(x, y), a glm::vec4, at every pixel of `target` with the profile's
/// rounding. The kernel is called from several threads at once, once a pixel, and
/// must not read the target.
template <Format format, class Kernel>
void fullscreen_pass(const ImageView& target, const Profile& profile, ThreadPool& pool,
                     const Kernel& kernel) {
  assert(target.format == format);
  pool.for_each((target.height + kPassRows - 1) / kPassRows, [&](int band) {
    const int end = std::min((band + 1) * kPassRows, target.height);
    for (int y = band * kPassRows; y < end; ++y) {
      for (int x = 0; x < target.width; ++x) {
        store_texel<format>(target, x, y, kernel(x, y), profile);
      }
    }
  });
}

}  // namespace softfocus
