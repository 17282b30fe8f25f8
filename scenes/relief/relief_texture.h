#pragma once
// A relief texture: colour, depth and perhaps normals of an object under an orthographic or a
// perspective camera (Oliveira, Bishop and McAllister 2000). A texel of depth d shows the point
//
//   orthographic   X = C + u a + v b + d f        u, v: whole numbers at the texels' centres
//   perspective    X = S + (C + u a + v b - S) / (1 - d / n)
//
// S is a perspective camera's eye, n its distance from the plane. A point that lies z behind the
// plane has d = z under an orthographic camera, and d = n z / (n + z) under a perspective one: n
// times its generalised disparity (McMillan 1997). With this d the pre-warp of both is one equation
// (pre_warp.h), codes are even in a depth buffer's numbers, and a plane in space is a plane over
// the texture.
//
// Depths are codes, evenly spaced from 0, the plane of C, to the last one but one; the last code,
// 255 of 8 bits and 65535 of 16, is a texel that shows nothing.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "raster/numbers/vector_math.h"

namespace softfocus {

// A relief's colours and normals as they are stored.

/// Three halves of linear light; `codes` has linear_to_srgb8() of each half.
inline std::uint32_t packed_colour(const std::uint16_t* texel,
                                   const std::vector<std::uint8_t>& codes) {
  return std::uint32_t{codes[texel[0]]} | std::uint32_t{codes[texel[1]]} << 8 |
         std::uint32_t{codes[texel[2]]} << 16 | 0xFF000000u;
}

/// Of any length above 0.
inline std::uint32_t packed_normal(glm::vec3 normal) {
  const glm::vec3 unit = normalize(normal);
  const auto byte = [](float v) {
    return static_cast<std::uint32_t>(std::lrint(127.0f * v + 128.0f));
  };
  return byte(unit.x) | byte(unit.y) << 8 | byte(unit.z) << 16;
}

struct ReliefCamera {
  glm::dvec3 origin{0.0};        ///< C: the centre of the first texel, where the depth is 0
  glm::dvec3 a{1.0, 0.0, 0.0};   ///< from a texel to its right neighbour
  glm::dvec3 b{0.0, -1.0, 0.0};  ///< and to the one below; a, b and f are perpendicular
  glm::dvec3 f{0.0, 0.0, -1.0};  ///< away from the viewer, of length 1
  double depth_m = 1.0;          ///< what last_depth() stands for
  /// S of a perspective camera, before the plane; depth_m is below its distance n from the plane.
  /// None: the camera is orthographic.
  std::optional<glm::dvec3> eye = {};
};

inline constexpr int kMostReliefSize = 4096;

/// How an unlit texel answers light (light_relief.h).
struct ReliefMaterial {
  glm::vec3 ambient;  ///< a share of the unlit colour, for the scene's ambient light
  glm::vec3 specular;
  int shininess;
  bool lit;  ///< false: the unlit colour as it is
};
inline constexpr std::size_t kMostReliefMaterials = 256;

struct ReliefTexture {
  int width = 0, height = 0;  ///< 1 to kMostReliefSize
  int depth_bits = 8;         ///< or 16
  ReliefCamera camera;
  std::vector<std::uint16_t> depths;  ///< codes, row by row
  /// Red + 256 green + 65536 blue in the sRGB curve + 255 2^24; 0 of an empty texel.
  std::vector<std::uint32_t> colours;
  /// Of the world: x + 256 y + 65536 z, each 127 n + 128 rounded, and of an unlit relief + 2^24
  /// times the material's number. Empty if there are none.
  std::vector<std::uint32_t> normals;
  /// If light can be laid on it anew: as `colours`, the diffuse colour times the texture. Else
  /// empty, and so are the materials.
  std::vector<std::uint32_t> unlit;
  std::vector<ReliefMaterial> materials;
};

constexpr std::uint16_t empty_depth(int bits) { return bits == 8 ? 255 : 65535; }
constexpr int last_depth(int bits) { return bits == 8 ? 254 : 65534; }

/// Metres a code.
inline double depth_step(const ReliefTexture& relief) {
  return relief.camera.depth_m / last_depth(relief.depth_bits);
}

/// n, or infinity: how far a perspective camera's eye is from the plane.
double source_distance(const ReliefCamera& camera);

/// The point that a place of the texture shows at a depth, d in metres.
glm::dvec3 point_at_depth(const ReliefCamera& camera, double u, double v, double depth_m);

/// The point that a texel shows.
glm::dvec3 relief_point(const ReliefTexture& relief, double u, double v, double code);

/// Which texels show something.
struct ReliefExtent {
  int x_begin, x_end, y_begin, y_end;
  int least_code, most_code;
  std::int64_t filled;
};

/// None if all texels are empty.
std::optional<ReliefExtent> relief_extent(const ReliefTexture& relief);

// A relief at half its resolution, and again: the levels of a relief that was drawn finer than it
// is seen now (4.1.1 of Clua 2004). A warp takes the coarsest whose texels are no wider than
// pixels, and so wastes no work.

/// Half as many texels each way, rounded up. If at least two of four texels show something, the new
/// texel has the depth and the normal of the nearest, as an outline is the nearer surface's, and
/// the mean of the colours of those whose depths are within kSameSurface of it. Needs more than a
/// texel each way.
ReliefTexture coarser_relief(const ReliefTexture& relief);

/// Of all depths.
inline constexpr double kSameSurface = 1.0 / 16.0;

}  // namespace softfocus
