#include "scenes/models/gltf_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "scenes/models/gltf_animations.h"
#include "scenes/models/gltf_materials.h"

namespace softfocus {
namespace {

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
  const double degrees = number_in(*transform, "rotation", 0.0) * kDegrees;
  made.sine = exact_math::sin_degrees(degrees);
  made.cosine = exact_math::sin_degrees(degrees + 90.0);
  return made;
}

glm::dvec3 place(const glm::dmat4& m, glm::dvec3 p) {
  return glm::dvec3{((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3]};
}

// Of a skin's joints: world of the joint times the inverse of its bind pose.
std::vector<glm::dmat4> joint_matrices(GltfFile& file, const tinygltf::Skin& skin,
                                       std::span<const PlacedNode* const> nodes) {
  std::optional<GltfNumbers> inverse;
  if (skin.inverseBindMatrices >= 0) inverse = read_accessor(file, skin.inverseBindMatrices);
  if (inverse && (inverse->width != 16 || inverse->count() < skin.joints.size())) {
    fail_gltf(file, "a skin has fewer inverseBindMatrices than joints");
  }
  std::vector<glm::dmat4> matrices;
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    item_of(file, file.gltf.nodes, skin.joints[i], "node");
    const PlacedNode* const joint = nodes[static_cast<std::size_t>(skin.joints[i])];
    glm::dmat4 matrix = joint != nullptr ? joint->to_world : glm::dmat4{1.0};
    if (joint != nullptr && joint->motion) warn_gltf(file, "skins stand as they do at frame 0");
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
  bool have_opacity = false;  // the colours
};

// Adds the targets' attribute. False if one that counts has none.
bool add_morph_targets(GltfFile& file, const tinygltf::Primitive& primitive,
                       std::span<const double> weights, const std::string& name,
                       GltfNumbers& numbers) {
  bool have_all = true;
  for (std::size_t i = 0; i < primitive.targets.size() && i < weights.size(); ++i) {
    if (weights[i] == 0.0) continue;
    const auto moved = read_attribute(file, primitive.targets[i], name, numbers.count(), 3, 3);
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
  VertexMatrices(GltfFile& file, const tinygltf::Primitive& primitive, std::size_t count,
                 const glm::dmat4& of_node, std::span<const glm::dmat4> joints)
      : of_node_(of_node), joints_(joints) {
    for (int set = 0; !joints.empty(); ++set) {
      const std::string end = std::to_string(set);
      auto numbers = read_attribute(file, primitive.attributes, "JOINTS_" + end, count, 4, 4);
      auto weights = read_attribute(file, primitive.attributes, "WEIGHTS_" + end, count, 4, 4);
      if (!numbers || !weights) break;
      for (const double joint : numbers->values) {
        if (!(joint >= 0.0 && joint < static_cast<double>(joints.size()))) {
          fail_gltf(file, "a vertex names a joint past the " + std::to_string(joints.size()) +
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
    if (all == 0.0) return of_node_;
    for (int column = 0; column < 4; ++column) mean[column] = mean[column] / all;
    return mean;
  }

 private:
  struct Set {
    GltfNumbers joints, weights;
  };
  const glm::dmat4& of_node_;
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
PlacedVertices place_vertices(GltfFile& file, const tinygltf::Primitive& primitive,
                              GltfNumbers positions, std::span<const std::uint32_t> used,
                              std::span<const double> morph_weights, const UvTransform& uvs,
                              const PlacedNode& at, std::span<const glm::dmat4> joints) {
  const std::size_t count = positions.count();
  add_morph_targets(file, primitive, morph_weights, "POSITION", positions);
  auto normals = read_attribute(file, primitive.attributes, "NORMAL", count, 3, 3);
  if (normals && !add_morph_targets(file, primitive, morph_weights, "NORMAL", *normals)) {
    normals.reset();
  }
  const auto coordinates = read_attribute(file, primitive.attributes,
                                          "TEXCOORD_" + std::to_string(uvs.set), count, 2, 2);
  const auto colours = read_attribute(file, primitive.attributes, "COLOR_0", count, 3, 4);
  const VertexMatrices matrices(file, primitive, count, at.to_motion, joints);
  PlacedVertices placed;
  placed.positions.reserve(used.size());
  for (const std::uint32_t i : used) {
    const glm::dmat4 matrix = matrices(i);
    const glm::dvec3 p = place(matrix, positions.vec3(i));
    for (int axis = 0; axis < 3; ++axis) {
      if (!(std::fabs(p[axis]) <= kLargestCoordinate)) {
        fail_gltf(file, "a position is no number, or beyond 1e9");
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
    if (colours && colours->width == 4 && (*colours)[i][3] < 1.0) placed.have_opacity = true;
  }
  return placed;
}

// The corners of triangles, of lists, strips and fans.
std::vector<std::uint32_t> corners_of(GltfFile& file, const tinygltf::Primitive& primitive,
                                      std::size_t count) {
  std::vector<std::uint32_t> order;
  if (primitive.indices >= 0) {
    const GltfNumbers indices = read_accessor(file, primitive.indices);
    if (indices.width != 1 || !indices.is_whole) {
      fail_gltf(file, "indices are not unsigned whole numbers");
    }
    for (const double index : indices.values) {
      if (index >= static_cast<double>(count)) {
        fail_gltf(file, "an index is " + std::to_string(static_cast<long long>(index)) + " of " +
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

// The part for a material and a motion, with or without coordinates and colours.
GltfPart& part_for(GltfParts& all, std::uint32_t material, bool has_uvs, bool has_colours,
                   const std::shared_ptr<const NodeMotion>& motion) {
  const auto [entry, is_new] =
      all.number_of.try_emplace({material, has_uvs, has_colours, motion.get()}, all.parts.size());
  if (is_new) all.parts.emplace_back(GltfPart{material, has_uvs, has_colours, motion});
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
bool is_drawn(GltfFile& file, const tinygltf::Primitive& primitive) {
  const bool are_triangles = primitive.mode == TINYGLTF_MODE_TRIANGLES ||
                             primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
                             primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
  if (!are_triangles) {
    warn_gltf(file, "points and lines are left out");
    return false;
  }
  const auto positions = primitive.attributes.find("POSITION");
  if (positions == primitive.attributes.end()) {
    warn_gltf(file, "a primitive without positions is left out");
    return false;
  }
  const tinygltf::Accessor& accessor =
      item_of(file, file.gltf.accessors, positions->second, "accessor");
  const bool is_packed = accessor.bufferView < 0 && !accessor.sparse.isSparse &&
                         extension(primitive.extensions, kDraco) != nullptr;
  if (is_packed) fail_gltf(file, packed_by(kDraco));
  const bool is_empty =
      accessor.count == 0 ||
      (primitive.indices >= 0 &&
       item_of(file, file.gltf.accessors, primitive.indices, "accessor").count == 0);
  if (is_empty) warn_gltf(file, "a primitive without vertices is left out");
  return !is_empty;
}

// What is moved by a motion, moved before.
std::shared_ptr<const NodeMotion> moved_from(std::shared_ptr<const NodeMotion> above,
                                             glm::dvec3 origin) {
  NodeMotion moved = standing(tinygltf::Node{});
  moved.above = std::move(above);
  for (int axis = 0; axis < 3; ++axis) moved.between[3][axis] = origin[axis];
  return std::make_shared<NodeMotion>(std::move(moved));
}

// Of all parts together.
constexpr std::size_t kMostGltfCorners = std::size_t{1} << 26;

}  // namespace

void add_mesh(GltfFile& file, const PlacedNode& placed, std::span<const PlacedNode* const> nodes,
              GltfParts& parts) {
  const tinygltf::Node& node = file.gltf.nodes[static_cast<std::size_t>(placed.number)];
  PlacedNode at = placed;
  const tinygltf::Mesh& mesh = item_of(file, file.gltf.meshes, node.mesh, "mesh");
  std::vector<glm::dmat4> joints;
  if (node.skin >= 0) {
    joints = joint_matrices(file, item_of(file, file.gltf.skins, node.skin, "skin"), nodes);
    at.motion = nullptr;  // its joints place it
    at.to_motion = at.to_world;
  }
  const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
  for (const tinygltf::Primitive& primitive : mesh.primitives) {
    if (!is_drawn(file, primitive)) continue;
    const auto material = static_cast<std::uint32_t>(
        primitive.material >= 0 ? primitive.material
                                : static_cast<int>(file.gltf.materials.size()));
    UvTransform uvs;
    bool has_opacity = false;
    if (primitive.material >= 0) {
      const tinygltf::Material& from =
          item_of(file, file.gltf.materials, primitive.material, "material");
      uvs = uv_transform(shown_colour(file, from));
      has_opacity = from.alphaMode != "OPAQUE";
    }
    GltfNumbers positions = read_accessor(file, primitive.attributes.at("POSITION"));
    if (positions.width != 3) fail_gltf(file, "POSITION is not of three numbers");
    std::vector<std::uint32_t> corners = corners_of(file, primitive, positions.count());
    const std::vector<std::uint32_t> used = used_vertices(corners, positions.count());
    parts.corners += corners.size();
    if (parts.corners > kMostGltfCorners) {
      fail_gltf(file, "with its copies the model has more than " +
                          std::to_string(kMostGltfCorners / 3) + " triangles");
    }
    const PlacedVertices vertices =
        place_vertices(file, primitive, std::move(positions), used, weights, uvs, at, joints);
    if (has_opacity && vertices.have_opacity) {
      warn_gltf(file, "the opacity of vertex colours is left out");
    }
    append_triangles(
        part_for(parts, material, !vertices.uvs.empty(), !vertices.colours.empty(), at.motion),
        vertices, corners, mirrors_space(at.to_motion));
  }
}

ModelBox finish_parts(GltfFile& file, std::vector<GltfPart>& parts) {
  ModelBox box;
  std::vector<ModelBox> own_boxes;
  for (const GltfPart& part : parts) {
    ModelBox own;
    double radius = 0.0;
    for (const glm::dvec3& p : part.positions) {
      own.add(p);
      radius = std::max(radius, length_of(p));
    }
    own_boxes.push_back(own);
    if (!part.motion) {
      box.add(own.low);
      box.add(own.high);
      continue;
    }
    if (!(reach(*part.motion, radius) <= kLargestCoordinate)) {
      fail_gltf(file, "an animation leads beyond 1e9");
    }
    for (const double frame : telling_frames(*part.motion)) {
      const glm::dmat4 matrix = matrix_at(*part.motion, frame);
      for (const glm::dvec3& corner : own.corners()) box.add(place(matrix, corner));
    }
  }
  const auto [low, high] = box;
  constexpr double kSmallest = 1e-9;  // lengths are squared in binary32
  if (!(std::max({high.x - low.x, high.y - low.y, high.z - low.z}) >= kSmallest)) {
    fail_gltf(file, "has no size; a model at least 1e-9 across would be right");
  }
  Model& model = file.model;
  model.origin = far_middle(low, high);
  if (model.origin != glm::dvec3{0.0}) {
    model.warnings.push_back(far_warning(file.path, model.origin));
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    GltfPart& part = parts[i];
    glm::dvec3 origin = model.origin;
    if (part.motion) {
      origin = far_middle(own_boxes[i].low, own_boxes[i].high);
      if (origin != glm::dvec3{0.0}) part.motion = moved_from(part.motion, origin);
    }
    for (const glm::dvec3& p : part.positions) part.mesh.positions.emplace_back(p - origin);
    part.positions = {};
    model.parts.push_back({std::move(part.mesh), part.material, {}, part.motion});
  }
  return {low - model.origin, high - model.origin};
}

}  // namespace softfocus
