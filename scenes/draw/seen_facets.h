#pragma once
// Which triangle of a scene each pixel shows: the same triangles, the same depth test as in
// draw_layers().

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/draw/draw_scene.h"
#include "scenes/shadows/shadow_mask.h"

namespace softfocus {

/// A scene's triangles one after the other, object by object: three corners each, which no other
/// has, so that they can carry a number.
struct NumberedMesh {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec2> uvs;  ///< of a cut-out object
  std::uint32_t first_facet = 0;
};

struct NumberedScene {
  std::vector<NumberedMesh> meshes;    ///< of each object
  std::vector<std::uint32_t> indices;  ///< 0, 1, 2 ..., for the largest of them
  RenderPass pass;
  std::vector<Image> layers, depths;
};

NumberedScene number_triangles(const Scene& scene, const Profile& profile, Isa isa);

/// The facet at each pixel's centre in the first, second ... opaque layer, as draw_layers() has
/// them. Facets are numbered as the scene's triangles, object by object. `hidden` is as
/// PreparedScene has it.
std::vector<std::vector<SeenFacet>> draw_seen_facets(NumberedScene& numbered, const Scene& scene,
                                                     const CameraMatrices& camera, double frame,
                                                     int width, int height, std::size_t layers,
                                                     ThreadPool& pool,
                                                     std::optional<float> behind_before,
                                                     std::span<const std::uint8_t> hidden = {});

}  // namespace softfocus
