#pragma once
// A mesh that rays meet, as Embree takes it.

#include "scenes/embree/embree.h"
#include "scenes/lens_views/ray_geometry.h"

namespace softfocus {

/// Refers to the mesh, which gets a position more: Embree reads 16 bytes of the last one. Filters
/// find the mesh in geometryUserPtr.
inline EmbreeGeometry embree_mesh(const EmbreeDevice& device, RayMesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  mesh.positions.emplace_back(0.0f);
  EmbreeGeometry geometry =
      embree_triangles(device, &mesh.positions[0].x, vertices, mesh.draw.input.mesh->indices);
  rtcSetGeometryUserData(geometry.get(), &mesh);
  return geometry;
}

}  // namespace softfocus
