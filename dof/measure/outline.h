#pragma once
// How far the outline of what a picture shows lies from where it should.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "raster/images/image.h"

namespace softfocus {

/// Which pixels of an RGBA16F picture show something: 1 where alpha, the depth, is not the
/// background's; row by row.
std::vector<std::uint8_t> coverage_of(const Image& picture, std::uint16_t background_depth);

struct OutlineError {
  double mean_px = 0.0;  ///< wrong pixels a pixel of outline; 0 if nothing is drawn
  double most_px = 0.0;  ///< how deep the deepest wrong pixel lies, up to 31.5
  std::size_t lost = 0;  ///< pixels
  std::size_t gained = 0;
  std::size_t seen = 0;  ///< drawn ones
};

/// Of coverages of width x height pixels.
OutlineError outline_error(const std::vector<std::uint8_t>& drawn,
                           const std::vector<std::uint8_t>& shown, int width, int height);

}  // namespace softfocus
