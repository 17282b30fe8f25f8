#pragma once
// A relief impostor: an object as one relief texture, which serves as long as its errors are small
// (chapters 4 and 5 of Clua 2004). For each view one of four things is done:
//
//   sprite   the last warp, mapped again: seen from here it is wrong by less than a pixel
//            (Schaufler 1995)
//   warp     the relief is pre-warped for this view
//   recall   a relief from the cache is pre-warped
//   renew    the object is drawn anew as this view's relief, which is pre-warped

#include <cstddef>
#include <optional>
#include <vector>

#include "scenes/relief/impostors/light_pixels.h"
#include "scenes/relief/light_relief.h"
#include "scenes/relief/make_relief.h"
#include "scenes/relief/warp/map_relief.h"
#include "scenes/relief/warp/warp_error.h"

namespace softfocus {

struct ImpostorSettings {
  WarpRule warp;
  ReliefProjection projection = ReliefProjection::orthographic;
  int depth_bits = 8;
  double tolerance_texels = 8.0;  ///< the critical error that makes a renewal
  int regions = 1;                ///< 1: of one point; more: the mean of regions x regions points
  double texels_per_pixel = 1.0;  ///< of a relief when it is drawn
  /// K of 4-1: a relief is renewed if its texels came to be wider than so many pixels,
  double sharpness = 1.5;
  double fineness = 0.25;  ///< or narrower than this part of a pixel
  bool sprites = true;     ///< Schaufler's test; without it every view is warped
  /// If not null, reliefs are unlit, and lit by these before each warp. They may change from
  /// frame to frame, without `sprites`. Not with warps aside.
  const ReliefLights* lights = nullptr;
  /// With `lights`: these light pixels, when the impostor is drawn; `sprites` may be on. Of several
  /// materials all pixels have the one of most texels.
  bool lights_pixels = false;
  /// 1: a relief has one resolution. More: its coarser ones, too. Then it is drawn with
  /// texels_per_pixel, kept until its finest texels are `sharpness` pixels wide, and warped at the
  /// coarsest level whose texels are no wider than a pixel. Not with warps aside.
  int levels = 1;
  /// Of stale reliefs that are kept. If there are more, the one whose eye is farthest away goes.
  std::size_t cache_bytes = 0;
};

enum class ImpostorStep : std::uint8_t { sprite, warp, recall, renew };

/// A relief at a lower resolution.
struct ReliefLevel {
  ReliefTexture texture;
  ReliefExtent extent;
};

/// A relief and what is known of it.
struct DrawnRelief {
  ReliefTexture texture;
  ReliefExtent extent;
  CriticalRegions critical;
  glm::dvec3 eye;                      ///< for which it was drawn
  std::vector<ReliefLevel> coarser{};  ///< each with half the texels of the one before
};
inline constexpr int kMostReliefLevels = 6;

std::size_t bytes_of(const DrawnRelief& relief);

struct Impostor {
  std::optional<DrawnRelief> drawn;  ///< none before the first view, and if nothing was seen
  WarpedRelief warped;
  WarpedRelief warped_normals;     ///< of lights_pixels
  glm::dvec3 warped_for{0.0};      ///< the eye
  std::size_t warped_level = 0;    ///< 0: the relief itself; else coarser[warped_level - 1]
  std::vector<DrawnRelief> cache;  ///< stale ones, the oldest first
};

/// Equation 5-1: the width in pixels of `size_m`, `distance_m` before the camera, in a picture of
/// `pixels` pixels over an angle of view of 2 atan(half_view_tangent).
double pixels_across(double pixels, double size_m, double distance_m, double half_view_tangent);

/// The eye and projection of an object's relief for a view. Orthographic in any case if the eye is
/// so near that a perspective camera would not hold the object.
ReliefView impostor_view(const ReliefMaker& maker, const CameraMatrices& camera,
                         const ImpostorSettings& settings, glm::dvec3 up);

/// The form of its relief: 5-1 at the relief's plane, times texels_per_pixel.
ReliefForm impostor_form(const ReliefMaker& maker, const CameraMatrices& camera,
                         const ImpostorSettings& settings, glm::dvec3 up, int height_px);

/// Schaufler's angle for a sideways move, as a tangent: the largest angle at which the new eye sees
/// a corner of the relief's box and the place in the plane where the old eye saw it.
double parallax_tangent(const ReliefTexture& relief, glm::dvec3 old_eye, glm::dvec3 new_eye);

/// Whether the relief can serve this eye at all: it sees its front, and not along its plane, and no
/// texel became too large or too small.
bool can_serve(const DrawnRelief& relief, const ImpostorSettings& settings, glm::dvec3 eye,
               double pixel_tangent);

/// The error by which a relief is stale: of one critical point, or the mean of all regions.
double impostor_error(const DrawnRelief& relief, glm::dvec3 eye);

/// Whether a relief serves a view within the tolerance.
bool is_fresh(const DrawnRelief& relief, const ImpostorSettings& settings, glm::dvec3 eye,
              double pixel_tangent);

/// Whether a relief that was kept serves a view: as is_fresh(), and the bound on its error is at
/// most kMostRecalledBound tolerances. An eye that goes on meets an error as it grows. But from far
/// aside the few critical points may happen to stay, and all other texels move.
bool can_be_recalled(const DrawnRelief& relief, const ImpostorSettings& settings, glm::dvec3 eye,
                     double pixel_tangent);
inline constexpr double kMostRecalledBound = 8.0;

/// A pixel's width, a metre before the camera.
double pixel_tangent_of(const CameraMatrices& camera, int height_px);

// --- the steps of update_impostor(), for those that take them apart ---

/// A relief that was drawn for an eye, with what is known of it; none if it shows nothing.
std::optional<DrawnRelief> known_relief(ReliefTexture texture, const ImpostorSettings& settings,
                                        glm::dvec3 eye, ThreadPool& pool);

/// Puts the stale relief into the cache, and makes room for it.
void keep_stale(Impostor& impostor, const ImpostorSettings& settings, glm::dvec3 eye);

/// Takes the relief with the least error out of the cache, if one serves.
std::optional<DrawnRelief> recalled(Impostor& impostor, const ImpostorSettings& settings,
                                    glm::dvec3 eye, double pixel_tangent);

/// Warps the relief that is there for an eye. If there is none, or the eye does not see its front,
/// nothing is shown.
void warp_impostor(Impostor& impostor, const ImpostorSettings& settings, glm::dvec3 eye,
                   double pixel_tangent, ThreadPool& pool);

/// The level that warp_impostor() takes: the coarsest whose texels are no wider than a pixel.
std::size_t level_for(const DrawnRelief& relief, glm::dvec3 eye, double pixel_tangent);

/// Brings the impostor up to date for a view, and says how. `up` is the camera's.
ImpostorStep update_impostor(Impostor& impostor, ReliefMaker& maker,
                             const ImpostorSettings& settings, const CameraMatrices& camera,
                             glm::dvec3 up, int height_px, ThreadPool& pool);

/// Lays it over a picture of the view, if it shows anything. Returns the pixels that it may have
/// changed. With `lights`, lights_pixels.
Rectangle draw_impostor(const Impostor& impostor, const CameraMatrices& camera, Image& picture,
                        ThreadPool& pool, PixelLights* lights = nullptr);

}  // namespace softfocus
