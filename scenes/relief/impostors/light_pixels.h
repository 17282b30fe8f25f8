#pragma once
// Light on the pixels that show a relief (6.4 of Clua 2004), where light_relief() lights its texels
// before they are warped. The unlit colours and the normals are warped and mapped alike; a pixel's
// point is where its depth says. So an impostor can be lit anew without a new warp, and what is not
// seen is not lit, and no colour is cut to 1; but two planes are warped and mapped, normals between
// two texels are means, and a relief has one material.

#include <cstdint>
#include <vector>

#include "scenes/relief/light_relief.h"
#include "scenes/relief/warp/map_relief.h"

namespace softfocus {

/// The lights, and memory that is kept from picture to picture.
struct PixelLights {
  const ReliefLights* lights;
  Image unlit{}, normals{};
};

/// An unlit relief's normals, to be warped in place of its colours.
std::vector<std::uint32_t> normals_as_colours(const ReliefTexture& relief);

/// A relief's planes, warped to one place.
struct WarpedPlanes {
  const WarpedRelief& unlit;
  const WarpedRelief& normals;
};

/// As map_relief() of the relief, lit. In binary32, of the unlit colour as map_relief() has it, and
/// the means n of the normals' bytes:
///
///   point  = eye + ray depth            the ray in binary64, rounded once a pixel
///   normal = normalize(n - 128)
///   colour = base unlit + specular      of light_point() with the diffuse colour 1
void draw_lit_pixels(const ReliefTexture& relief, const WarpedPlanes& warped,
                     const PlaneMapping& mapping, const CameraMatrices& camera, PixelLights& lights,
                     Image& picture, ThreadPool& pool);

}  // namespace softfocus
