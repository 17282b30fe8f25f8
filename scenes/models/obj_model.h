#pragma once
// Wavefront OBJ models with their MTL materials, as they are found in the wild.

#include <filesystem>

#include "raster/threads/parallel.h"
#include "scenes/models/model.h"
#include "scenes/models/mtl_file.h"
#include "scenes/models/obj_text.h"

namespace softfocus {

/// Reads a model, its materials, which are two-sided, and their textures: one part a material that
/// is used, in the order of first use. Throws SceneError for a file that is missing or no OBJ, a
/// number that is none, an index out of range (with the line), a model without a face, and a
/// texture that is there and cannot be read. A missing material library, material or texture is a
/// warning, and neutral grey stands in. So is what parse_obj_text() tolerates.
///
/// A face whose corners lie where another's do, in the same or the reverse order, is left out; a
/// warning counts them. The first one of the file stays, with its material.
///
/// Of a model that is far from the origin for its size, as a map's coordinates are, the middle
/// is subtracted before positions are rounded, and a warning tells it. If all materials in use
/// are invisible, they are opaque instead. Vertex colours come with the meshes.
///
/// Polygons become triangles. Missing normals are made: of a smooth surface, or as the
/// smoothing groups say where there are any. Faces without normals are turned to fit
/// their neighbours (triangles_to_turn()). A face whose winding opposes the normals
/// given for it is turned round. v of the texture coordinates, which OBJ counts
/// upwards, is flipped. `pool`, if any, shares out the work.
Model load_obj_model(const std::filesystem::path& file, ThreadPool* pool = nullptr);

/// The same of faces that are read already, less `origin`, and of the materials that they name.
Model model_of_faces(ObjText obj, const std::filesystem::path& file, glm::dvec3 origin,
                     MtlMaterials materials, ThreadPool* pool);

}  // namespace softfocus
