#include "scenes/load/gltf_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <limits>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "scenes/load/gltf_materials.h"
#include "scenes/load/obj_text.h"

namespace softfocus {
namespace {

// Of nodes, one below the other.
constexpr int kMostDepth = 1000;

// How the base colour's texture coordinates are placed (KHR_texture_transform).
struct UvTransform {
  int set = 0;  // TEXCOORD_n
  glm::dvec2 offset{0.0}, scale{1.0};
  double sine = 0.0, cosine = 1.0;

  glm::vec2 operator()(double u, double v) const {
    const double x = u * scale.x, y = v * scale.y;
    return {static_cast<float>(offset.x + cosine * x + sine * y),
            static_cast<float>(offset.y - sine * x + cosine * y)};
  }
};

UvTransform uv_transform(const ShownColour& shown) {
  UvTransform made;
  made.set = shown.uv_set;
  const tinygltf::Value* transform = extension(*shown.extensions, "KHR_texture_transform");
  if (transform == nullptr) return made;
  if (const int set = index_in(*transform, "texCoord"); set >= 0) made.set = set;
  for (std::size_t i = 0; i < 2; ++i) {
    const int axis = static_cast<int>(i);
    made.offset[axis] = number_in(*transform, "offset", i, 0.0);
    made.scale[axis] = number_in(*transform, "scale", i, 1.0);
  }
  constexpr double kDegrees = 57.295779513082320877;
  const double degrees = number_in(*transform, "rotation", 0.0) * kDegrees;
  made.sine = exact_math::sin_degrees(degrees);
  made.cosine = exact_math::sin_degrees(degrees + 90.0);
  return made;
}

glm::dmat4 own_matrix(const tinygltf::Node& node) {
  glm::dmat4 m{1.0};
  if (node.matrix.size() == 16) {
    for (std::size_t i = 0; i < 16; ++i) {
      m[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = node.matrix[i];
    }
    return m;
  }
  if (node.rotation.size() == 4) {
    double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
    const double length = std::sqrt(x * x + y * y + z * z + w * w);
    if (length > 0.0) {
      x /= length;
      y /= length;
      z /= length;
      w /= length;
      m[0] = {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w), 0.0};
      m[1] = {2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w), 0.0};
      m[2] = {2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y), 0.0};
    }
  }
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (node.scale.size() == 3) m[i] = m[i] * node.scale[at];
    if (node.translation.size() == 3) m[3][i] = node.translation[at];
  }
  return m;
}

glm::dvec3 place(const glm::dmat4& m, glm::dvec3 p) {
  return glm::dvec3{((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3]};
}

struct PlacedNode {
  int number;
  glm::dmat4 to_world;
};

// The nodes of the file's scene, parents first.
std::vector<PlacedNode> placed_nodes(const GltfFile& reader) {
  const tinygltf::Model& gltf = reader.gltf;
  struct Open {
    int node, depth;
    glm::dmat4 parent;
  };
  std::vector<Open> open;
  if (!gltf.scenes.empty()) {
    const tinygltf::Scene& scene =
        item_of(reader, gltf.scenes, std::max(gltf.defaultScene, 0), "scene");
    for (const int node : scene.nodes) open.push_back({node, 0, glm::dmat4{1.0}});
  } else {
    std::set<int> children;
    for (const tinygltf::Node& node : gltf.nodes) {
      children.insert(node.children.begin(), node.children.end());
    }
    for (int i = 0; i < static_cast<int>(gltf.nodes.size()); ++i) {
      if (!children.contains(i)) open.push_back({i, 0, glm::dmat4{1.0}});
    }
  }
  std::reverse(open.begin(), open.end());
  std::vector<bool> is_seen(gltf.nodes.size());
  std::vector<PlacedNode> placed;
  while (!open.empty()) {
    const Open next = open.back();
    open.pop_back();
    const tinygltf::Node& node = item_of(reader, gltf.nodes, next.node, "node");
    const auto number = static_cast<std::size_t>(next.node);
    if (is_seen[number]) {
      fail_gltf(reader, numbered("node", number) +
                            " is in two places, or below itself; a tree would be right");
    }
    if (next.depth > kMostDepth) {
      fail_gltf(reader, numbered("node", number) + " lies below more than " +
                            std::to_string(kMostDepth) + " others");
    }
    is_seen[number] = true;
    placed.push_back({next.node, multiply(next.parent, own_matrix(node))});
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
      open.push_back({*child, next.depth + 1, placed.back().to_world});
    }
  }
  return placed;
}

