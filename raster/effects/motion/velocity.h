#pragma once
// Velocity: for each pixel of a picture, how far the surface that it shows moves in the picture
// between two instants. RG16F, in pixels, x to the right, y down: the position at the later instant
// less that at the earlier.
//
// scenes/draw/draw_velocity.h draws it of anything that moves. Here it comes from the picture's
// depth and two cameras, which is right where nothing but the camera moves.

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// No motion is longer along an axis: the largest picture.
inline constexpr float kMostMotionPx = 16384.0f;

inline float cut_motion(float px) {
  return px < kMostMotionPx ? (px > -kMostMotionPx ? px : -kMostMotionPx) : kMostMotionPx;
}

/// (to.xy / to.w - from.xy / from.w) half_size_px, of clip x, y and w. A point that is behind the
/// camera at an instant, or nearer than `least_w`, counts as if at least_w: it goes the right way,
/// but not as far.
inline glm::vec2 motion_px(glm::vec3 to, glm::vec3 from, glm::vec2 half_size_px, float least_w) {
  const float to_w = to.z > least_w ? to.z : least_w;
  const float from_w = from.z > least_w ? from.z : least_w;
  return {cut_motion((to.x / to_w - from.x / from_w) * half_size_px.x),
          cut_motion((to.y / to_w - from.y / from_w) * half_size_px.y)};
}

/// How another camera sees the pixels of a picture. Clip x, y and w over depth, of the point that
/// the pixel at x and y, each -1 to 1, shows at a depth of 1 / `inverse` metres:
///   turn (x, y, 1) + shift inverse
struct PixelsToClip {
  glm::mat3 turn{1.0f};
  glm::vec3 shift{0.0f};
};

/// The camera's motion in a picture.
struct CameraMotion {
  PixelsToClip to, from;   ///< the later and the earlier instant; the picture's own is {}
  glm::vec2 half_size_px;  ///< half the picture's size, times a factor of the motion if wanted
  float near_m;
  float background_m;  ///< a picture's alpha where it shows nothing: what is so far is at infinity
};

/// Writes RG16F of the picture's size. The picture is RGBA16F with its depth in metres in alpha; a
/// depth that is not above 0, or NaN, is at infinity too.
void camera_velocity(const CameraMotion& motion, const ConstImageView& picture,
                     const ImageView& velocity, const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
