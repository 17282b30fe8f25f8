#pragma once
// The table of auto: methods at their settings, with models of their error and time. A new
// method is a line for each of its radii, with the coefficients that tools/calibrate-auto
// finds; docs/auto.md explains them.

#include <cstddef>
#include <span>
#include <string_view>

#include "dof/auto/scene_traits.h"

namespace softfocus {

/// Mean FLIP against the ground truth: the sum of these times the scene's traits. Fitted so that
/// the true error is seldom larger.
struct ErrorModel {
  float always = 0.0f;      ///< the error of a good picture
  float fine = 0.0f;        ///< of `blurred` for the least radius
  float blurred = 0.0f;     ///< of blurred; without a radius, of blur
  float lost = 0.0f;        ///< of lost; without a radius, of the last
  float near_edges = 0.0f;  ///< of near_edges, likewise
  float far_edges = 0.0f;   ///< of far_edges, likewise
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
  int radius = -1;          ///< index into kFilterRadiiPx; -1: takes none
  int samples = -1;         ///< index into kSampleCounts; -1: no lens views
  ErrorModel error;
  CostModel cost;
};

/// From cheap to dear.
std::span<const Candidate> candidates();

/// The predicted mean FLIP of a picture in which a circle reaches half a pixel.
double predicted_error(const Candidate& candidate, const SceneTraits& traits);

/// The predicted milliseconds of the method, without the pinhole's picture. `triangles` are
/// those of the scene.
double predicted_ms(const Candidate& candidate, const SceneTraits& traits, std::size_t triangles);

}  // namespace softfocus