// Of a skin's joints: world of the joint times the inverse of its bind pose. `worlds` are those of
// all nodes, null outside the scene.
std::vector<glm::dmat4> joint_matrices(GltfFile& reader, const tinygltf::Skin& skin,
                                       std::span<const glm::dmat4* const> worlds) {
  std::optional<GltfNumbers> inverse;
  if (skin.inverseBindMatrices >= 0) inverse = read_accessor(reader, skin.inverseBindMatrices);
  if (inverse && (inverse->width != 16 || inverse->count() < skin.joints.size())) {
    fail_gltf(reader, "a skin has fewer inverseBindMatrices than joints");
  }
  std::vector<glm::dmat4> matrices;
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    item_of(reader, reader.gltf.nodes, skin.joints[i], "node");
    const glm::dmat4* const world = worlds[static_cast<std::size_t>(skin.joints[i])];
    glm::dmat4 matrix = world != nullptr ? *world : glm::dmat4{1.0};
    if (inverse) {
      glm::dmat4 bind{1.0};
      for (std::size_t k = 0; k < 16; ++k) {
        bind[static_cast<int>(k / 4)][static_cast<int>(k % 4)] = (*inverse)[i][k];
      }
      matrix = multiply(matrix, bind);
    }
    matrices.push_back(matrix);
  }
  return matrices;
}

struct PlacedVertices {
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;  // none: those of the triangles
  std::vector<glm::vec2> uvs;
  std::vector<glm::vec3> colours;
};

// Parts grow in binary64 until the model's middle is known.
struct GltfPart {
  std::uint32_t material;
  bool has_uvs, has_colours;
  std::vector<glm::dvec3> positions{};
  Mesh mesh{};
};

// Adds the targets' attribute. False if one that counts has none.
bool add_morph_targets(GltfFile& reader, const tinygltf::Primitive& primitive,
                       std::span<const double> weights, const std::string& name,
                       GltfNumbers& numbers) {
  bool have_all = true;
  for (std::size_t i = 0; i < primitive.targets.size() && i < weights.size(); ++i) {
    if (weights[i] == 0.0) continue;
    const auto moved = read_attribute(reader, primitive.targets[i], name, numbers.count(), 3, 3);
    have_all = have_all && moved;
    if (!moved) continue;
    for (std::size_t k = 0; k < numbers.values.size(); ++k) {
      numbers.values[k] += weights[i] * moved->values[k];
    }
  }
  return have_all;
}

// The directions across a surface go with the inverse transpose, here times the determinant.
glm::dvec3 turned_normal(const glm::dmat4& m, glm::dvec3 n) {
  const glm::dvec3 x{m[0]}, y{m[1]}, z{m[2]};
  return (cross(y, z) * n.x + cross(z, x) * n.y) + cross(x, y) * n.z;
}

bool mirrors_space(const glm::dmat4& m) {
  return dot(glm::dvec3{m[0]}, cross(glm::dvec3{m[1]}, glm::dvec3{m[2]})) < 0.0;
}

// A vertex's matrix: the node's, or the mean of its joints'.
class VertexMatrices {
 public:
  VertexMatrices(GltfFile& reader, const tinygltf::Primitive& primitive, std::size_t count,
                 const glm::dmat4& to_world, std::span<const glm::dmat4> joints)
      : to_world_(to_world), joints_(joints) {
    for (int set = 0; !joints.empty(); ++set) {
      const std::string end = std::to_string(set);
      auto numbers = read_attribute(reader, primitive.attributes, "JOINTS_" + end, count, 4, 4);
      auto weights = read_attribute(reader, primitive.attributes, "WEIGHTS_" + end, count, 4, 4);
      if (!numbers || !weights) break;
      for (const double joint : numbers->values) {
        if (!(joint >= 0.0 && joint < static_cast<double>(joints.size()))) {
          fail_gltf(reader, "a vertex names a joint past the " + std::to_string(joints.size()) +
                                " of its skin");
        }
      }
      sets_.push_back({std::move(*numbers), std::move(*weights)});
    }
  }
  glm::dmat4 operator()(std::size_t vertex) const {
    glm::dmat4 mean{0.0};
    double all = 0.0;
    for (const Set& set : sets_) {
      for (std::size_t i = 0; i < 4; ++i) {
        const double weight = set.weights[vertex][i];
        if (!(weight > 0.0)) continue;
        const glm::dmat4& of = joints_[static_cast<std::size_t>(set.joints[vertex][i])];
        for (int column = 0; column < 4; ++column) {
          mean[column] = mean[column] + of[column] * weight;
        }
        all += weight;
      }
    }
    if (all == 0.0) return to_world_;
    for (int column = 0; column < 4; ++column) mean[column] = mean[column] / all;
    return mean;
  }

