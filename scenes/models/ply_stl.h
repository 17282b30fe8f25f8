#pragma once
// PLY models (Turk 1994) and STL models (3D Systems 1988), as faces that are finished like OBJ's.
//
// Not Assimp's readers: its PLY reader of version 5.2 hangs on one damaged file of fifteen, crashes
// on some, and multiplies decimals out with the C library's pow.

#include <glm/vec3.hpp>
#include <string>
#include <string_view>

#include "scenes/models/obj_text.h"

namespace softfocus {

struct FileFaces {
  ObjText faces;           ///< positions less `origin`
  glm::dvec3 origin{0.0};  ///< as of Model
  std::string texture{};   ///< as the file names it, or none
};

/// Reads text and binary of either byte order. Understands, of whatever type,
///   vertex   x y z; nx ny nz; red green blue or r g b, perhaps diffuse_ before, of whole numbers
///            along the sRGB curve; s t or u v, perhaps texture_ before
///   face     vertex_indices or vertex_index; texcoord, u and v a corner
///   tristrips   vertex_indices, where -1 begins another strip
///   comment TextureFile
/// and passes over the rest. Tolerates what parse_obj_text() does. Throws SceneError for another
/// header, a file that is cut off, a face with a position that is none, an index out of range, a
/// face of too many corners, and points alone. `file` is for complaints.
FileFaces parse_ply(std::string_view bytes, const std::string& file);

/// Reads text and binary. Facets are flat and as they are wound: their normals, colours and
/// attributes are passed over. A facet with a position that is none is left out, with a warning.
/// Throws SceneError for a file that is cut off, a word in the wrong place (with the line), and a
/// file without a facet.
FileFaces parse_stl(std::string_view bytes, const std::string& file);

// What both share.

/// Whether its coordinates are numbers within kLargestCoordinate.
bool is_position(glm::dvec3 p);

/// Subtracts the middle, if it is far, of the positions that faces have, and rounds.
void place_positions(const std::vector<glm::dvec3>& exact, FileFaces& made);

}  // namespace softfocus
