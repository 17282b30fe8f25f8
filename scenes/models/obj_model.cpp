#include "scenes/models/obj_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <glm/common.hpp>
#include <limits>
#include <string>

#include "raster/numbers/vector_math.h"
#include "scenes/files/file_bytes.h"
#include "scenes/files/scene_error.h"
#include "scenes/make/polygon.h"
#include "scenes/models/first_come_numbers.h"
#include "scenes/models/mtl_file.h"
#include "scenes/models/obj_faces.h"
#include "scenes/models/obj_text.h"

namespace softfocus {
namespace {

constexpr std::size_t kMaxObjBytes = std::size_t{1} << 29;

// `which` in ascending order.
void drop_faces(std::span<const std::uint32_t> which, std::vector<ObjFace>& faces) {
  std::uint32_t face = 0;
  std::size_t dropped = 0;
  std::erase_if(faces, [&](const ObjFace&) {
    const bool drops = dropped < which.size() && which[dropped] == face++;
    dropped += drops ? 1 : 0;
    return drops;
  });
}

// Three corners whose normals index all_normals below.
struct ObjTriangle {
  std::array<ObjCorner, 3> corners;
  std::uint32_t face = 0;
  glm::dvec3 area_normal{0.0};  // its length is twice the area
};

FirstComeNumbers::Key key_of(const ObjCorner& corner) {
  return {static_cast<std::uint32_t>(corner.position), static_cast<std::uint32_t>(corner.uv),
          static_cast<std::uint32_t>(corner.normal)};
}

// A normal of length 0 counts as none.
bool has_normal(const ObjText& obj, const ObjCorner& corner) {
  return corner.normal >= 0 &&
         obj.normals[static_cast<std::size_t>(corner.normal)] != glm::vec3{0.0f};
}

// Whether the normals given for a triangle point to its other side.
bool is_wound_against_normals(const ObjText& obj, const ObjTriangle& triangle) {
  double agreement = 0.0;
  for (const ObjCorner& corner : triangle.corners) {
    if (!has_normal(obj, corner)) return false;
    const glm::dvec3 given{obj.normals[static_cast<std::size_t>(corner.normal)]};
    agreement += dot(triangle.area_normal, normalize(given));
  }
  return agreement < 0.0;
}

// Those with an area.
std::vector<ObjTriangle> make_triangles(const ObjText& obj) {
  const auto place = [&](const ObjCorner& corner) {
    return glm::dvec3{obj.positions[static_cast<std::size_t>(corner.position)]};
  };
  std::vector<ObjTriangle> triangles;
  triangles.reserve(obj.faces.size());
  std::vector<glm::dvec3> outline;
  for (std::size_t f = 0; f < obj.faces.size(); ++f) {
    const ObjFace& face = obj.faces[f];
    const ObjCorner* corners = &obj.corners[face.first_corner];
    outline.clear();
    for (std::uint32_t i = 0; i < face.corner_count; ++i) outline.push_back(place(corners[i]));
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      ObjTriangle triangle{{corners[a], corners[b], corners[c]}, static_cast<std::uint32_t>(f)};
      triangle.area_normal = cross(outline[b] - outline[a], outline[c] - outline[a]);
      if (triangle.area_normal == glm::dvec3{0.0}) return;
      if (is_wound_against_normals(obj, triangle)) {
        std::swap(triangle.corners[1], triangle.corners[2]);
        triangle.area_normal = -triangle.area_normal;
      }
      triangles.push_back(triangle);
    };
    if (face.corner_count == 3) {  // most are
      add(0, 1, 2);
      continue;
    }
    for (const auto& [a, b, c] : triangulate_polygon(outline)) add(a, b, c);
  }
  return triangles;
}

// Faces whose normals are made need neighbours that are wound alike: else the sums cancel.
void turn_alike(const ObjText& obj, const std::vector<std::uint32_t>& place_of,
                std::vector<ObjTriangle>& triangles, ThreadPool& pool) {
  std::vector<std::size_t> without_normals;
  std::vector<std::array<std::uint32_t, 3>> places;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto& corners = triangles[i].corners;
    if (std::all_of(corners.begin(), corners.end(),
                    [&](const ObjCorner& corner) { return has_normal(obj, corner); })) {
      continue;
    }
    without_normals.push_back(i);
    auto& of_triangle = places.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      of_triangle[k] = place_of[static_cast<std::size_t>(corners[k].position)];
    }
  }
  const std::vector<bool> turned = triangles_to_turn(places, pool);
  for (std::size_t i = 0; i < turned.size(); ++i) {
    if (!turned[i]) continue;
    ObjTriangle& triangle = triangles[without_normals[i]];
    std::swap(triangle.corners[1], triangle.corners[2]);
    triangle.area_normal = -triangle.area_normal;
  }
}

