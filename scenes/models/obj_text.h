#pragma once
// The text of an OBJ file as checked numbers.
//
// Not tinyobjloader's reader, though its MTL reader is used: it counts the corners of a
// face in 8 bits, checks no index, multiplies decimals out with the C library's pow
// (so that the last bit depends on the machine) and drops triangles of polygons that
// are small or far from the origin. Numbers here are rounded once, correctly.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "raster/threads/parallel.h"

namespace softfocus {

/// Takes the next word off a line of an OBJ or MTL file; empty at its end.
std::string_view next_word(std::string_view& line);
/// Without the blanks before and after.
std::string_view trimmed(std::string_view text);

/// Indices from 0; -1 where the file gives none.
struct ObjCorner {
  std::int32_t position = -1;
  std::int32_t uv = -1;
  std::int32_t normal = -1;
};

struct ObjFace {
  std::uint32_t first_corner = 0;
  std::uint32_t corner_count = 0;     ///< 3 to kMaxFaceCorners
  std::int32_t material = -1;         ///< into material_names
  std::uint32_t smoothing_group = 0;  ///< 0: flat
};

struct ObjText {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> colours;  ///< one a position, 0 to 1; none if the file has none
  std::vector<glm::vec2> uvs;      ///< v as the file has it, upwards
  std::vector<glm::vec3> normals;
  std::vector<ObjCorner> corners;
  std::vector<ObjFace> faces;
  std::vector<std::string> material_names;  ///< in the order of first use
  std::vector<std::string> libraries;       ///< what follows each mtllib
  bool has_smoothing_groups = false;        ///< whether there is any `s`
  std::vector<std::string> warnings;        ///< what was left out, a line a kind, counted
};

inline constexpr std::uint32_t kMaxFaceCorners = 1024;

/// Understands v (x y z, and perhaps r g b), vt, vn, f, s, usemtl, mtllib and lines continued by a
/// backslash, and passes over the rest (groups, lines, curves). `file` is for complaints. `origin`
/// is subtracted from positions, in double precision before they are rounded. Exporters write some
/// things that do no harm. A warning counts them:
///   a face of fewer than 3 corners                   is left out
///   a texture coordinate that is no number, or past kLargestCoordinate   is 0
///   a normal that is none                            counts as not given
///   a corner whose texture coordinate is not there   has none
///   colours beyond 1                                 are taken for 0 to 255
/// Throws SceneError for what is not text, a position that is none, another index out of range, a
/// face of too many corners, and a file without a face.
/// `pool`, if any, reads pieces of the text side by side.
ObjText parse_obj_text(std::string_view text, const std::string& file,
                       glm::dvec3 origin = glm::dvec3{0.0}, ThreadPool* pool = nullptr);

}  // namespace softfocus
