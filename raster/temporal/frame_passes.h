#pragma once
// The passes that make a frame of what is drawn and of the frames before: temporal anti-aliasing,
// refresh in groups, and reprojection in place of drawing. What they read is drawn elsewhere
// (scenes/temporal).

#include <cstdint>
#include <variant>

#include "raster/images/image_view.h"
#include "raster/numbers/profile.h"
#include "raster/temporal/accumulate.h"
#include "raster/temporal/reproject.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// The effect temporal-aa: each frame looks from another place in the pixel, and frames are
/// averaged (accumulate.h).
struct TemporalAa {
  AccumulateSettings average;
  int places = 8;  ///< 1: always the pixel's centre
  ReprojectSettings reproject{.is_cubic = true};
};

/// The effect refresh: each frame shades one of the groups, and what was not seen before
/// (refresh.h).
struct Refresh {
  int groups = 4;
  float depth_tolerance = 0.1f;
};

/// What a pixel shows that the frame before did not.
enum class UnseenPixels { drawn, filled, black };

/// The effect reproject: of so many frames one is drawn, and the others are made of that one, so
/// that errors do not add up.
struct Reproject {
  int every = 2;
  bool forward = false;
  UnseenPixels holes = UnseenPixels::drawn;
  float depth_tolerance = 0.1f;
};

using FrameEffect = std::variant<TemporalAa, Refresh, Reproject>;

/// How Refresh and Reproject look for old pixels.
inline ReprojectSettings own_depth_cubic(float depth_tolerance) {
  return {depth_tolerance, false, true};
}

/// What the passes read; all of one size. `before` is the frame before, and for Reproject the last
/// that was drawn.
struct FrameSources {
  ConstImageView drawn;     ///< RGBA16F, depth in alpha; not read by a scatter without drawn holes
  ConstImageView velocity;  ///< RG16F: of what is seen now, and forward of what was seen before
  ConstImageView before;    ///< RGBA16F, depth in alpha; rows as an Image's
  ConstImageView frames;    ///< R32F: of how many frames each pixel of `before` is made
  int turn = 0;             ///< of Refresh: the group that is drawn anew
};

/// What the passes write; all of the sources' size.
struct FrameTargets {
  ImageView picture;  ///< RGBA16F
  ImageView frames;   ///< R32F; may be the sources'. Reproject writes it if it has drawn holes
  ImageView between;  ///< RGBA16F
};

/// Returns how many pixels are as drawn. For TemporalAa those are all.
std::int64_t make_frame(const TemporalAa& settings, const FrameSources& sources,
                        const FrameTargets& targets, const Profile& profile, ThreadPool& pool);
std::int64_t make_frame(const Refresh& settings, const FrameSources& sources,
                        const FrameTargets& targets, const Profile& profile, ThreadPool& pool);
std::int64_t make_frame(const Reproject& settings, const FrameSources& sources,
                        const FrameTargets& targets, const Profile& profile, ThreadPool& pool);

/// Of any of the three, from a thread with any floating-point environment.
std::int64_t make_frame(const FrameEffect& effect, const FrameSources& sources,
                        const FrameTargets& targets, const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
