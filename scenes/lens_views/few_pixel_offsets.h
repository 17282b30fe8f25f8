#pragma once
// Where in the pixel the views of a picture look: a set made for their number, paired with their
// points of the lens.

#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace softfocus {

/// The distances of all pairs, row by row, each less the means of its row and column, plus the mean
/// of all: A and B below.
std::vector<double> centred_distances(std::span<const glm::dvec2> points);

/// Which member of the second set each of the first has, by their centred distances, so that the
/// distance covariance is small: found by exchanges from member to its like, those before `begin`
/// left as they are.
std::vector<std::size_t> independent_pairing(std::vector<double> of_first,
                                             std::vector<double> of_second, std::size_t begin);

/// The middle of one of n equal columns of [-0.5, 0.5], in multiples of 2^-32, cut towards 0: as
/// much to the left as to the right.
double middle_of_column(std::size_t column, std::size_t columns);

/// An offset from a pixel's centre for each of 1 to kMostFewLensPoints points of the lens, in
/// pixels from -0.5 to 0.5. Their sum is exactly 0.
///
/// They are few_lens_points() of the square, moved along each axis to the middles of n equal
/// columns and rows: an edge along an axis, in focus, is as smooth as n views can make it.
///
/// Where an edge is a little out of focus, a view's place on the lens moves it as its offset
/// does, so the two must have nothing to do with each other. Offsets change places until no
/// exchange of two brings down the distance covariance of points l_i and offsets o_i (Székely,
/// Rizzo and Bakirov 2007),
///
///   sum_ij A_ij B_ij,  A_ij = |l_i - l_j| and B_ij = |o_i - o_j|, each less the means of its row
///                      and column, plus the mean of all
///
/// which is 0 where for every line of the lens and every line of the pixel the share on one side
/// of both is the product of the two shares.
std::vector<glm::dvec2> few_pixel_offsets(std::span<const glm::dvec2> lens_points);

/// The same for growing_lens_points() of these sizes: the first n offsets are paired with the first
/// n points for each n of them. They have no columns of their own.
std::vector<glm::dvec2> growing_pixel_offsets(std::span<const glm::dvec2> lens_points,
                                              std::span<const int> sizes);

/// The offsets for a picture of exactly these views: 0 without `jitter`; else few_pixel_offsets()
/// up to kMostFewLensPoints, the sequence beyond.
std::vector<glm::dvec2> view_offsets(bool jitter, std::span<const glm::dvec2> lens_points);

}  // namespace softfocus
