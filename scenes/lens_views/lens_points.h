#pragma once
// Points of the aperture, and of a pixel, to look from: low-discrepancy sequences, whose first
// n points cover the area evenly for any n.

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "dof/lens.h"

namespace softfocus {

/// The most points that a picture is sampled from.
inline constexpr int kMostSamples = 65536;

/// Point `index` of the square [0, 1) x [0, 1), in multiples of 2^-32: the (0, 2)-sequence of
/// van der Corput and Sobol (1967), each axis with its digits scrambled after Owen (1995),
/// by the hash of Laine and Karras (2011); then both turned by an exclusive or, so that
/// point 0 is the centre. Every block of 2^k points that starts at a multiple of 2^k has one
/// point in each of 2^k equal boxes, of any shape that halving gives. Sequences of another
/// `series` are independent of each other.
///
/// Without scrambling the first n points lie on average 1/(2n) beside the centre, and everything
/// out of focus would move.
glm::dvec2 square_point(std::uint32_t index, std::uint32_t series);

/// Point `index` of [0, 1), in multiples of 2^-32: Sobol's third axis, scrambled and turned as the
/// others are. With square_point() of series 0 it is a (1, 3)-sequence: every block of 2^k points
/// that starts at a multiple of 2^k has two in each of 2^(k-1) equal boxes of lens and time, and
/// one in each of 2^k equal parts of the time.
double shutter_point(std::uint32_t index);

/// A disc of radius 1, or a regular polygon whose corners lie on its edge, one of them up.
struct ApertureShape {
  int blades = 0;  ///< corners, 3 to kMostApertureBlades; 0: the disc
  bool operator==(const ApertureShape&) const = default;
};

/// A point of the square brought to the aperture, equal areas to equal areas, the centre
/// to the centre: the concentric map of Shirley and Chiu (1997), which turns squares about
/// the centre into circles, and for a polygon circles into polygons: a point at the
/// fraction t of the way around lies at t of the perimeter.
class ApertureMap {
 public:
  explicit ApertureMap(ApertureShape shape);
  /// x to the right and y up, as the camera sees them, in radii of the disc.
  glm::dvec2 operator()(glm::dvec2 square) const;

 private:
  std::vector<glm::dvec2> corners_;  // and the first again; none: a disc
};

/// The first `count` points of the lens, in radii; the first is the centre.
std::vector<glm::dvec2> lens_points(ApertureShape shape, int count);

/// `count` offsets from a pixel's centre, in pixels from -0.5 to 0.5, in an order independent of
/// the lens's points. The first is 0; without `jitter` all are.
std::vector<glm::dvec2> pixel_offsets(bool jitter, int count);

// Points of the lens for a picture of few views: a set made for its number.

/// The largest set that a picture looks from. It takes 4 ms on one core; one of 64 points takes 1
/// ms.
inline constexpr int kMostFewLensPoints = 256;

/// The largest set that there is: of the rays of a picture's views. It takes 20 ms.
inline constexpr int kMostLensPointsOfSet = 512;

/// `count` points of the lens, 1 to kMostLensPointsOfSet, in radii, whose mean is exactly 0. A set
/// is no beginning of another.
///
/// Where an edge is out of focus, a pixel is lit through the part of the lens on one side of a
/// line, and its error is that part's share of the area less its share of the points. The mean
/// square of this over all lines is, but for a factor, the energy distance of the points p_i to
/// the lens (Székely 2003; Crofton's formula joins the two):
///
///   2/n sum_i E|p_i - Y| - 1/n^2 sum_ij |p_i - p_j| - E|Y - Y'|,  Y, Y' anywhere on the lens
///
/// The set makes it least: the support points of Mak and Joseph (2018), found by descent from the
/// first points of lens_points(). Centroids of cells of equal area have an energy distance of
/// 1 % more, but lie too far inside, by the spread of their cells: circles come out too small.
std::vector<glm::dvec2> few_lens_points(ApertureShape shape, int count);

/// Points whose first n are a set for each n of `sizes`, which grow: the sum of the energy
/// distances of all these sets is least. Each has the mean 0. A set that is four times the one
/// before, or more, is as good as few_lens_points(); of sets that double, FLIP is a tenth to a
/// third higher.
std::vector<glm::dvec2> growing_lens_points(ApertureShape shape, std::span<const int> sizes);

/// The points for a picture of exactly `count` views: few_lens_points() up to kMostFewLensPoints,
/// the sequence beyond.
std::vector<glm::dvec2> lens_points_for(ApertureShape shape, int count);

}  // namespace softfocus
