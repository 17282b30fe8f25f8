#pragma once
// Lights with a size: points of them, each a light with hard shadows, whose mean is the soft shadow
// (Heckbert and Herf 1997). Each point lights the scene from where it is, so the mean is the scene
// lit by the whole light. A share of the light at the middle would not do: a facet that turns away
// from the middle has none, although half of the light may reach it.
//
// Point i comes from the i-th points of the lens and of the shutter (lens_views/lens_points.h): x
// and y of a disc of radius 1 and t from 0 to 1. Point 0 is the middle.
//
//   directional  uniform over the disc that a cap of the sky is, of angular radius a about the
//                direction: with s = 1 - cos a and r^2 = x^2 + y^2 the direction has 1 - s r^2
//                along the middle's, and x and y times sqrt(s (2 - s r^2)) across (Lambert's
//                azimuthal map, which keeps areas)
//   point        middle + radius (x, y, z), z = sqrt(1 - r^2) sin(360 t degrees)
//
// The points of a ball have the density 1 / sqrt(1 - |p|^2): (x, y, z) and sqrt(1 - r^2) cos are
// uniform on the sphere of four dimensions. Seen along any two of its axes it is a uniform disc. So
// from far away on every side the ball looks like a uniform disc, as a glowing ball does. A disc
// that faces each pixel would be the same to the first order of radius / distance, but its points
// would differ from pixel to pixel, and no shadow of theirs could be projected.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/state.h"
#include "raster/threads/parallel.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/scene.h"
#include "scenes/shadows/maps/map_lookup.h"

namespace softfocus {

/// Whether a light has shadows and a size.
bool is_soft(const Light& light);
bool has_soft_shadows(const Scene& scene);

/// The lights at their `index`-th points, 0 to 2^16 - 1. Those that are not soft stay as they are.
std::vector<Light> lights_at_point(std::span<const Light> lights, std::uint32_t index);

/// Sums of pictures of one size, RGBA16F without alpha. A half is a multiple of 2^-24 and below
/// 2^16, so sums of kMostLightPoints are exact, in whatever order.
struct LayerSums {
  int count = 0;
  std::vector<std::vector<double>> totals;  ///< of each layer, three a pixel, rows from the top
};

void add_layers(std::span<Image* const> layers, LayerSums& sums, ThreadPool& pool);

/// The means, rounded to binary32 and then to halves. Alpha stays as it is in the layers.
void store_means(const LayerSums& sums, std::span<Image* const> layers, const Profile& profile,
                 ThreadPool& pool);

// Parts of a light's share: what shadow maps take away where the kernel is partly in shadow.

/// Whether a pixel of the area has a share. `shares` are of an image of that width.
bool has_shares(std::span<const std::uint8_t> shares, int width, const Rectangle& area);

/// Of each pixel of the area with a share of n of `whole`, in binary32 and in this order, a colour
/// at a time and not below 0: colour = colour + n / whole * (without - with). Alpha stays.
/// RGBA16F images of one size, one lit with the light and one without.
void take_shares(std::span<const std::uint8_t> shares, int whole, const Rectangle& area,
                 const Image& with, const Image& without, Image& colour, const Profile& profile);

// The shadow maps of a scene's lights: drawn when they must be, and looked up.

/// The camera that maps are fitted to.
MapCamera map_camera(const Scene& scene, const CameraMatrices& camera);

/// Draws the maps of lights that have one, where they stand, except those that hold what they would
/// hold.
void draw_maps(SceneShadows& shadows, std::span<const Light> lights, const MapCamera& camera,
               const Profile& profile, ThreadPool& pool);

/// Sets bits of a layer's mask, and its shares. Needs draw_maps().
void look_up_maps(SceneShadows& shadows, std::size_t layer, const ShadowView& view, glm::dvec3 eye,
                  ThreadPool& pool);

}  // namespace softfocus
