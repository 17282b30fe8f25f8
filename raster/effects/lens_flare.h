#pragma once
// Lens flare: light that is reflected between the surfaces of a lens, and streaks and rays that
// its edges make of it. From the picture's own bright light, at a quarter of its size (after
// Chapman 2013), so that what hides a lamp hides its flare.

#include <glm/vec2.hpp>
#include <limits>
#include <span>
#include <vector>

#include "raster/effects/bloom.h"
#include "raster/effects/scaled_copies.h"
#include "raster/images/image.h"
#include "raster/passes/kernel.h"

namespace softfocus {

struct LensFlareSettings {
  float threshold = 1.0f;  ///< what is darker has no flare
  float knee = 0.5f;       ///< as of BloomSettings
  /// Depth in metres, as in alpha, from which on light has a flare: what is nearer is no sun.
  float beyond_m = -std::numeric_limits<float>::infinity();
  float strength = 0.05f;  ///< factor of all that is added
  int ghosts = 5;          ///< pictures of the light, mirrored at the middle and scaled, 0 to 8
  /// Radius of the aperture's picture that a ghost is, before it is scaled, over half the picture's
  /// height, 0 to 0.5; 0: a ghost has the light's own shape.
  float aperture = 0.08f;
  float fringe = 0.03f;  ///< how much larger ghosts are in blue than in green, 0 to 0.3
  float halo = 0.5f;  ///< radius of a ring around the light, over half the picture's height, 0 to
                      ///< 1; 0: none
  float streak_px = 200.0f;  ///< length to either side, 0 to 4096; 0: none
  float rays = 0.3f;         ///< length of rays from the light, over the way to it, 0 to 1; 0: none
};

/// The parts of a flare in a picture of that size: the procedural textures of streak, halo and
/// aperture, whose weights sum to 1; the two passes of rays from `light`, alike; ghosts.
BrightPass bright_pass_of(const LensFlareSettings& settings);
std::vector<float> streak_weights(float length_px);
Kernel halo_kernel(float radius_px);
Kernel aperture_kernel(float radius_px);
CopiesPass rays_pass(float length, glm::vec2 light);
CopiesPass ghosts_pass(const LensFlareSettings& settings, int width, int height);

/// Where the light is: the mean of all positions, by the square of their red + green + blue, in
/// binary64 and row by row. The middle of a black picture.
glm::vec2 middle_of_light(const ConstImageView& picture);

/// How often each side of the picture is halved for its flare, and then for halo and aperture:
/// until the radius is no more than this.
inline constexpr int kFlareHalvings = 2;
inline constexpr float kMostFlareRadiusPx = 12.0f;

/// picture + strength flare. With S the bright light, its sides halved twice (bloom.h, pyramid.h):
///
///   T = the streak's row of weights over S, or 0
///   H = T + the halo's weights over S (its sides halved further, and back up), or T
///   R = H + rays(rays(S)), or H
///   F = R + the ghosts of the aperture's weights over S (as the halo's), or of S
///   flare = upsample(upsample(F))
///
/// Alpha stays. Each picture is RGBA16F.
void lens_flare(const LensFlareSettings& settings, const ConstImageView& picture,
                const ImageView& result, const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
