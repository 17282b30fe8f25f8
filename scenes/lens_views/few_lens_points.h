#pragma once
// Points of the lens for a picture of few views: a set made for its number.

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "scenes/lens_views/lens_points.h"

namespace softfocus {

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