// Gives every corner a normal: the one given, the mean over the triangles that meet at
// its place in its smoothing group (weighted by area), or its triangle's own. Returns
// the normals that the corners then refer to.
std::vector<glm::vec3> complete_normals(const ObjText& obj,
                                        const std::vector<std::uint32_t>& place_of,
                                        std::vector<ObjTriangle>& triangles) {
  std::vector<glm::vec3> all_normals;
  for (const glm::vec3& normal : obj.normals) {
    all_normals.emplace_back(normalize(glm::dvec3{normal}));
  }
  // A file without smoothing groups means a smooth surface more often than a flat one.
  const auto group_of = [&](const ObjTriangle& triangle) {
    return obj.has_smoothing_groups ? obj.faces[triangle.face].smoothing_group : 1;
  };

  FirstComeNumbers sums;
  std::vector<glm::dvec3> sum_of(obj.has_smoothing_groups ? 0 : place_of.size());
  const auto sum_number = [&](const ObjTriangle& triangle, const ObjCorner& corner) {
    const std::uint32_t place = place_of[static_cast<std::size_t>(corner.position)];
    if (!obj.has_smoothing_groups) return place;
    const auto [number, is_new] = sums.number({place, group_of(triangle), 0});
    if (is_new) sum_of.emplace_back(0.0);
    return number;
  };
  for (const ObjTriangle& triangle : triangles) {
    if (group_of(triangle) == 0) continue;
    for (const ObjCorner& corner : triangle.corners) {
      sum_of[sum_number(triangle, corner)] += triangle.area_normal;
    }
  }

  const auto first_sum = static_cast<std::uint32_t>(all_normals.size());
  for (const glm::dvec3& sum : sum_of) all_normals.emplace_back(normalize(sum));
  for (ObjTriangle& triangle : triangles) {
    std::optional<std::uint32_t> own;
    for (ObjCorner& corner : triangle.corners) {
      if (has_normal(obj, corner)) continue;
      std::uint32_t normal = 0;
      if (group_of(triangle) != 0) normal = first_sum + sum_number(triangle, corner);
      // Flat, or a sum in which opposite sides cancel.
      if (group_of(triangle) == 0 || all_normals[normal] == glm::vec3{0.0f}) {
        if (!own) {
          own = static_cast<std::uint32_t>(all_normals.size());
          all_normals.emplace_back(normalize(triangle.area_normal));
        }
        normal = *own;
      }
      corner.normal = static_cast<std::int32_t>(normal);
    }
  }
  return all_normals;
}

// A part that is being filled: corners that are equal share a vertex.
struct GrowingPart {
  Model::Part part;
  FirstComeNumbers corners;              // of positions that have several vertices
  std::vector<std::uint32_t> vertex_of;  // by their numbers
  bool has_uvs = false;
};

// The last vertex of a position. Most positions have but one, which no table needs to hold.
struct LastVertex {
  GrowingPart* part = nullptr;
  ObjCorner corner;
  std::uint32_t number = 0;
  bool is_in_table = false;
};

// Its vertex, the next if the corner is new.
std::uint32_t vertex_of(GrowingPart& growing, const ObjCorner& corner, std::uint32_t next) {
  const auto [number, is_new] = growing.corners.number(key_of(corner));
  if (is_new) growing.vertex_of.push_back(next);
  return growing.vertex_of[number];
}

