#pragma once
// Martin Newell's teapot (University of Utah, 1975): 32 bicubic Bezier patches.

#include "scenes/scene.h"

namespace softfocus {

/// The teapot, `height` > 0 metres from its foot at y = 0 to the top of the lid's knob,
/// about the y axis, the spout towards +x. Each patch is cut into divisions x divisions
/// cells, divisions >= 2: 64 divisions^2 - 8 divisions triangles.
///
/// As Newell made it, the surface is open: there is a gap between lid and rim, and
/// handle and spout end inside the body. Draw it two-sided. The patches of a part that
/// meet share their edges to the bit.
Mesh make_teapot(double height, int divisions);

}  // namespace softfocus
