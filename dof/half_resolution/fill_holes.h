#pragma once
// Fills what is missing in planes from around it, by pull and push (after Gortler et al. 1996,
// The Lumigraph, 3.4): averages by weight into ever coarser planes, and back.
//
//   pull: N = sum n over 2x2, C = sum n c, both divided by N if N > 1
//   push: c = C + (1 - N) (c of the coarser planes, bilinear)
// The last step keeps a cell's own value in full once n is 1/4.

#include <span>

#include "dof/picture_planes.h"

namespace softfocus {

/// Replaces the values of `channels` where the plane `weight`, 0 to 1, is less than 1/4.
void fill_holes(Planes& planes, std::span<const int> channels, int weight, ThreadPool& pool);

}  // namespace softfocus
