#pragma once
// The pre-warped picture: texels moved to their new places in the plane, and gaps between
// neighbours filled by a straight line between them. There are four ways (Oliveira 2000; 8.2 of
// Clua 2004). All take texels in the order compatible with occlusion (pre_warp.h), so none compares
// depths:
//
//   two-pass      rows, then columns. A texel between two others has a depth on the straight line
//                 between theirs, and moves within its column as that depth says.
//   asymmetric    as two-pass, but the place within the column lies on the straight line.
//   compensated   as asymmetric, with the depth that moves the texel to that place (8-1).
//   intertwined   one pass: each texel of a row goes into its column at once, so none is lost that
//                 a later one of its row covers.
//
// A texel is as wide as its share of the plane: a run of neighbours ends half a texel past its last
// centre. If a texel moves behind the one before it, the surface turned away between them, and a
// new run begins.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/relief/warp/pre_warp.h"

namespace softfocus {

enum class Resampling : std::uint8_t { two_pass, asymmetric, compensated, intertwined };

struct NamedResampling {
  std::string_view name;
  Resampling resampling;
  double source_ms;  ///< of Clua 2004: 256x256 texels on a Pentium IV at 2.6 GHz
};
inline constexpr std::array kResamplings{
    NamedResampling{"two-pass", Resampling::two_pass, 47.406},
    NamedResampling{"asymmetric", Resampling::asymmetric, 47.859},
    NamedResampling{"compensated", Resampling::compensated, 49.625},
    NamedResampling{"intertwined", Resampling::intertwined, 40.859}};

/// How places are computed: in binary32, or in integers of 256ths of a texel.
enum class PlaceNumbers : std::uint8_t { floats, fixed };

/// How a relief is warped.
struct WarpRule {
  Resampling resampling = Resampling::intertwined;
  PlaceNumbers numbers = PlaceNumbers::floats;
  /// Neighbours that come farther apart are not joined: a hole stays between them. Clua (2004)
  /// joins all. 2 or more.
  double join_texels = kJoinAll;

  static constexpr double kJoinAll = 1e6;
};

/// In texels of the relief's plane.
struct PlaneRectangle {
  int x_begin, y_begin, width, height;
};

/// The texels to which a relief's can move, and one more on each side. None if the eye does not see
/// the front, or if they would be more than kMostStretch times as wide or high as the relief, or
/// farther than kFarthestPlace from its first texel: the eye looks along the plane.
std::optional<PlaneRectangle> warped_extent(const ReliefTexture& relief, const ReliefExtent& extent,
                                            glm::dvec3 eye);
inline constexpr int kMostStretch = 4;
inline constexpr double kFarthestPlace = 0x1p20;

/// Texel (0, 0) lies at (x_begin, y_begin) of the plane.
struct WarpedRelief {
  PlaneRectangle place{0, 0, 0, 0};
  std::vector<std::uint32_t> colours;  ///< as ReliefTexture has them
  /// d in metres; means nothing of an empty texel.
  std::vector<float> depths_m;
  // Memory that is kept from one warp to the next.
  std::vector<std::uint32_t> row_colours;
  std::vector<float> row_depths_m, row_places;
  std::vector<std::int32_t> row_codes, row_fixed;
};

/// Counts of a pre-warp. `pieces` are written texels, of both passes if there are two.
struct WarpCounts {
  std::int64_t pieces = 0;
  std::int64_t overlaps = 0;   ///< pieces that covered an earlier one
  std::int64_t stretched = 0;  ///< pieces between neighbours that came more than 2 texels apart
};
inline constexpr int kApart = 2;

/// Warps for a view; `place` is warped_extent()'s. The same bits for any number of threads and any
/// vector unit. With `counts` it takes longer.
void warp_relief(const ReliefTexture& relief, const ReliefExtent& extent, glm::dvec3 eye,
                 const PlaneRectangle& place, const WarpRule& rule, WarpedRelief& warped,
                 ThreadPool& pool, WarpCounts* counts = nullptr);

/// Equation 8-1: the depth, in metres, that moves a texel of row `v` to `place` within its column.
/// The pre-warp, solved for the depth, is the same as 8-1's coefficients:
///
///   (place - v) / (k2 - place k3)
///
/// On the epipole's row no depth moves anything, and `otherwise` is returned.
float compensated_depth(const PreWarp& warp, float v, float place, float otherwise);

}  // namespace softfocus
