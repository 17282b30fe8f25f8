#pragma once
// A depth map as metres along the camera's axis: from the codes of a file.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "tools/pictures/picture_file.h"
#include "tools/refocus/depth/depth_encodings.h"

namespace softfocus {

/// Row by row from the top, width x height: metres from 1e-9, infinity where nothing is; NaN where
/// the depth is missing.
struct DepthMap {
  int width = 0;
  int height = 0;
  std::vector<float> metres{};
};

/// How codes are to be read.
struct DepthReading {
  const DepthEncoding* encoding = nullptr;
  DepthNumbers numbers{};  ///< least_code and largest_code are found here
  DepthAlong along = DepthAlong::axis;
  std::vector<double> missing_codes{};  ///< beside those that the encoding knows
  /// The picture's height over the height at distance 1: half of it over the tangent of half the
  /// field of view. For distances along the ray.
  double pixels_per_tangent = 1.0;
  double axis_x = 0.0, axis_y = 0.0;  ///< the camera's axis, in pixels from the map's middle
  double pixel_aspect = 1.0;          ///< a pixel's width over its height
};

/// `codes` are width x height numbers of that type. `mask`, empty or as many, is 0 where the depth
/// is missing.
DepthMap depth_of_codes(PlaneValues codes, NumberType type, int width, int height,
                        const DepthReading& reading, const PlaneValues& mask);

/// Reads a map that comes in bands of rows. First all codes are looked at, for least_code and
/// largest_code; then each code gives way to its depth.
class CodeEnds {
 public:
  CodeEnds(NumberType type, const DepthReading& reading);
  void add(std::span<const float> codes, std::span<const float> mask);
  void put_in(DepthNumbers& numbers) const;

 private:
  const DepthReading& reading_;
  double full_, least_, largest_;
};
/// `codes` are those of the rows from `first_row` on of a map of that size.
void codes_to_depths(std::span<float> codes, NumberType type, int first_row, int width, int height,
                     const DepthReading& reading, std::span<const float> mask);

/// The codes of a map: the inverse, which tests compare with. Missing depths become NaN.
PlaneValues codes_of_depth(const DepthMap& map, NumberType type, const DepthReading& reading);

std::size_t missing_depths(const DepthMap& map);

/// The least and largest finite depth, how many there are and lie where few pictures have any, and
/// whether there are infinite ones.
struct DepthEnds {
  double near_m = 1e30, far_m = 0.0;
  std::size_t finite = 0, beyond_100_m = 0, within_1_cm = 0;
  bool has_infinite = false;
};
void add_to_ends(DepthEnds& ends, std::span<const float> metres);

/// The depths of holes, which are pieces of the map without one.
///
///   far, near   the farthest or nearest of the nearest known depths to the left and right, above
///               and below: a hole opens behind what is near, where the camera saw nothing
///   infinity    all are infinitely far
///   background  infinitely far are holes that touch the border or are larger than every piece of
///               known depth, as a renderer leaves the background; and, if these are most of what
///               is missing, the others. Else far, as is a stripe along the border, which a depth
///               camera leaves: thinner than a 32nd of the map's shorter side.
enum class Holes : std::uint8_t { background, near_side, far_side, infinity, refused };

/// Fills all holes; returns how many pixels got infinity. Needs a known depth, and holes that are
/// not refused.
std::size_t fill_holes(DepthMap& map, Holes holes);

// How many pixels lie how deep.

struct DepthBin {
  double from = 0.0;
  double to = 0.0;
  std::size_t count = 0;
};

struct DepthHistogram {
  std::vector<DepthBin> bins{};  ///< none if nothing has a finite depth
  std::size_t infinite = 0;
};

inline constexpr std::size_t kDepthBins = 12;

/// Bins of equal steps of 1/z, as circles of confusion grow, or, if `even`, of z, which may then be
/// below 0. Missing depths are not counted.
DepthHistogram depth_histogram(const DepthMap& map, bool even);

}  // namespace softfocus
