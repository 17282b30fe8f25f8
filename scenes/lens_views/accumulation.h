#pragma once
// The accumulation buffer (Haeberli and Akeley 1990): the scene drawn from points of the
// lens, and the mean of the pictures. With Sampling::shutter_frames also at many times: the motion
// blur of the same paper.

#include <functional>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "scenes/draw/draw_scene.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/lens_views/lens_view_method.h"
#include "scenes/lens_views/sample_sums.h"

namespace softfocus {

// The camera at a point of the lens.

/// Haeberli and Akeley (1990): the eye moves on the lens, by (e_x, e_y) metres to the right
/// and up, and the frustum is sheared so that the plane in focus stays where it was:
///
///   x_eye' = x_eye - e_x          x_clip' = P_00 x_eye' + (P_00 e_x / focus) w
///
/// At w = focus the two cancel. At another depth z the picture moves by
/// P_00 e_x (1/focus - 1/z) in normalised coordinates: the circle of confusion of
/// dof/lens.h, point by point. `offset_px` is where in the pixel, to the right and down
/// from its centre, a pixel looks: the picture moves the other way. Nothing moved is the
/// pinhole's view, bit for bit.
CameraMatrices lens_camera(const CameraMatrices& pinhole, glm::dvec2 lens_point_m, double focus_m,
                           glm::dvec2 offset_px, int width_px, int height_px);

// The loop that sampling methods share: groups of samples until there are enough.

/// Adds the samples `begin` to `end` - 1, a step at most, to the sums, and counts them.
using AddSamples = std::function<void(int begin, int end, SampleSums& sums)>;

/// In steps of kSampleGroup, and from 16 samples on of `step`: kSampleGroup or twice that.
SampledPicture take_samples(const LensViewInput& input, const AddSamples& add_samples, int step,
                            ThreadPool& pool);

/// Each lens view is drawn in RGBA16F, as the pinhole's picture is, by the lens_camera() of one of
/// the view_points(). One sample without jitter is the pinhole's picture. At few samples
/// a thing out of focus is a handful of sharp ghosts.
SampledPicture accumulation(const LensViewInput& input, ThreadPool& pool);

struct AccumulationBuffer;

/// accumulation() of the buffer's scene.
SampledPicture accumulation(AccumulationBuffer& buffer, const LensViewInput& input,
                            ThreadPool& pool);

/// The points of accumulation(): a set made for their number (lens_points.h), or, where they
/// are many or `until` may stop at any, the sequence lens_points().
std::vector<glm::dvec2> view_points(const Sampling& sampling);

/// Made once for many pictures of one scene: the points of the lens, the prepared scene, and
/// memory for a group of lens views.
struct AccumulationBuffer {
  std::vector<glm::dvec2> points;   ///< of the lens, in radii of the aperture: may be replaced
  std::vector<glm::dvec2> offsets;  ///< of the pixels
  std::vector<double> times;        ///< in frames from the picture's; none: all 0
  PreparedScene prepared;
  /// The targets of every lens view, which keep nothing.
  Image picture, depth;
  std::vector<RenderPass> passes;     ///< of a group
  std::vector<TileLists> tile_lists;  ///< of the passes
  /// Likewise of transparent surfaces; none if the scene has none.
  TransparentTargets transparent;
  std::vector<RenderPass> transparent_passes;
  std::vector<TileLists> transparent_lists;
  /// Likewise, if a light has shadows or there are stand-ins: the views, whole.
  std::vector<Image> whole;
};

/// With lens_points(), pixel_offsets() and the shutter_sequence() for up to
/// `input.sampling.samples` views. The scene must outlive it.
AccumulationBuffer make_accumulation_buffer(const LensViewInput& input, ThreadPool& pool);

/// Puts the buffer's views where accumulation() has them: at the view_points(), with offsets made
/// for these (few_pixel_offsets.h), or, where they are of the sequence, with the pixel_offsets();
/// at the shutter_times(), or with Sampling::until at those of the shutter_sequence().
void place_views(AccumulationBuffer& buffer, const Sampling& sampling);

/// Parts of the time that the shutter is open, in frames.
std::vector<double> times_in_frames(std::vector<double> parts, double shutter_frames);

/// Lens views that are drawn together. More take more memory for vertices and triangles, and
/// fetch the sums less often.
inline constexpr int kLensViewGroup = 2 * kSampleGroup;

/// Records the samples `begin` to `end` - 1, at most kLensViewGroup, in as many of the buffer's
/// passes, and sorts them into its tile lists. Then the tiles can be drawn, in any order, by
/// several threads at once, each tile by one; and last, clear_lens_views().
void sort_lens_views(AccumulationBuffer& buffer, const LensViewInput& input, int begin, int end,
                     ThreadPool& pool);

/// Is shown the views of a tile, RGBA16F in rows without gaps, on the thread that drew them.
using LookAtTile = std::function<void(int tile, const Rectangle& area,
                                      std::span<const std::uint16_t* const> views)>;

/// Draws a tile of the view number `i` of the sorted ones to `texels`, as draw_tile_aside().
void draw_view_tile(AccumulationBuffer& buffer, std::size_t i, int tile, TileMemory& memory,
                    std::byte* texels);

/// Forgets the sorted views.
void clear_lens_views(AccumulationBuffer& buffer);

/// Draws the samples `begin` to `end` - 1 and adds them to the sums. They are at most
/// kLensViewGroup, and `begin` is a multiple of kSampleGroup. All are drawn in one tile before
/// the next, so that their pixels stay in a core's cache. The buffer must have been made for
/// `end` points or more, with the input's scene and profile. Of the picture only `tiles` are drawn
/// (row by row, kTileSize), unless that is empty.
void add_lens_views(AccumulationBuffer& buffer, const LensViewInput& input, int begin, int end,
                    SampleSums& sums, ThreadPool& pool, std::span<const int> tiles = {},
                    const LookAtTile& look = {});

}  // namespace softfocus
