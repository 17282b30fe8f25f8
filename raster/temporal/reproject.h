#pragma once
// Reprojection: what the frame before showed of a surface is used again (Nehab et al. 2007).
// Reverse: each pixel looks up where its surface was. forward_reproject.h has the other direction.

#include "raster/images/image_view.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

struct ReprojectSettings {
  /// How much nearer or farther the surface found there may be, as a share of depth; 0: any depth.
  float depth_tolerance = 0.1f;
  /// Whether a pixel takes the motion of the nearest surface among its 3x3 neighbours, and may show
  /// any depth between theirs: so an edge that is smooth stays so where it moves (Karis 2014).
  bool takes_neighbours = true;
  /// Whether a place between pixels is read by a cubic curve through them (Catmull and Rom 1974),
  /// which blurs less when it is done frame after frame.
  bool is_cubic = false;
};

/// All of one size.
struct ReprojectInput {
  ConstImageView depths;  ///< RGBA16F: the frame's depth in alpha, above 65504 m as 65504 m
  /// RG16F: the position now less that before (raster/effects/motion/velocity.h).
  ConstImageView velocity;
  ConstImageView before;  ///< RGBA16F: the frame before, its depth in alpha; rows as an Image's
  ConstImageView frames;  ///< R32F: of how many frames each pixel of `before` is made
};

/// Writes RGBA16F: the colour of `before` where each pixel's surface was, and in alpha of how many
/// frames it is made, 0 and black where the surface was not seen. For pixel (x, y), in binary32:
///
///   of the 3x3 pixels around it, row by row: q the first of the nearest; near and far the least
///   and the largest depth; or q itself, and its depth (u, v) = (x, y) - velocity(q); (i, j) =
///   floor; (s, t) = the rest weights (1 - s) (1 - t), s (1 - t), (1 - s) t, s t of (i, j), (i + 1,
///   j), (i, j + 1), (i + 1, j + 1) a pixel counts if it lies in the picture, its weight is above
///   0, and its depth between near - tolerance near and far + tolerance far result = the sum of
///   weight times colour and frames, in this order, over that of the weights
///
/// Where a velocity is not finite nothing was seen.
void reverse_reproject(const ReprojectSettings& settings, const ReprojectInput& input,
                       const ImageView& result, const Profile& profile, ThreadPool& pool);

/// Where something was found, alpha becomes the depth of `drawn` in place of a count of frames.
/// Both are RGBA16F of one size.
void put_depths(const ConstImageView& drawn, const ImageView& found, const Profile& profile,
                ThreadPool& pool);

/// The tolerance as it is computed with; the shader gets it so.
float used_depth_tolerance(const ReprojectSettings& settings);

}  // namespace softfocus