 private:
  struct Set {
    GltfNumbers joints, weights;
  };
  const glm::dmat4& to_world_;
  std::span<const glm::dmat4> joints_;
  std::vector<Set> sets_{};
};

glm::vec3 vertex_colour(const double* colour) {
  glm::vec3 made{0.0f};
  for (int k = 0; k < 3; ++k) {
    if (colour[k] > 0.0) made[k] = static_cast<float>(std::min(colour[k], 1.0));
  }
  return made;
}

// A primitive's attributes; its vertices `used` alone are placed: several primitives may share
// them.
PlacedVertices place_vertices(GltfFile& reader, const tinygltf::Primitive& primitive,
                              GltfNumbers positions, std::span<const std::uint32_t> used,
                              std::span<const double> morph_weights, const UvTransform& uvs,
                              const glm::dmat4& to_world, std::span<const glm::dmat4> joints) {
  const std::size_t count = positions.count();
  add_morph_targets(reader, primitive, morph_weights, "POSITION", positions);
  auto normals = read_attribute(reader, primitive.attributes, "NORMAL", count, 3, 3);
  if (normals && !add_morph_targets(reader, primitive, morph_weights, "NORMAL", *normals)) {
    normals.reset();
  }
  const auto coordinates = read_attribute(reader, primitive.attributes,
                                          "TEXCOORD_" + std::to_string(uvs.set), count, 2, 2);
  const auto colours = read_attribute(reader, primitive.attributes, "COLOR_0", count, 3, 4);
  const VertexMatrices matrices(reader, primitive, count, to_world, joints);
  PlacedVertices placed;
  placed.positions.reserve(used.size());
  for (const std::uint32_t i : used) {
    const glm::dmat4 matrix = matrices(i);
    const glm::dvec3 p = place(matrix, positions.vec3(i));
    for (int axis = 0; axis < 3; ++axis) {
      if (!(std::fabs(p[axis]) <= kLargestCoordinate)) {
        fail_gltf(reader, "a position is no number, or beyond 1e9");
      }
    }
    placed.positions.push_back(p);
    if (normals) {
      const glm::dvec3 n = normalize(turned_normal(matrix, normals->vec3(i)));
      placed.normals.push_back(mirrors_space(matrix) ? -n : n);
    }
    if (coordinates) {
      const glm::vec2 uv = uvs((*coordinates)[i][0], (*coordinates)[i][1]);
      const bool is_number =
          std::fabs(uv.x) <= kLargestCoordinate && std::fabs(uv.y) <= kLargestCoordinate;
      placed.uvs.push_back(is_number ? uv : glm::vec2{0.0f});
    }
    if (colours) placed.colours.push_back(vertex_colour((*colours)[i]));
    if (colours && colours->width == 4 && (*colours)[i][3] < 1.0) {
      warn_gltf(reader, "the opacity of vertex colours is left out");
    }
  }
  return placed;
}

// The corners of triangles, of lists, strips and fans.
std::vector<std::uint32_t> corners_of(GltfFile& reader, const tinygltf::Primitive& primitive,
                                      std::size_t count) {
  std::vector<std::uint32_t> order;
  if (primitive.indices >= 0) {
    const GltfNumbers indices = read_accessor(reader, primitive.indices);
    if (indices.width != 1 || !indices.is_whole) {
      fail_gltf(reader, "indices are not unsigned whole numbers");
    }
    for (const double index : indices.values) {
      if (index >= static_cast<double>(count)) {
        fail_gltf(reader, "an index is " + std::to_string(static_cast<long long>(index)) + " of " +
                              std::to_string(count) + " vertices");
      }
      order.push_back(static_cast<std::uint32_t>(index));
    }
  } else {
    for (std::size_t i = 0; i < count; ++i) order.push_back(static_cast<std::uint32_t>(i));
  }
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES) {
    order.resize(order.size() / 3 * 3);
    return order;
  }
  std::vector<std::uint32_t> corners;
  const bool is_fan = primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
  for (std::size_t i = 2; i < order.size(); ++i) {
    const std::size_t odd = i % 2;
    const std::array<std::size_t, 3> of =
        is_fan ? std::array{i - 1, i, std::size_t{0}} : std::array{i - 2, i - 1 + odd, i - odd};
    for (const std::size_t k : of) corners.push_back(order[k]);
  }
  return corners;
}

