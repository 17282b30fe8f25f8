#pragma once
// The accumulation buffer (Haeberli and Akeley 1990): the scene drawn from points of the
// lens, and the mean of the pictures.

#include <glm/vec2.hpp>
#include <vector>

#include "scenes/draw/draw_scene.h"
#include "scenes/lens_views/lens_view_method.h"
#include "scenes/lens_views/sample_sums.h"

namespace softfocus {

/// Each picture is drawn as the pinhole's is, in RGBA16F, from a point of lens_points() and
/// in the view of lens_camera(). One sample without jitter is the pinhole's picture. What it
/// lacks at few samples: a thing out of focus is a handful of sharp ghosts.
SampledPicture accumulation(const LensViewInput& input, ThreadPool& pool);

/// What drawing from the lens needs, made once for many pictures of one scene: its points,
/// the scene made ready, and memory for a group of views.
struct AccumulationBuffer {
  std::vector<glm::dvec2> points;   ///< of the lens, in radii of the aperture
  std::vector<glm::dvec2> offsets;  ///< of the pixels
  PreparedScene prepared;
  /// The targets of every view, which keep nothing.
  Image picture, depth;
  std::vector<RenderPass> passes;     ///< of a group's views
  std::vector<TileLists> tile_lists;  ///< of the passes
};

/// For up to `input.sampling.samples` points. The scene must outlive it.
AccumulationBuffer make_accumulation_buffer(const LensViewInput& input, ThreadPool& pool);

/// So many views are drawn together. Memory for their vertices and triangles grows with it, and
/// the sums are fetched the less often.
inline constexpr int kLensViewGroup = 2 * kSampleGroup;

/// Draws the samples `begin` to `end` - 1, at most kLensViewGroup, from a multiple of kSampleGroup
/// on, and adds them to the sums: all of them into the same tile, one after the other, and then the
/// next tile, so that a sample's pixels stay in a core's cache and never go to memory. Needs a
/// buffer that was made for as many points, and the input's scene and profile.
void add_lens_views(AccumulationBuffer& buffer, const LensViewInput& input, int begin, int end,
                    SampleSums& sums, ThreadPool& pool);

}  // namespace softfocus
