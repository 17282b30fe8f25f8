#pragma once
// How far a pre-warp pulls neighbours apart: the surface between them is made up.
//
// The critical point (5.5 of Clua 2004) is the pair of neighbours whose depths differ most. Their
// new places are known before any other texel is warped: equations 5-5 to 5-7, with the true
// distance in place of a squared one, in texels. If k3 >= 0, neighbours of one depth are at most
// one texel apart.

#include <optional>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/relief/warp/pre_warp.h"

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

/// A relief cut into N x M regions, each with a critical point of its own (5.6 of Clua 2004), so
/// that one rough place does not speak for all. A pair belongs to the region of its first texel.
struct CriticalRegion {
  CriticalPoint point;
  int least_code, most_code;  ///< of all pairs
};
struct CriticalRegions {
  ReliefExtent extent;
  int columns, rows;
  /// Row by row; none if no two neighbours show something.
  std::vector<std::optional<CriticalRegion>> regions;
};

/// Cuts the extent, not the texture. Needs 1 to kMostRegions columns and rows. The same for any
/// pool, and without.
CriticalRegions critical_regions(const ReliefTexture& relief, const ReliefExtent& extent,
                                 int columns, int rows, ThreadPool* pool = nullptr);
inline constexpr int kMostRegions = 64;

/// The mean of the critical errors of all regions that have a point; 0 if none has.
double mean_critical_error(const ReliefTexture& relief, const CriticalRegions& regions,
                           glm::dvec3 eye);

/// The distance that no pair of neighbours exceeds. Two neighbours at u and u + 1 of depths d1 and
/// d2 move by scales s = 1 / (1 + k3 d), and come to lie s2 + (k1 - k3 u) (d2 - d1) s1 s2 apart. In
/// a region
///
///   |k1 - k3 u|   is |k3| times the distance from the epipole, at most the farthest corner's
///   |d2 - d1|     is at most the largest step D
///   s             is at most that of the least depth, or, if k3 < 0, of the greatest
///   s1 s2         is at most the largest scale times the scale of a depth D beside
///
/// The bound is the largest of all regions: the more regions, the nearer it is.
double error_bound(const ReliefTexture& relief, const CriticalRegions& regions, glm::dvec3 eye);

/// The largest distance of all pairs of neighbours, against which the errors above are measured.
double largest_error(const ReliefTexture& relief, glm::dvec3 eye);

}  // namespace softfocus