struct GltfParts {
  std::vector<GltfPart> parts{};
  std::map<std::tuple<std::uint32_t, bool, bool>, std::size_t> number_of{};
  std::size_t corners = 0;  // of all
};

// The part for a material, with or without coordinates and colours.
GltfPart& part_for(GltfParts& all, std::uint32_t material, bool has_uvs, bool has_colours) {
  const auto [entry, is_new] =
      all.number_of.try_emplace({material, has_uvs, has_colours}, all.parts.size());
  if (is_new) all.parts.emplace_back(GltfPart{material, has_uvs, has_colours});
  return all.parts[entry->second];
}

void append_vertex(GltfPart& part, const PlacedVertices& from, std::size_t i, glm::dvec3 normal) {
  part.positions.push_back(from.positions[i]);
  part.mesh.normals.emplace_back(normal);
  if (part.has_uvs) part.mesh.uvs.push_back(from.uvs[i]);
  if (part.has_colours) part.mesh.colours.push_back(from.colours[i]);
}

void append_triangles(GltfPart& part, const PlacedVertices& from,
                      std::span<const std::uint32_t> corners, bool turns) {
  const bool is_smooth = !from.normals.empty();
  const std::size_t first = part.positions.size();
  constexpr glm::dvec3 kAny{0.0, 1.0, 0.0};
  if (is_smooth) {
    for (std::size_t i = 0; i < from.positions.size(); ++i) {
      const glm::dvec3 n = from.normals[i];
      append_vertex(part, from, i, dot(n, n) > 0.5 ? n : kAny);
    }
  }
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    std::array<std::uint32_t, 3> of{corners[i], corners[i + 1], corners[i + 2]};
    if (turns) std::swap(of[1], of[2]);
    const glm::dvec3 a = from.positions[of[0]];
    const glm::dvec3 n = normalize(cross(from.positions[of[1]] - a, from.positions[of[2]] - a));
    for (const std::uint32_t corner : of) {
      if (!is_smooth) append_vertex(part, from, corner, n == glm::dvec3{0.0} ? kAny : n);
      part.mesh.indices.push_back(
          static_cast<std::uint32_t>(is_smooth ? first + corner : part.positions.size() - 1));
    }
  }
}

// Gives vertices numbers in the order of their first use; the used ones by these.
std::vector<std::uint32_t> used_vertices(std::span<std::uint32_t> corners, std::size_t count) {
  constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  std::vector<std::uint32_t> number_of(count, kUnused), used;
  for (std::uint32_t& corner : corners) {
    if (number_of[corner] == kUnused) {
      number_of[corner] = static_cast<std::uint32_t>(used.size());
      used.push_back(corner);
    }
    corner = number_of[corner];
  }
  return used;
}

// Whether the primitive is triangles that can be read; a warning tells what it is otherwise.
bool is_drawn(GltfFile& reader, const tinygltf::Primitive& primitive) {
  const bool are_triangles = primitive.mode == TINYGLTF_MODE_TRIANGLES ||
                             primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
                             primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
  if (!are_triangles) {
    warn_gltf(reader, "points and lines are left out");
    return false;
  }
  const auto positions = primitive.attributes.find("POSITION");
  if (positions == primitive.attributes.end()) {
    warn_gltf(reader, "a primitive without positions is left out");
    return false;
  }
  const tinygltf::Accessor& accessor =
      item_of(reader, reader.gltf.accessors, positions->second, "accessor");
  const bool is_packed = accessor.bufferView < 0 && !accessor.sparse.isSparse &&
                         extension(primitive.extensions, "KHR_draco_mesh_compression") != nullptr;
  if (is_packed) {
    fail_gltf(reader,
              "its geometry is packed (KHR_draco_mesh_compression); the same model without "
              "compression would do");
  }
  const bool is_empty =
      accessor.count == 0 ||
      (primitive.indices >= 0 &&
       item_of(reader, reader.gltf.accessors, primitive.indices, "accessor").count == 0);
  if (is_empty) warn_gltf(reader, "a primitive without vertices is left out");
  return !is_empty;
}

// Of all parts together.
constexpr std::size_t kMostGltfCorners = std::size_t{1} << 26;

