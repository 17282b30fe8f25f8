#ifndef SOFTFOCUS_ISA
// The kernel, below #else, is compiled once for each vector unit (for_each_isa.inl).

#include <algorithm>
#include <cassert>

#include "raster/effects/motion/velocity.h"
#include "raster/images/texel.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "raster/effects/motion/camera_velocity.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// turn[2] comes second: softpipe's compiler, which knows no `precise`, would put it there.
glm::vec3 seen(const PixelsToClip& by, glm::vec2 at, float inverse) {
  return ((by.turn[0] * at.x + by.turn[2]) + by.turn[1] * at.y) + by.shift * inverse;
}

/// (x + 1/2) 2 / size - 1.
glm::vec2 pixel_size(const ConstImageView& picture) {
  return {2.0f / static_cast<float>(picture.width), 2.0f / static_cast<float>(picture.height)};
}

glm::vec4 velocity_of(const CameraMotion& motion, glm::vec2 at, float depth_m) {
  const float inverse = depth_m > 0.0f && depth_m < motion.background_m ? 1.0f / depth_m : 0.0f;
  const float least_inverse = 1.0f / motion.background_m;
  const float least_w = motion.near_m * (inverse > least_inverse ? inverse : least_inverse);
  return {motion_px(seen(motion.to, at, inverse), seen(motion.from, at, inverse),
                    motion.half_size_px, least_w),
          0.0f, 1.0f};
}

}  // namespace

void camera_velocity(const CameraMotion& motion, const ConstImageView& picture,
                     const ImageView& velocity, const Profile& profile, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && velocity.format == Format::rg16f);
  assert(picture.width == velocity.width && picture.height == velocity.height);
  const glm::vec2 pixel = pixel_size(picture);
  for_each_row(pool, picture.height, kPassRows, [&](int y) {
    const float at_y = (static_cast<float>(y) + 0.5f) * pixel.y - 1.0f;
    int x = 0;
    if (pool.isa() != Isa::scalar) {
      x = SOFTFOCUS_KERNEL(pool.isa(), camera_velocity_row)(
          motion, pixel.x, at_y, row<std::uint16_t>(picture, y).data(),
          row<std::uint16_t>(velocity, y).data(), picture.width, profile.half_store);
    }
    for (; x < picture.width; ++x) {
      const glm::vec2 at{(static_cast<float>(x) + 0.5f) * pixel.x - 1.0f, at_y};
      const float depth_m = load_texel<Format::rgba16f>(picture, x, y).w;
      store_texel<Format::rg16f>(velocity, x, y, velocity_of(motion, at, depth_m), profile);
    }
  });
}

}  // namespace softfocus

#else  // the kernel

#include "raster/effects/motion/motion_lanes.inl"

namespace {

SOFTFOCUS_INLINE Floats seen_part(const PixelsToClip& by, int part, Floats x, float y,
                                  Floats inverse) {
  return ((by.turn[0][part] * x + by.turn[2][part]) + by.turn[1][part] * y) +
         by.shift[part] * inverse;
}

SOFTFOCUS_INLINE ClipLanes seen_lanes(const PixelsToClip& by, Floats x, float y, Floats inverse) {
  return {seen_part(by, 0, x, y, inverse), seen_part(by, 1, x, y, inverse),
          seen_part(by, 2, x, y, inverse)};
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE int camera_velocity_vectors(const CameraMotion& motion, float pixel, float at_y,
                                             const std::uint16_t* from, std::uint16_t* to,
                                             int width) {
  const Floats least_inverse = splat(1.0f / motion.background_m);
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const Floats depth_m = half_to_float(load_half_texels(from + 4 * x).a);
    const Mask is_near = (depth_m > 0.0f) & (depth_m < motion.background_m);
    const Floats inverse = select(is_near, 1.0f / depth_m, splat(0.0f));
    const Floats least_w = motion.near_m * select(inverse > least_inverse, inverse, least_inverse);
    const Floats at_x = (to_floats(x + lane_numbers()) + 0.5f) * pixel - 1.0f;
    const MotionLanes moved =
        motion_px_lanes(seen_lanes(motion.to, at_x, at_y, inverse),
                        seen_lanes(motion.from, at_x, at_y, inverse), motion.half_size_px, least_w);
    store_half_pairs(to + 2 * x, float_to_half<rounding>(moved.x),
                     float_to_half<rounding>(moved.y));
  }
  return x;
}

}  // namespace

/// Returns how many pixels are done.
int camera_velocity_row(const CameraMotion& motion, float pixel, float at_y,
                        const std::uint16_t* from, std::uint16_t* to, int width,
                        HalfRounding rounding) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even:
      return camera_velocity_vectors<nearest_even>(motion, pixel, at_y, from, to, width);
    case toward_zero:
      return camera_velocity_vectors<toward_zero>(motion, pixel, at_y, from, to, width);
    case swiftshader: break;
  }
  return camera_velocity_vectors<swiftshader>(motion, pixel, at_y, from, to, width);
}

#endif
