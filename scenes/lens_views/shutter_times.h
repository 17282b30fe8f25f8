#pragma once
// When each view of a picture looks, while the shutter is open.

#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace softfocus {

/// A time for each view, from -0.5 to 0.5 of the time that the shutter is open: the middles of n
/// equal parts, whose sum is exactly 0, in the order of shutter_point(). So a thing that moves
/// evenly is as smooth as n views can make it, with the lens as small as it may be.
///
/// Up to kMostFewLensPoints views the times change places, as few_pixel_offsets() do, until no
/// exchange brings down the sum of their distance covariances with the points of the lens and
/// with the offsets. Beyond, they and the lens's points are of one sequence in three dimensions.
std::vector<double> shutter_times(std::span<const glm::dvec2> lens_points,
                                  std::span<const glm::dvec2> offsets);

/// The same for growing_lens_points() of these sizes. The first n times are paired with the first n
/// points for each n of them, and are evenly spread if n is a power of 2.
std::vector<double> growing_shutter_times(std::span<const glm::dvec2> lens_points,
                                          std::span<const glm::dvec2> offsets,
                                          std::span<const int> sizes);

/// The first `count` times of the sequence, beginning with 0: for pictures that may stop
/// at any.
std::vector<double> shutter_sequence(int count);

}  // namespace softfocus
