#pragma once
// Light that a camera clipped: white that was a lamp is raised before the filter, so that it shows
// as a disc, and lowered by the same curve afterwards, so that what is sharp stays as it was.

#include "tools/pictures/picture_file.h"

namespace softfocus {

/// With the luminance L = .2126 R + .7152 G + .0722 B in linear light, of the colour without its
/// opacity, colours are multiplied by L' / L,
///
///   L' = L + (gain - 1) max(L - threshold, 0)
///
/// It rises with L, and so has an inverse.
struct HighlightCurve {
  double gain = 1.0;       ///< 1 or more
  double threshold = 1.0;  ///< 0 or more
};

/// GAIN,THRESHOLD. Throws UsageError.
HighlightCurve parse_highlights(const std::string& text);

/// `opacity` is empty or has a number a pixel, by which the colours are multiplied.
void raise_highlights(const HighlightCurve& highlights, const PlaneValues& opacity, Image& picture);
void lower_highlights(const HighlightCurve& highlights, const PlaneValues& opacity, Image& picture);

}  // namespace softfocus