void append_corner(GrowingPart& growing, const ObjText& obj,
                   const std::vector<glm::vec3>& all_normals, const ObjCorner& corner,
                   LastVertex& last) {
  Mesh& mesh = growing.part.mesh;
  if (last.part == &growing && last.corner.uv == corner.uv && last.corner.normal == corner.normal) {
    mesh.indices.push_back(last.number);
    return;
  }
  const auto next = static_cast<std::uint32_t>(mesh.positions.size());
  std::uint32_t vertex = next;
  if (last.part != nullptr) {
    if (!last.is_in_table) vertex_of(*last.part, last.corner, last.number);
    vertex = vertex_of(growing, corner, next);
  }
  last = {&growing, corner, vertex, last.part != nullptr};
  mesh.indices.push_back(vertex);
  if (vertex != next) return;
  const auto position = static_cast<std::size_t>(corner.position);
  mesh.positions.push_back(obj.positions[position]);
  if (!obj.colours.empty()) mesh.colours.push_back(obj.colours[position]);
  mesh.normals.push_back(all_normals[static_cast<std::size_t>(corner.normal)]);
  glm::vec2 uv{0.0f};
  if (corner.uv >= 0) {
    uv = obj.uvs[static_cast<std::size_t>(corner.uv)];
    uv.y = 1.0f - uv.y;
    growing.has_uvs = true;
  }
  mesh.uvs.push_back(uv);
}

void load_libraries(const ObjText& obj, const std::filesystem::path& file,
                    MtlMaterials& materials) {
  const auto try_library = [&](const std::filesystem::path& library) {
    std::error_code unknown;
    if (!std::filesystem::is_regular_file(library, unknown)) return false;
    load_mtl(library, materials);
    return true;
  };
  for (const std::string& written : obj.libraries) {
    // One name, in which there may be blanks, or several names.
    if (try_library(file.parent_path() / written)) continue;
    std::size_t start = 0;
    while (start < written.size()) {
      const std::size_t end = std::min(written.find_first_of(" \t", start), written.size());
      const std::string name = written.substr(start, end - start);
      if (!name.empty() && !try_library(file.parent_path() / name)) {
        materials.warnings.push_back(file.string() + ": material library " + name +
                                     " is missing; neutral grey stands in");
      }
      start = end + 1;
    }
  }
}

// The materials by the numbers that the faces have, neutral grey for none at the end.
std::vector<Material> list_materials(const ObjText& obj, const std::filesystem::path& file,
                                     MtlMaterials& from) {
  std::vector<Material> materials;
  for (const std::string& name : obj.material_names) {
    const auto found = from.by_name.find(name);
    if (found == from.by_name.end()) {
      from.warnings.push_back(file.string() + ": material " + name +
                              " is not defined; neutral grey stands in");
    }
    materials.push_back(found != from.by_name.end() ? found->second : neutral_grey());
  }
  materials.push_back(neutral_grey());
  return materials;
}

void check_size(const std::vector<ObjTriangle>& triangles, const ObjText& obj,
                const std::filesystem::path& file) {
  constexpr float kSmallest = 1e-9f;  // lengths are squared in binary32
  for (const ObjTriangle& triangle : triangles) {
    const auto place = [&](const ObjCorner& corner) {
      return obj.positions[static_cast<std::size_t>(corner.position)];
    };
    for (const ObjCorner& corner : triangle.corners) {
      const glm::vec3 extent = place(corner) - place(triangles[0].corners[0]);
      for (int axis = 0; axis < 3; ++axis) {
        if (std::fabs(extent[axis]) >= kSmallest) return;
      }
    }
  }
  throw SceneError(file.string() +
                   ": no face has an area; a model at least 1e-9 across would be right");
}

// As far_middle() of the corners.
glm::dvec3 middle_of(const ObjText& obj) {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high = -low;
  for (const ObjCorner& corner : obj.corners) {
    const glm::dvec3 p{obj.positions[static_cast<std::size_t>(corner.position)]};
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return far_middle(low, high);
}

// Makes a model opaque of which nothing would show. Exporters take d and Tr for each other.
void show_invisible(const ObjText& obj, const std::filesystem::path& file, Model& model) {
  const auto is_shown = [&](const ObjFace& face) {
    return face.material < 0 ||
           model.materials[static_cast<std::size_t>(face.material)].opacity > 0;
  };
  if (std::any_of(obj.faces.begin(), obj.faces.end(), is_shown)) return;
  for (Material& material : model.materials) {
    if (material.opacity > 0.0f) continue;
    material.opacity = 1.0f;
    model.warnings.push_back(printable(file.string() + ": material " + material.name +
                                       " is invisible, as all of the model would be; it is drawn "
                                       "opaque"));
  }
}

}  // namespace

