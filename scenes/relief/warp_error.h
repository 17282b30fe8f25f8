#pragma once
// How far a pre-warp pulls neighbours apart: what lies between them was never seen, and is made up.
//
// The critical point (5.5 of Clua 2004) is the pair of neighbours whose depths
// differ most. Where they come to lie is known before any other texel is warped: equations 5-5 to
// 5-7, with the true distance in place of a squared one, in texels. Neighbours of one depth are at
// most one texel apart.

#include <optional>

#include "scenes/relief/pre_warp.h"

namespace softfocus {

/// Two neighbours in a row or a column that both show something.
struct CriticalPoint {
  int u1, v1, u2, v2;
  int code1, code2;
};

/// The pair with the largest step of depth, the first of several; none if no two are neighbours.
std::optional<CriticalPoint> critical_point(const ReliefTexture& relief);

/// Equations 5-5 to 5-7: the distance between the pair's two texels as the eye sees them, in
/// texels.
double critical_error(const ReliefTexture& relief, const CriticalPoint& point, glm::dvec3 eye);

/// What no pair of the relief can exceed. Two neighbours move by scales s1 and s2 towards the
/// epipole, so they come to lie at most 1 + |s1 - s2| R texels apart; R is the largest distance of
/// a texel from the epipole, and |s1 - s2| at most h D / ((h + d) (h + d + D)), with the largest
/// step of depth D and the least depth d.
double error_bound(const ReliefTexture& relief, const ReliefExtent& extent,
                   const CriticalPoint& point, glm::dvec3 eye);

/// The largest distance of all pairs of neighbours: what the two above are measured against.
double largest_error(const ReliefTexture& relief, glm::dvec3 eye);

}  // namespace softfocus
