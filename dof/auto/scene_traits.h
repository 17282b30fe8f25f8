#pragma once
// Traits of a picture that make it hard to blur, by which auto picks a method.
//
// The ranges are of every pixel, the rest of 1,600 points on a grid, each moved within
// its cell as a hash of its place says. Around a point p lie four taps q in each of the rings
// of radius D = 1, 2, 4, ... 64 pixels, along the axes or the diagonals. A tap is the mean of
// min(D, 8) x min(D, 8) pixels, so that small lights are not missed: up to ring 8 the taps of a
// ring cover nearly all of it. With r the signed
// radius of the circle of confusion in pixels, negative nearer than the focus, and C the colour
// in linear light, not cut:
//
//   edge(p, q)   |r_q - r_p| > 1 + D/4: something ends between the two; a slope changes less
//   reach(p, q)  how far light comes between them: |r_q| where q lies before p across an
//                edge; |r_p| where q lies behind p and p is nearer than the focus, for then
//                what p hides is seen; else min(|r_p|, |r_q|)
//   W_R(p, q)    clamp(min(reach, R) - 3/4 D + 1/2, 0, 1) 3/4 D^2, none below half a pixel:
//                the ring's area, as far as it lies within the circle cut to R
//   m_R(p)       (C_p + sum W_R C_q) / (1 + sum W_R): what a lens of such circles makes of p,
//                as far as the picture shows it; m without the cut
//
// Light is added up as it is, and cut to 0..1 and its square root s taken, about as an eye sees
// it on a screen, at the end. |a - b| of two sums is the largest of the three channels'
// differences of s; an error e of light is seen as E(e) = max(s(L + e) - s(L), s(L) - s(L - e)),
// L the largest channel of m_R. F(d) = d^(3/4), because FLIP weighs half a difference by more
// than a half.

#include <array>

#include "dof/lens.h"
#include "raster/images/image_view.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// Radii R that filters are cut to, in pixels.
inline constexpr std::array<float, 6> kFilterRadiiPx{2, 4, 8, 16, 32, 64};

/// Numbers of samples N of the lens-view methods.
inline constexpr std::array<int, 9> kSampleCounts{8, 16, 32, 64, 128, 256, 512, 1024, 2048};

/// Means over the points, for filters that reach as far as R. All are 0 or more.
struct RadiusTraits {
  float lost = 0.0f;     ///< F(|m_R - m|): blur that the filter cannot give
  float blurred = 0.0f;  ///< F(|m_R - C|): blur that it gives, a disc or not
  /// F(E(sum of W_R |C_q - C_p| / (1 + sum W_R))), the first sum over edges whose nearer side lies
  /// before the focus, blurred by half a pixel or more: what one should see through, and behind.
  float near_edges = 0.0f;
  float far_edges = 0.0f;  ///< the same over all other edges
};

/// Radii are signed, in pixels, of a magnitude up to 1,024.
struct SceneTraits {
  int width = 0;
  int height = 0;
  float nearest_px = 0.0f;     ///< the least radius, exactly
  float farthest_px = 0.0f;    ///< the greatest, exactly
  float blurred_share = 0.0f;  ///< points with |r| of half a pixel or more, 0 to 1
  float blur = 0.0f;           ///< F(|m - C|): what is lost without any blur
  /// The brightest channel of all pixels that are out of focus by half a pixel or more, linear.
  float brightest = 0.0f;
  std::array<RadiusTraits, kFilterRadiiPx.size()> by_radius{};
  /// E(d / sqrt(N) min(1, g / 3)), what is left of the ghosts of N samples once the eye has
  /// blurred them: d is the root of the mean square of |C_q - m| over a point's circle,
  /// g = r sqrt(pi / N) the distance between ghosts, r the largest reach.
  std::array<float, kSampleCounts.size()> ghosts{};
};

/// The largest circle, without its sign.
float largest_px(const SceneTraits& traits);

/// Of an RGBA16F picture with depth in alpha. A depth that is NaN or infinite lies beyond the
/// focus, one of 0 before it. In binary32 and the order written, sums in binary64 by rows of
/// points: the same bits for any number of threads and every vector unit.
SceneTraits scene_traits(const ConstImageView& pinhole, const PixelCoc& coc, ThreadPool& pool);

}  // namespace softfocus
