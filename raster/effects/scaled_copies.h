#pragma once
// Pictures of a light, scaled about a point: ghosts and rays of a lens flare.

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "raster/images/image_view.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// A picture of the light, scaled about a point.
struct ScaledCopy {
  glm::vec3 scale;   ///< of positions, for red, green and blue: below 0 mirrored, above 1 smaller
  glm::vec3 colour;  ///< factors of the light, 0 or more
};

/// What scaled_copies() computes with; the shader gets it so.
struct CopiesPass {
  std::vector<ScaledCopy> copies{};
  glm::vec2 anchor;  ///< in pixels of the source; pixel 0, 0 reaches from 0 to 1
  glm::vec2 fade;    ///< light counts by its distance from the picture's edge times this, up to 1
};

/// own + the sum over the copies of colour fade S(anchor + scale (p - anchor)), for each pixel's
/// middle p and each channel. S is bilinear, of a source with nothing around it. Alpha is that of
/// `own`. All three pictures are RGBA16F of one size; the result shares no memory with the others.
/// `source` is finite and nowhere below 0.
///
/// Where a copy lies beyond the source, and in rows where the source is dark, it costs nothing.
void scaled_copies(const CopiesPass& pass, const ConstImageView& source, const ConstImageView& own,
                   const ImageView& result, const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
