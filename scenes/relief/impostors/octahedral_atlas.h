#pragma once
// An octahedral impostor atlas: an object drawn once from N x N directions, each an orthographic
// picture with depths that holds the bounding sphere (Brucks 2018). It is never renewed.
//
// The octahedron unfolds into a square (Cigolle et al. 2014): a direction becomes a place in 0..1
// each way, and the views are the N x N places of a grid that ends on the borders. A view takes the
// three corners of its grid triangle, with their barycentric weights. A cell is cut by the diagonal
// whose ends look from nearer directions: the other crosses the octahedron's edges, and with 6 x 6
// views its ends can lie 78 degrees apart.
//
// A pixel's ray meets each picture's plane through the middle of the object, and takes the texel
// there. With parallax it goes on to the depth of that texel, once, as engines do, or more often.

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <vector>

#include "raster/pipeline/state.h"
#include "scenes/relief/make_relief.h"
#include "scenes/relief/warp/map_relief.h"

namespace softfocus {

struct OctahedralForm {
  int views = 6;            ///< each way, 2 to kMostOctahedralViews
  bool hemisphere = false;  ///< only from above, +y: twice as dense
  int texels = 128;         ///< of a picture each way, 4 to kMostReliefSize
  int depth_bits = 8;
  bool with_normals = false;
  double distance_m = 1e3;  ///< of the eye from the middle: highlights are its
};
inline constexpr int kMostOctahedralViews = 64;

struct OctahedralAtlas {
  int views;
  bool hemisphere;
  glm::dvec3 middle;
  double radius_m;
  std::vector<ReliefTexture> pictures;  ///< row by row; all of one size and depth
};

/// The place of a direction, which need not be of length 1, each way in 0..1. In a hemisphere a
/// direction from below becomes one from its rim.
glm::dvec2 octahedral_place(glm::dvec3 direction, bool hemisphere);
/// And back, of length 1.
glm::dvec3 octahedral_direction(glm::dvec2 place, bool hemisphere);

/// The camera of a picture that looks at the middle from a direction of length 1.
ReliefCamera octahedral_camera(glm::dvec3 middle, double radius_m, glm::dvec3 direction,
                               int texels);

/// Draws all pictures. The same bits for any number of threads.
OctahedralAtlas make_octahedral_atlas(ReliefMaker& maker, const OctahedralForm& form,
                                      ThreadPool& pool);

std::size_t bytes_of(const OctahedralAtlas& atlas);

/// The three pictures of a view from `direction`, and their shares, which sum to 1.
struct OctahedralBlend {
  std::array<std::size_t, 3> pictures;
  std::array<double, 3> shares;
};
OctahedralBlend octahedral_blend(const OctahedralAtlas& atlas, glm::dvec3 direction);

/// A picture of the atlas as a camera sees it. All are linear over the camera's picture.
struct OctahedralView {
  PlaneMapping::Planar u, v;              ///< times q, where the ray meets the middle's plane
  PlaneMapping::Planar slope_u, slope_v;  ///< times q, in texels a metre of depth
  PlaneMapping::Planar q;                 ///< metres of depth, a metre along the camera's axis
  double height_m;                        ///< from the eye to the middle's plane, along the depth
};
OctahedralView octahedral_view(const ReliefTexture& picture, double radius_m,
                               const CameraMatrices& camera, int width, int height);

/// Pixels that can show something.
Rectangle octahedral_area(const OctahedralAtlas& atlas, const CameraMatrices& camera, int width,
                          int height);

/// Lays the atlas over an RGBA16F picture with depth in alpha. `steps` of parallax: 0 to 8. The
/// eye must be outside the bounding sphere. If kLeastCover of the weight or more lies on texels
/// that show something, the pixel shows their mean in linear light, at the mean of their depths, if
/// that is less than the picture has.
void draw_octahedral(const OctahedralAtlas& atlas, const CameraMatrices& camera, int steps,
                     Image& picture, ThreadPool& pool);
inline constexpr int kMostParallaxSteps = 8;
/// A third, the usual cut of a masked material. A half would lose more of an outline, which the
/// three pictures seldom have at one place.
inline constexpr float kLeastCover = 1.0f / 3.0f;

}  // namespace softfocus
