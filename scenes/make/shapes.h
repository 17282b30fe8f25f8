#pragma once
// The shapes of geometry books as meshes: closed (but for the plane), with unit normals
// and uvs, counter-clockwise from outside. Sizes are metres and above 0. Points that
// two grids share have the same bits, so that welding by position closes each shape.

#include <glm/vec2.hpp>

#include "scenes/scene.h"

namespace softfocus {

/// About the origin. `segments` >= 3 around the y axis, `rings` >= 2 from pole to pole:
/// 2 segments (rings - 1) triangles. u runs around eastwards from +z, v from the
/// north pole down.
Mesh make_sphere(double radius, int segments, int rings);

/// About the origin, the hole along y. `ring_radius` goes from the centre to the
/// middle of the tube, `tube_radius` < ring_radius. 2 segments sides triangles, both
/// counts >= 3. u runs around the ring, v around the tube from the top outwards.
Mesh make_torus(double ring_radius, double tube_radius, int segments, int sides);

/// Stands on y = 0 with the tip at y = height and a base cap; the side is cut into
/// `rings` >= 1 bands, `segments` >= 3: 2 segments rings triangles with the cap.
Mesh make_cone(double radius, double height, int segments, int rings);

/// About the origin, `size` along each edge, six faces of cells x cells, each with
/// the whole texture: 12 cells^2 triangles. Lighting is by vertex, so a face near a
/// lamp needs cells.
Mesh make_cube(double size, int cells);

/// About the origin in y = 0, facing up: `width` along x, `depth` along z,
/// 2 cells_x cells_z triangles. u along x, v along z.
Mesh make_plane(double width, double depth, int cells_x, int cells_z);

/// The shape as a room: winding and normals flipped, u mirrored, so that a picture on
/// a wall still reads the right way round.
Mesh inside_out(Mesh mesh);

/// Lets the texture repeat: multiplies every uv.
void repeat_uvs(Mesh& mesh, glm::dvec2 times);

}  // namespace softfocus