Model model_of_faces(ObjText obj, const std::filesystem::path& file, glm::dvec3 origin,
                     MtlMaterials library, ThreadPool* pool) {
  if (pool == nullptr) {
    ThreadPool here{1};
    return model_of_faces(std::move(obj), file, origin, std::move(library), &here);
  }
  std::vector<std::uint32_t> place_of, doubled;
  std::vector<ObjTriangle> triangles;
  // Few are doubled. Polygons are not taken apart in vain: that is slow.
  const bool are_triangles = obj.corners.size() == 3 * obj.faces.size();
  pool->for_each(are_triangles ? 2 : 1, [&](int task) {
    if (task == 0) {
      place_of = number_places(obj);
      doubled = doubled_faces(obj, place_of);
    } else {
      triangles = make_triangles(obj);
    }
  });
  const std::size_t face_count = obj.faces.size();
  if (!doubled.empty()) {
    drop_faces(doubled, obj.faces);
    triangles = {};
  }
  if (triangles.empty()) triangles = make_triangles(obj);
  check_size(triangles, obj, file);
  turn_alike(obj, place_of, triangles, *pool);
  const std::vector<glm::vec3> all_normals = complete_normals(obj, place_of, triangles);

  Model model;
  model.origin = origin;
  model.materials = list_materials(obj, file, library);
  model.textures = std::move(library.textures);
  model.files = std::move(library.files);
  model.files.push_back(file);
  for (const std::string& warning : obj.warnings) model.warnings.push_back(printable(warning));
  show_invisible(obj, file, model);
  if (origin != glm::dvec3{0.0}) {
    model.warnings.push_back(far_warning(file, origin));
  }
  if (!doubled.empty()) {
    model.warnings.push_back(printable(file.string()) + ": " + std::to_string(doubled.size()) +
                             " of " + std::to_string(face_count) +
                             " faces are there before, perhaps reversed; each is drawn once");
  }
  for (const std::string& warning : library.warnings) {
    model.warnings.push_back(printable(warning));
  }

  const std::size_t without_material = obj.material_names.size();
  std::deque<GrowingPart> growing;  // which stay where they are
  std::vector<LastVertex> last_vertices(obj.positions.size());
  std::vector<std::optional<std::size_t>> part_of(model.materials.size());
  for (const ObjTriangle& triangle : triangles) {
    const std::int32_t named = obj.faces[triangle.face].material;
    const std::size_t material = named >= 0 ? static_cast<std::size_t>(named) : without_material;
    if (!part_of[material]) {
      part_of[material] = growing.size();
      Model::Part& part = growing.emplace_back().part;
      part.material = static_cast<std::uint32_t>(material);
      if (named >= 0) {
        const auto placed = library.placements.find(obj.material_names[material]);
        if (placed != library.placements.end()) part.placement = placed->second;
      }
    }
    for (const ObjCorner& corner : triangle.corners) {
      append_corner(growing[*part_of[material]], obj, all_normals, corner,
                    last_vertices[static_cast<std::size_t>(corner.position)]);
    }
  }
  for (GrowingPart& part : growing) {
    if (!part.has_uvs) part.part.mesh.uvs.clear();
    model.parts.push_back(std::move(part.part));
  }
  return model;
}

Model load_obj_model(const std::filesystem::path& file, ThreadPool* pool) {
  const std::string text = read_file_text(file, kMaxObjBytes);
  ObjText obj = parse_obj_text(text, file.string(), glm::dvec3{0.0}, pool);
  const glm::dvec3 origin = middle_of(obj);
  if (origin != glm::dvec3{0.0}) obj = parse_obj_text(text, file.string(), origin, pool);
  MtlMaterials library;
  load_libraries(obj, file, library);
  return model_of_faces(std::move(obj), file, origin, std::move(library), pool);
}

}  // namespace softfocus
