#pragma once
// What auto chooses from: methods at their settings, each with what it is foreseen to
// take and how far off it is foreseen to be. A new method is a line for each of its radii,
// with the coefficients that tools/calibrate-auto finds; docs/auto.md tells how they came
// about.

#include <cstddef>
#include <span>
#include <string_view>

#include "dof/auto/scene_traits.h"

namespace softfocus {

/// Mean FLIP against the ground truth, as a sum of a scene's traits times these. Fitted so
/// that what a picture is really off by is seldom more.
struct ErrorModel {
  float always = 0.0f;      ///< what even a good picture is off by
  float fine = 0.0f;        ///< of blurred by the least radius: what small circles touch
  float blurred = 0.0f;     ///< of blurred; of the pinhole of blur
  float lost = 0.0f;        ///< of lost
  float near_edges = 0.0f;  ///< of near_edges
  float far_edges = 0.0f;   ///< of far_edges
  float ghosts = 0.0f;      ///< of ghosts
};

/// Nanoseconds of a filter on two cores of the reference machine (docs/auto.md).
struct CostModel {
  float pixel = 0.0f;                 ///< for each pixel,
  float blurred_pixel = 0.0f;         ///< for each that is out of focus,
  float blurred_pixel_radius = 0.0f;  ///< and times the largest radius in pixels that it meets
};

/// One line of the table.
struct Candidate {
  std::string_view method;  ///< its name in dof/dof.h or scenes/lens_views/lens_view_method.h
  int radius = -1;          ///< index into kFilterRadiiPx, what circles are cut to; -1 of no filter
  int samples = -1;         ///< index into kSampleCounts; -1 of no method that draws the scene
  ErrorModel error;
  CostModel cost;
};

/// From what is cheap to what is not.
std::span<const Candidate> candidates();

/// Foreseen mean FLIP of a picture in which a circle reaches half a pixel.
double predicted_error(const Candidate& candidate, const SceneTraits& traits);

/// Foreseen milliseconds for the method, the pinhole's picture being there; `triangles` is
/// the scene's number of them.
double predicted_ms(const Candidate& candidate, const SceneTraits& traits, std::size_t triangles);

}  // namespace softfocus
