#pragma once
// The second half of relief texture mapping: a pre-warped relief on its plane as an ordinary
// texture, seen by a camera.
//
// A pixel's ray D meets the plane at t = h / D.f, at u = e1 + t D.a/a.a and v = e2 + t D.b/b.b,
// three planes over the picture and a division. Texels are filtered by bilinear_sum_unorm8() as
// they are stored, with 8 fractional bits of place. If half of the weight or more lies on texels
// that show something, the pixel shows their mean. So a silhouette is as sharp as a drawn one.
//
// The point itself lies behind the plane at t (1 + k3 d) / (1 - d / n), which is the pixel's depth,
// in alpha. A pixel is written if that is less than the picture has. (The eye's distance along f
// from a point z behind the plane is h + z, with z = d / (1 - d / n): h times that fraction.)

#include <glm/vec3.hpp>
#include <span>

#include "raster/images/image.h"
#include "raster/pipeline/state.h"
#include "raster/threads/parallel.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/relief/warp/resample.h"

namespace softfocus {

/// The texels of a warped relief on a camera's picture.
struct PlaneMapping {
  // Of the pixel (x, y): base + x step_x + y step_y, in binary64.
  struct Planar {
    double base, step_x, step_y;
    double at(double x, double y) const { return base + x * step_x + y * step_y; }
  };
  Planar u, v;  ///< times q, in texels from the warped relief's first
  Planar q;     ///< D.f
  double height_m;
  float k3;
  float source_per_m;  ///< 1 / n; 0 of an orthographic relief
  float behind_m;      ///< a pixel is written if it is nearer than the picture by more than this; 0
  Rectangle area;      ///< pixels that can show something
};

/// The pixels that a convex shape with these corners can cover; all if one is behind the eye.
Rectangle seen_area(std::span<const glm::dvec3> points, const CameraMatrices& camera, int width,
                    int height);

/// `place` is that of the warp for this camera's eye.
PlaneMapping plane_mapping(const ReliefTexture& relief, const CameraMatrices& camera,
                           const PlaneRectangle& place, int width, int height);

/// Lays a warped relief over an RGBA16F picture with depth in alpha, both of the camera. With
/// `shares`, R32F of the same size, a pixel is written from a sixteenth of the weight on, and its
/// share of the weight goes there.
void map_relief(const WarpedRelief& warped, const PlaneMapping& mapping, Image& picture,
                ThreadPool& pool, Image* shares = nullptr);

}  // namespace softfocus
