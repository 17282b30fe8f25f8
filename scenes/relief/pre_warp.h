#pragma once
// Where the texels of a relief texture move within its plane, so that the plane, seen from a new
// point as an ordinary texture, shows what the relief would (Oliveira, Bishop and McAllister 2000,
// equations 3-1 and 3-2 of Clua 2004):
//
//   u' = (u + k1 d) / (1 + k3 d)      v' = (v + k2 d) / (1 + k3 d)
//   k1 = f.(b x c) / a.(b x c)   k2 = f.(c x a) / b.(c x a)   k3 = f.(a x b) / c.(a x b)
//
// with c = C - eye. As a, b and f are perpendicular here, k3 = 1/(c.f), k1 = e1 k3 and k2 = e2 k3,
// where (e1, e2) = (-c.a/a.a, -c.b/b.b) is the epipole: the eye, dropped onto the plane. So
//
//   u' - e1 = (u - e1) h / (h + d)    h = c.f, the eye's distance from the plane
//
// and every texel moves straight towards the epipole, the farther the deeper it is, and never past
// it. Of two texels at one place the one that started nearer to the epipole is in front. Texels
// that are taken from the borders towards the epipole cover each other rightly: the order that is
// compatible with occlusion.

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "raster/lanes/isa.h"
#include "scenes/relief/relief_texture.h"

namespace softfocus {

/// A view's constants. Depths are in metres.
struct PreWarp {
  float k1 = 0.0f, k2 = 0.0f, k3 = 0.0f;
  float step_m = 0.0f;  ///< of a code
  double epipole_u = 0.0, epipole_v = 0.0;
  double height_m = 0.0;  ///< h
};

/// Needs an eye before the plane of depth 0: sees_front().
PreWarp pre_warp(const ReliefTexture& relief, glm::dvec3 eye);

/// Whether the eye is before the plane of depth 0, by more than `least_share` of the relief's
/// depth: nearer, texels move without bounds.
bool sees_front(const ReliefTexture& relief, glm::dvec3 eye);
inline constexpr double kLeastShareBefore = 1.0 / 64.0;

/// Of a depth: u' = (u + shift_u) scale, v' = (v + shift_v) scale.
struct WarpedDepth {
  float shift_u, shift_v, scale;
};

/// In binary32: d = code step, k1 d, k2 d, 1 / (1 + k3 d).
inline WarpedDepth warped_depth(const PreWarp& warp, float depth_m) {
  return {warp.k1 * depth_m, warp.k2 * depth_m, 1.0f / (1.0f + warp.k3 * depth_m)};
}

/// Of each code: 255 or 65535 of them. Two additions and two multiplications a texel remain.
std::vector<WarpedDepth> warp_table(const PreWarp& warp, int depth_bits);

/// The same in fixed point: shifts and places in 256ths of a texel, scales in 65536ths.
struct FixedDepth {
  std::int32_t shift_u, shift_v, scale;
};
std::vector<FixedDepth> fixed_warp_table(const PreWarp& warp, int depth_bits);

/// A place, 256ths of a texel in and out, to nearest.
constexpr std::int32_t fixed_place(std::int32_t place, std::int32_t shift, std::int32_t scale) {
  return static_cast<std::int32_t>(((std::int64_t{place} + shift) * scale + 32768) >> 16);
}

/// Row `v` of texels: their places. Those of empty texels are finite, and mean nothing. Lanes
/// compute warped_depth() anew, which takes less than a look into a table and gives its bits.
void warp_row(const PreWarp& warp, const std::uint16_t* codes, int width, int v, float* along_u,
              float* along_v, Isa isa);

/// The oracles, in binary64: the equation with the products of vectors as they stand above, and the
/// point's projection onto the plane.
struct WarpedPlace {
  double u, v;
};
WarpedPlace pre_warp_oracle(const ReliefTexture& relief, glm::dvec3 eye, double u, double v,
                            double depth_m);
WarpedPlace projected_place(const ReliefTexture& relief, glm::dvec3 eye, double u, double v,
                            double depth_m);

}  // namespace softfocus
