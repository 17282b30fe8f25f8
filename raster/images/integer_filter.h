#pragma once
// The standard texture unit's filter in integers, of linear bytes and of halves: 8-bit weights,
// no rounding but the last. integer_bilinear.h has the sums.

#include <glm/vec4.hpp>

#include "raster/images/image.h"
#include "raster/images/integer_bilinear.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// Whether textures of this format are filtered so. sRGB bytes are not, for they are decoded
/// before they are filtered, nor are texels of 32 bits.
bool has_integer_filter(Format format, const Profile& profile);

/// Where a bilinear fetch reads; `level` of r8, rgba8 or rgba16f.
struct IntegerFetch {
  const Image* level;
  IntegerTaps u, v;
};

/// fine + next_weight / 256 (coarse - fine), next_weight 0 to 256; with 0 `coarse` is not read.
///
/// Bytes: the sum S in 2^-24 of 255 is exact in 32 bits; the result is S rounded to binary32 (a
/// single level's needs no rounding), and divided by 255 2^24: four equal texels give what
/// a nearest fetch gives. Halves: the sum in 2^-48 is exact and rounded once to binary32.
/// A channel in which one of the four texels is infinite or NaN, or of the eight where
/// next_weight is above 0, whatever it weighs, is filtered in floats, with the profile's lerp.
glm::vec4 filter_in_integers(const IntegerFetch& fine, const IntegerFetch& coarse, int next_weight,
                             const Profile& profile);

}  // namespace softfocus