void add_mesh(GltfFile& reader, const tinygltf::Node& node, const glm::dmat4& to_world,
              std::span<const glm::dmat4* const> worlds, GltfParts& parts) {
  const tinygltf::Mesh& mesh = item_of(reader, reader.gltf.meshes, node.mesh, "mesh");
  std::vector<glm::dmat4> joints;
  if (node.skin >= 0) {
    joints = joint_matrices(reader, item_of(reader, reader.gltf.skins, node.skin, "skin"), worlds);
  }
  const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
  for (const tinygltf::Primitive& primitive : mesh.primitives) {
    if (!is_drawn(reader, primitive)) continue;
    const auto material = static_cast<std::uint32_t>(
        primitive.material >= 0 ? primitive.material
                                : static_cast<int>(reader.gltf.materials.size()));
    UvTransform uvs;
    if (primitive.material >= 0) {
      uvs = uv_transform(shown_colour(
          reader, item_of(reader, reader.gltf.materials, primitive.material, "material")));
    }
    GltfNumbers positions = read_accessor(reader, primitive.attributes.at("POSITION"));
    if (positions.width != 3) fail_gltf(reader, "POSITION is not of three numbers");
    std::vector<std::uint32_t> corners = corners_of(reader, primitive, positions.count());
    const std::vector<std::uint32_t> used = used_vertices(corners, positions.count());
    parts.corners += corners.size();
    if (parts.corners > kMostGltfCorners) {
      fail_gltf(reader, "with its copies the model has more than " +
                            std::to_string(kMostGltfCorners / 3) + " triangles");
    }
    const PlacedVertices vertices = place_vertices(reader, primitive, std::move(positions), used,
                                                   weights, uvs, to_world, joints);
    append_triangles(part_for(parts, material, !vertices.uvs.empty(), !vertices.colours.empty()),
                     vertices, corners, mirrors_space(to_world));
  }
}

// In whole numbers the positions of all parts, less the model's middle if that is far.
void finish_parts(GltfFile& reader, std::vector<GltfPart>& parts) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  glm::dvec3 low{kFar}, high{-kFar};
  for (const GltfPart& part : parts) {
    for (const glm::dvec3& p : part.positions) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  constexpr double kSmallest = 1e-9;  // lengths are squared in binary32
  if (!(std::max({high.x - low.x, high.y - low.y, high.z - low.z}) >= kSmallest)) {
    fail_gltf(reader, "has no size; a model at least 1e-9 across would be right");
  }
  Model& model = reader.model;
  model.origin = far_middle(low, high);
  if (model.origin != glm::dvec3{0.0}) {
    model.warnings.push_back(far_warning(reader.path, model.origin));
  }
  for (GltfPart& part : parts) {
    for (const glm::dvec3& p : part.positions) part.mesh.positions.emplace_back(p - model.origin);
    part.positions = {};
    model.parts.push_back({std::move(part.mesh), part.material});
  }
}

void add_camera(GltfFile& reader, const tinygltf::Node& node, const glm::dmat4& to_world) {
  const tinygltf::Camera& from = item_of(reader, reader.gltf.cameras, node.camera, "camera");
  if (reader.model.camera) return;
  const double fov = from.perspective.yfov * 57.295779513082320877;
  if (from.type != "perspective") {
    warn_gltf(reader, "a camera that is not perspective is left out");
    return;
  }
  const glm::dvec3 place_of_eye{to_world[3]};
  const glm::dvec3 back = normalize(glm::dvec3{to_world[2]}),
                   up = normalize(glm::dvec3{to_world[1]});
  const glm::dvec3 right = cross(up, back);
  const bool can_look = std::max({std::fabs(place_of_eye.x), std::fabs(place_of_eye.y),
                                  std::fabs(place_of_eye.z)}) <= kLargestCoordinate &&
                        dot(right, right) > 1e-6;
  if (!(fov > 0.1 && fov < 170.0) || !can_look) {
    warn_gltf(reader, "a camera of " + std::to_string(fov) +
                          " degrees, or without a direction, is left out");
    return;
  }
  Camera camera;
  camera.position = place_of_eye - reader.model.origin;
  camera.target = camera.position - back;
  camera.up = up;
  camera.fov_y_degrees = fov;
  reader.model.camera = camera;
}

