#pragma once
// The shadows of a scene's frames. A pixel that a light does not reach has the bits that it has in
// the scene without this light: the light's own share is left out exactly, and ambient light and
// other lights remain. Light is linear in its colour, so a shadow of darkness X leaves the light
// with 1 - X of its colour, and nothing is rounded twice.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenes/draw/draw_scene.h"
#include "scenes/draw/seen_facets.h"
#include "scenes/shadows/maps/shadow_map.h"
#include "scenes/shadows/projected_shadows.h"
#include "scenes/shadows/terminators.h"
#include "scenes/shadows/volumes/volume_mask.h"

namespace softfocus {

/// Whether a light of the scene has shadows.
bool has_shadows(const Scene& scene);

/// Gives all lights of a scene this kind. Needs kMostShadowLights or fewer unless it is none.
void set_shadows(Scene& scene, ShadowKind kind);

/// What of the scene casts no shadow and why, a line for each reason.
std::vector<std::string> shadow_warnings(const Scene& scene);

/// The scene's triangles in the world, object by object.
Facets scene_facets(const Scene& scene, double frame);

/// Normals and objects of scene_facets().
CurvedSurfaces curved_surfaces(const Scene& scene, double frame);

ShadowLight shadow_light(const Light& light);

/// What is seen of a scene's triangles: all that seen facets depend on.
struct SeenFrom {
  CameraMatrices camera{};
  double frame = 0.0;
  int width = 0, height = 0;
  std::size_t layers = 0;
  std::optional<float> behind_before{};
  std::vector<std::uint8_t> hidden{};

  bool operator==(const SeenFrom&) const = default;
};

/// A light's bits of a layer's mask, and VolumeCount's rays.
struct KeptBits {
  std::vector<std::uint8_t> mask{};
  std::size_t rays = 0;
};

/// Kept from frame to frame: projected triangles and volumes as long as nothing moves, the facets
/// and the masks of a view that stays, and memory. A light that has moved is projected
/// onto what is seen alone: while it goes on moving, all else is of no use.
struct SceneShadows {
  NumberedScene numbered;
  std::vector<std::size_t> lights;  ///< of the scene, those with shadows: bit i is lights[i]
  bool moves = false;               ///< whether objects are elsewhere at another frame
  std::optional<double> frame;      ///< of facets and projected
  Facets facets;
  CurvedSurfaces surfaces;  ///< if a light's terminator asks for them
  /// Where `lights` were for what follows; none of one for which it is yet to be made.
  std::vector<std::optional<ShadowLight>> placed;
  /// Of each of `lights`. Of other kinds than projected it has no triangles, only the dark sides.
  std::vector<ProjectedShadows> projected;
  JoinedFacets joined;                 ///< if a light has volumes
  std::vector<ShadowVolumes> volumes;  ///< of each of `lights`; empty if it has another kind
  VolumeCount volume_count = VolumeCount::z_fail;
  bool by_rays = false;         ///< every pixel by a ray to each light, whatever its kind
  std::size_t volume_rays = 0;  ///< what draw_volume_mask() returned for the last frame's layers
  std::optional<SeenFrom> seen_from{};
  bool view_stays = false;                   ///< since the frame before: masks are worth keeping
  std::vector<std::vector<SeenFacet>> seen;  ///< of each layer
  /// seen_receivers() of them, once a light has moved.
  std::optional<std::vector<WantedReceiver>> wanted{};
  /// Of each layer, of each of `lights`: empty if it has to be drawn.
  std::vector<std::vector<KeptBits>> kept_bits{};
  std::vector<std::vector<std::uint8_t>> masks;  ///< of each layer: shadow_mask.h
  /// Of each of `lights`. Of other kinds than map, and before they are drawn, they have no sides.
  std::vector<ShadowMap> maps;
  /// Of each layer, of each of `lights`: map_lookup.h, or in 255ths: terminators.h. Empty for
  /// kernels of one texel without such a rule.
  std::vector<std::vector<std::vector<std::uint8_t>>> shares;
  std::vector<Image> unshadowed;  ///< layers with all lights, where there are shares
  // The scene without some lights: of each object the triangles that are drawn.
  std::vector<std::vector<std::uint32_t>> indices_of_objects;
  RenderPass pass;
  std::vector<Image> layers, depths;
};

std::shared_ptr<SceneShadows> make_scene_shadows(const Scene& scene, const Profile& profile,
                                                 ThreadPool& pool);

/// Makes shadows ready for lights, which are the scene's or the scene's in other places, at a
/// frame, on all that they fall on.
void place_shadows(SceneShadows& shadows, const Scene& scene, std::span<const Light> lights,
                   double frame, ThreadPool& pool);

/// What is kept of a view goes; with `all`, of the lights too.
void forget(SceneShadows& shadows, bool all);

/// What is drawn of the first layer's shadows, once add_shadows() has drawn it.
MaskDraws cut_shadows(const SceneShadows& shadows, const CameraMatrices& camera, int width,
                      int height, ThreadPool& pool);

/// Puts the shadows into layers that record_scene() has drawn of the same frame, lit by the same
/// lights. These are the scene's, or the scene's in other places.
void add_shadows(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                 std::span<const Light> lights, std::span<Image* const> layers,
                 std::optional<float> behind_before, ThreadPool& pool);

}  // namespace softfocus
