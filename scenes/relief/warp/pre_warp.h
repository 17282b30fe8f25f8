#pragma once
// The pre-warp moves the texels of a relief texture within its plane, so that the plane, seen from
// a new point as an ordinary texture, shows what the relief would (Oliveira, Bishop and McAllister
// 2000, equations 3-1 and 3-2 of Clua 2004):
//
//   u' = (u + k1 d) / (1 + k3 d)      v' = (v + k2 d) / (1 + k3 d)
//   k1 = f.(b x c) / a.(b x c)   k2 = f.(c x a) / b.(c x a)   k3 = f.(a x b) / c.(a x b)
//
// with c = C - eye. As a, b and f are perpendicular here, k3 = 1/h, k1 = e1/h and k2 = e2/h, where
// h = c.f is the eye's distance from the plane, and (e1, e2) = (-c.a/a.a, -c.b/b.b) its foot: the
// eye, dropped onto the plane.
//
// Under a perspective camera a point X = S + p / w, with p = C + u a + v b - S and w = 1 - d/n, is
// seen along (X - eye) w = c + u a + v b + d m, with m = (eye - S)/n in the place of f. So the
// equations stay, with m for f; and with the source's foot (s1, s2), S dropped onto the plane,
//
//   k3 = 1/h - 1/n      k1 = e1/h - s1/n      k2 = e2/h - s2/n
//
// An orthographic camera is the case of infinite n. For the eye S itself all three are 0: no texel
// moves.
//
// The epipole (k1, k2) / k3 does not move. It is the point where the line from S to the eye meets
// the plane, or the eye's foot if S is at infinity. As u' - k1/k3 = (u - k1/k3) / (1 + k3 d), every
// texel moves on a line through the epipole, the farther the deeper it is, and never past it.
//
// If k3 > 0 (the eye is nearer to the plane than S), texels move towards the epipole. Of two at one
// place the one that started nearer to the epipole is in front, so texels that are taken from the
// borders towards the epipole cover each other rightly: the order compatible with occlusion. If
// k3 < 0, texels move away from the epipole, the one that started farther is in front, and the
// order is from the epipole outwards.

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "raster/lanes/isa.h"
#include "scenes/relief/relief_texture.h"

namespace softfocus {

/// A view's constants. Depths are in metres.
struct PreWarp {
  float k1 = 0.0f, k2 = 0.0f, k3 = 0.0f;
  float step_m = 0.0f;                ///< of a code
  double foot_u = 0.0, foot_v = 0.0;  ///< the eye, dropped onto the plane
  double height_m = 0.0;              ///< h
  // The perspective camera's; of an orthographic one all three are 0.
  double source_u = 0.0, source_v = 0.0;    ///< its foot
  double source_per_m = 0.0;                ///< 1 / n
  double epipole_u = 0.0, epipole_v = 0.0;  ///< may be infinite
  bool outwards = false;                    ///< k3 < 0: texels move away from the epipole
};

/// k1 d, k2 d and k3 d in binary64.
struct DepthShares {
  double u, v, scale;
};
inline DepthShares shares_of(const PreWarp& warp, double depth_m) {
  const double share = depth_m / warp.height_m, of_source = depth_m * warp.source_per_m;
  return {warp.foot_u * share - warp.source_u * of_source,
          warp.foot_v * share - warp.source_v * of_source, share - of_source};
}

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

/// Of each code: 255 or 65535 of them.
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

/// The places of the texels of row `v`. Those of empty texels are finite, and mean nothing. It
/// computes warped_depth() anew, in lanes faster than a look into warp_table(), with the same bits.
void warp_row(const PreWarp& warp, const std::uint16_t* codes, int width, int v, float* along_u,
              float* along_v, Isa isa);

/// The pre-warp in binary64.
struct WarpedPlace {
  double u, v;
};
WarpedPlace exact_place(const PreWarp& warp, double u, double v, double depth_m);

/// The oracles, in binary64: the equation above with its products of vectors, and the point's
/// projection onto the plane.
WarpedPlace pre_warp_oracle(const ReliefTexture& relief, glm::dvec3 eye, double u, double v,
                            double depth_m);
WarpedPlace projected_place(const ReliefTexture& relief, glm::dvec3 eye, double u, double v,
                            double depth_m);

}  // namespace softfocus