void add_light(GltfFile& reader, const tinygltf::Node& node, const glm::dmat4& to_world,
               glm::dvec3 middle, double size) {
  const tinygltf::Value* named = extension(node.extensions, "KHR_lights_punctual");
  const int number = named != nullptr ? index_in(*named, "light") : -1;
  if (number < 0 || static_cast<std::size_t>(number) >= reader.gltf.lights.size()) return;
  const tinygltf::Light& from = reader.gltf.lights[static_cast<std::size_t>(number)];
  Light light;
  double throws = from.intensity;
  if (from.type == "directional") {
    light.position_or_direction = glm::vec3{normalize(glm::dvec3{to_world[2]})};
    if (dot(light.position_or_direction, light.position_or_direction) == 0.0f) {
      warn_gltf(reader, "a light without a direction is left out");
      return;
    }
  } else {
    if (from.type == "spot") warn_gltf(reader, "a spot light shines in all directions");
    light.kind = LightKind::point;
    const glm::dvec3 at = glm::dvec3{to_world[3]} - reader.model.origin;
    light.position_or_direction = glm::vec3{at};
    // Within the model it counts as at its half size.
    const glm::dvec3 way = at - middle;
    throws /= std::max({dot(way, way), size * size / 16.0, 1e-12});
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const double colour = i < from.color.size() ? from.color[i] : 1.0;
    light.colour[static_cast<int>(i)] = static_cast<float>(std::max(colour * throws, 0.0));
  }
  reader.model.lights.push_back(light);
}

void level_lights(GltfFile& reader) {
  Model& model = reader.model;
  float most = 0.0f;
  for (const Light& light : model.lights) {
    most = std::max({most, light.colour.x, light.colour.y, light.colour.z});
  }
  if (!(most > 0.0f && most < std::numeric_limits<float>::infinity())) {
    model.lights.clear();
    return;
  }
  for (Light& light : model.lights) light.colour = light.colour / most;
  // As many as a scene file may have, the brightest.
  constexpr std::size_t kMostGltfLights = 64;
  const auto brightness = [](const Light& light) {
    return light.colour.x + light.colour.y + light.colour.z;
  };
  if (model.lights.size() > kMostGltfLights) {
    warn_gltf(reader, "of " + std::to_string(model.lights.size()) + " lights the brightest " +
                          std::to_string(kMostGltfLights) + " are there");
    std::stable_sort(model.lights.begin(), model.lights.end(),
                     [&](const Light& a, const Light& b) { return brightness(a) > brightness(b); });
    model.lights.resize(kMostGltfLights);
  }
}

}  // namespace

Model load_gltf_model(const std::filesystem::path& file) {
  GltfFile reader = open_gltf(file);
  const tinygltf::Model& gltf = reader.gltf;
  const std::vector<PlacedNode> placed = placed_nodes(reader);
  std::vector<const glm::dmat4*> worlds(gltf.nodes.size());
  for (const PlacedNode& at : placed) worlds[static_cast<std::size_t>(at.number)] = &at.to_world;
  GltfParts grown;
  for (const PlacedNode& at : placed) {
    const tinygltf::Node& node = gltf.nodes[static_cast<std::size_t>(at.number)];
    if (node.mesh >= 0) add_mesh(reader, node, at.to_world, worlds, grown);
  }
  std::vector<GltfPart>& parts = grown.parts;
  // Pictures of the materials that are used alone are read; the last is for none.
  reader.model.materials.resize(gltf.materials.size());
  reader.model.materials.push_back(material_of(reader, tinygltf::Material{}));
  std::vector<bool> is_read(reader.model.materials.size());
  is_read.back() = true;
  for (const GltfPart& part : parts) {
    if (is_read[part.material]) continue;
    is_read[part.material] = true;
    reader.model.materials[part.material] = material_of(reader, gltf.materials[part.material]);
  }
  parts.erase(std::remove_if(parts.begin(), parts.end(),
                             [](const GltfPart& part) { return part.mesh.indices.empty(); }),
              parts.end());
  if (parts.empty()) fail_gltf(reader, "has no triangles in its scene; a mesh would be right");
  finish_parts(reader, parts);
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high = -low;
  for (const Model::Part& part : reader.model.parts) {
    for (const glm::vec3& p : part.mesh.positions) {
      low = glm::min(low, glm::dvec3{p});
      high = glm::max(high, glm::dvec3{p});
    }
  }
  const glm::dvec3 middle = (low + high) * 0.5, extent = high - low;
  const double size = std::sqrt(dot(extent, extent));
  for (const PlacedNode& at : placed) {
    const tinygltf::Node& node = gltf.nodes[static_cast<std::size_t>(at.number)];
    if (node.camera >= 0) add_camera(reader, node, at.to_world);
    add_light(reader, node, at.to_world, middle, size);
  }
  level_lights(reader);
  if (!gltf.animations.empty()) warn_gltf(reader, "animations are left out");
  return std::move(reader.model);
}

}  // namespace softfocus
