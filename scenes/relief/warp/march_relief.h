#pragma once
// A relief seen without a pre-warp: each pixel's ray is followed into the relief until it meets the
// surface. The inverse of the pre-warp (6-1 of Clua 2004) says where the ray is at depth d:
//
//   u = u' (1 + k3 d) - k1 d = u' + d (u' k3 - k1)      v likewise
//
// Slices (6.5 of Clua 2004, of a relief on a polygon): d goes up in equal steps, until the ray is
// behind the surface of the texel there, whose colour the pixel gets. Bisection looks on between
// that slice and the one before (relief mapping, Policarpo, Oliveira and Comba 2005).
//
// Marching needs no order and no memory, and finds both sides of a step of depth. But it takes
// `slices` looks a pixel, and can fall through a steep surface between two slices.

#include <cstdint>

#include "raster/images/image.h"
#include "raster/threads/parallel.h"
#include "scenes/relief/warp/map_relief.h"

namespace softfocus {

struct MarchSettings {
  int slices = 64;     ///< 1 to kMostSlices
  int bisections = 0;  ///< 0 to kMostBisections; 0: slices alone
  /// Whether a ray can pass behind a texel and meet another. If not, it shows nothing: other faces
  /// of a box show what is there.
  bool passes_behind = true;
};
inline constexpr int kMostSlices = 4096;
inline constexpr int kMostBisections = 16;

/// The colour of a texel that stops rays and shows nothing.
inline constexpr std::uint32_t kStopsRays = 1;

/// The places where a camera's rays meet the plane, in the relief's own texels.
struct MarchMapping {
  PlaneMapping mapping;
  PreWarp warp;
};
/// Its area holds nothing if the eye does not see the relief's front.
MarchMapping march_mapping(const ReliefTexture& relief, const ReliefExtent& extent,
                           const CameraMatrices& camera, int width, int height);

/// Pixels, depths and the comparison with the picture's are map_relief()'s, but each pixel shows
/// one texel.
void march_relief(const ReliefTexture& relief, const MarchMapping& mapping,
                  const MarchSettings& settings, Image& picture, ThreadPool& pool);

}  // namespace softfocus
