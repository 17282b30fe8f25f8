#pragma once
// Pentagonal and hexagonal circles of confusion by blurs along lines, two passes for each
// parallelogram, after McIntosh, Riecke and DiPaola 2012 and White 2011 (polygon_lines.h).
//
// The polygon has its corners on the circle of confusion, one up, and one down before the focus:
// the aperture's image, as of scatter_aperture.h. Fields at half resolution, highlights and the way
// back are those of dof/half_resolution, with polygons as highlights.
//
// The cost grows with the radius, not with its square.
//
// Known failures: those of the fields at half resolution; a thing's size decides on either side of
// its outline. A pentagon's least and most are no sums: they keep the light of lone cells and of
// even surfaces, and only about that of a texture.

#include "dof/dof.h"

namespace softfocus {

/// Two Methods' apply (dof.h).
void pentagonal(const DofInput& input, const ImageView& result, ThreadPool& pool);
void hexagonal(const DofInput& input, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus
