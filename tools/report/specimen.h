#pragma once
// A small fixed pair of pictures to try measures on: what they give for it goes into the key of
// what is kept, so that a changed measure is noticed.

#include <string_view>

#include "raster/images/image.h"
#include "raster/numbers/hash.h"

namespace softfocus {

/// RGBA16F, depth in alpha, of one size.
struct SpecimenPair {
  Image truth;
  Image picture;  ///< with_wrong_pixels() of it
};

/// Stripes, lights of up to 8 and three depths. Whole numbers and their quotients alone: no
/// function that a library computes in its own way.
SpecimenPair specimen_pair();

/// RGBA16F: every fifth pixel's light is changed, and a corner is wrong.
Image with_wrong_pixels(const Image& picture);

/// Adds a measure's number.
void add_number(Hash& hash, double number);
void add_text(Hash& hash, std::string_view text);

}  // namespace softfocus
