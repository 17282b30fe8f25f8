#include "scenes/load/gltf_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <limits>
#include <span>
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
  made.set = static_cast<int>(number_in(*transform, "texCoord", made.set));
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
    if (is_seen[number] || next.depth > kMostDepth) {
      fail_gltf(reader, numbered("node", number) +
                            " is in two places, or below itself; a tree would be right");
    }
    is_seen[number] = true;
    placed.push_back({next.node, multiply(next.parent, own_matrix(node))});
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
      open.push_back({*child, next.depth + 1, placed.back().to_world});
    }
  }
  return placed;
}

// Of a skin's joints: world of the joint times the inverse of its bind pose.
std::vector<glm::dmat4> joint_matrices(const GltfFile& reader, const tinygltf::Skin& skin,
                                       std::span<const PlacedNode> placed) {
  std::optional<GltfNumbers> inverse;
  if (skin.inverseBindMatrices >= 0) inverse = read_accessor(reader, skin.inverseBindMatrices);
  if (inverse && (inverse->width != 16 || inverse->count() < skin.joints.size())) {
    fail_gltf(reader, "a skin has fewer inverseBindMatrices than joints");
  }
  std::vector<glm::dmat4> matrices;
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    const auto found = std::find_if(placed.begin(), placed.end(), [&](const PlacedNode& node) {
      return node.number == skin.joints[i];
    });
    glm::dmat4 matrix = found != placed.end() ? found->to_world : glm::dmat4{1.0};
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

void add_morph_targets(const GltfFile& reader, const tinygltf::Primitive& primitive,
                       std::span<const double> weights, GltfNumbers& positions) {
  for (std::size_t i = 0; i < primitive.targets.size() && i < weights.size(); ++i) {
    if (weights[i] == 0.0) continue;
    const auto moved =
        read_attribute(reader, primitive.targets[i], "POSITION", positions.count(), 3, 3);
    if (!moved) continue;
    for (std::size_t k = 0; k < positions.values.size(); ++k) {
      positions.values[k] += weights[i] * moved->values[k];
    }
  }
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
  VertexMatrices(const GltfFile& reader, const tinygltf::Primitive& primitive, std::size_t count,
                 const glm::dmat4& to_world, std::span<const glm::dmat4> joints)
      : to_world_(to_world), joints_(joints) {
    if (joints.empty()) return;
    numbers_ = read_attribute(reader, primitive.attributes, "JOINTS_0", count, 4, 4);
    weights_ = read_attribute(reader, primitive.attributes, "WEIGHTS_0", count, 4, 4);
  }
  glm::dmat4 operator()(std::size_t vertex) const {
    if (!numbers_ || !weights_) return to_world_;
    glm::dmat4 mean{0.0};
    double all = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      const double weight = (*weights_)[vertex][i], joint = (*numbers_)[vertex][i];
      if (!(weight > 0.0) || !(joint >= 0.0 && joint < static_cast<double>(joints_.size()))) {
        continue;
      }
      const glm::dmat4& of = joints_[static_cast<std::size_t>(joint)];
      for (int column = 0; column < 4; ++column) mean[column] = mean[column] + of[column] * weight;
      all += weight;
    }
    if (all == 0.0) return to_world_;
    for (int column = 0; column < 4; ++column) mean[column] = mean[column] / all;
    return mean;
  }

 private:
  const glm::dmat4& to_world_;
  std::span<const glm::dmat4> joints_;
  std::optional<GltfNumbers> numbers_, weights_;
};

PlacedVertices place_vertices(const GltfFile& reader, const tinygltf::Primitive& primitive,
                              std::span<const double> morph_weights, const UvTransform& uvs,
                              const glm::dmat4& to_world, std::span<const glm::dmat4> joints) {
  const auto found = primitive.attributes.find("POSITION");
  GltfNumbers positions = read_accessor(reader, found->second);
  if (positions.width != 3) fail_gltf(reader, "POSITION is not of three numbers");
  add_morph_targets(reader, primitive, morph_weights, positions);
  const std::size_t count = positions.count();
  const auto normals = read_attribute(reader, primitive.attributes, "NORMAL", count, 3, 3);
  const auto coordinates = read_attribute(reader, primitive.attributes,
                                          "TEXCOORD_" + std::to_string(uvs.set), count, 2, 2);
  const auto colours = read_attribute(reader, primitive.attributes, "COLOR_0", count, 3, 4);
  const VertexMatrices matrices(reader, primitive, count, to_world, joints);
  PlacedVertices placed;
  placed.positions.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
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
    if (colours) {
      glm::vec3 colour{0.0f};
      for (int k = 0; k < 3; ++k) {
        const double value = (*colours)[i][k];
        colour[k] = value > 0.0 ? static_cast<float>(std::min(value, 1.0)) : 0.0f;
      }
      placed.colours.push_back(colour);
    }
  }
  return placed;
}

// The corners of triangles, of lists, strips and fans.
std::vector<std::uint32_t> corners_of(const GltfFile& reader, const tinygltf::Primitive& primitive,
                                      std::size_t count) {
  std::vector<std::uint32_t> order;
  if (primitive.indices >= 0) {
    const GltfNumbers indices = read_accessor(reader, primitive.indices);
    if (indices.width != 1) fail_gltf(reader, "indices are not of one number");
    for (const double index : indices.values) {
      if (!(index >= 0.0 && index < static_cast<double>(count))) {
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

// The part for a material, with or without coordinates and colours.
GltfPart& part_for(std::vector<GltfPart>& parts, std::uint32_t material, bool has_uvs,
                   bool has_colours) {
  const auto found = std::find_if(parts.begin(), parts.end(), [&](const GltfPart& part) {
    return part.material == material && part.has_uvs == has_uvs && part.has_colours == has_colours;
  });
  return found != parts.end() ? *found
                              : parts.emplace_back(GltfPart{material, has_uvs, has_colours});
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

void add_mesh(GltfFile& reader, const tinygltf::Node& node, const PlacedNode& placed,
              std::span<const PlacedNode> all, std::vector<GltfPart>& parts) {
  const tinygltf::Mesh& mesh = item_of(reader, reader.gltf.meshes, node.mesh, "mesh");
  std::vector<glm::dmat4> joints;
  if (node.skin >= 0) {
    joints = joint_matrices(reader, item_of(reader, reader.gltf.skins, node.skin, "skin"), all);
  }
  const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
  for (const tinygltf::Primitive& primitive : mesh.primitives) {
    if (primitive.mode != -1 && primitive.mode != TINYGLTF_MODE_TRIANGLES &&
        primitive.mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
        primitive.mode != TINYGLTF_MODE_TRIANGLE_FAN) {
      warn_gltf(reader, "points and lines are left out");
      continue;
    }
    if (!primitive.attributes.contains("POSITION")) {
      warn_gltf(reader, "a primitive without positions is left out");
      continue;
    }
    const auto material = static_cast<std::uint32_t>(
        primitive.material >= 0 ? primitive.material
                                : static_cast<int>(reader.gltf.materials.size()));
    UvTransform uvs;
    if (primitive.material >= 0) {
      uvs = uv_transform(shown_colour(
          reader, item_of(reader, reader.gltf.materials, primitive.material, "material")));
    }
    const PlacedVertices vertices =
        place_vertices(reader, primitive, weights, uvs, placed.to_world, joints);
    const std::vector<std::uint32_t> corners =
        corners_of(reader, primitive, vertices.positions.size());
    append_triangles(part_for(parts, material, !vertices.uvs.empty(), !vertices.colours.empty()),
                     vertices, corners, joints.empty() && mirrors_space(placed.to_world));
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
  Model& model = reader.model;
  model.origin = far_middle(low, high);
  if (model.origin != glm::dvec3{0.0}) {
    model.warnings.push_back(far_warning(reader.path, model.origin));
  }
  for (GltfPart& part : parts) {
    for (const glm::dvec3& p : part.positions) part.mesh.positions.emplace_back(p - model.origin);
    model.parts.push_back({std::move(part.mesh), part.material});
  }
}

void add_camera(GltfFile& reader, const tinygltf::Node& node, const glm::dmat4& to_world) {
  const tinygltf::Camera& from = item_of(reader, reader.gltf.cameras, node.camera, "camera");
  if (reader.model.camera) return;
  const double fov = from.perspective.yfov * 57.295779513082320877;
  if (from.type != "perspective" || !(fov > 0.1 && fov < 170.0)) {
    warn_gltf(reader, "a camera that is not perspective is left out");
    return;
  }
  Camera camera;
  camera.position = glm::dvec3{to_world[3]} - reader.model.origin;
  camera.target = camera.position - normalize(glm::dvec3{to_world[2]});
  camera.up = normalize(glm::dvec3{to_world[1]});
  camera.fov_y_degrees = fov;
  reader.model.camera = camera;
}

void add_light(GltfFile& reader, const tinygltf::Node& node, const glm::dmat4& to_world,
               glm::dvec3 middle, double size) {
  const tinygltf::Value* named = extension(node.extensions, "KHR_lights_punctual");
  const int number = named != nullptr ? static_cast<int>(number_in(*named, "light", -1.0)) : -1;
  if (number < 0 || static_cast<std::size_t>(number) >= reader.gltf.lights.size()) return;
  const tinygltf::Light& from = reader.gltf.lights[static_cast<std::size_t>(number)];
  Light light;
  double throws = from.intensity;
  if (from.type == "directional") {
    light.position_or_direction = glm::vec3{normalize(glm::dvec3{to_world[2]})};
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

void level_lights(Model& model) {
  float most = 0.0f;
  for (const Light& light : model.lights) {
    most = std::max({most, light.colour.x, light.colour.y, light.colour.z});
  }
  if (!(most > 0.0f && most < std::numeric_limits<float>::infinity())) {
    model.lights.clear();
    return;
  }
  for (Light& light : model.lights) light.colour = light.colour / most;
}

}  // namespace

Model load_gltf_model(const std::filesystem::path& file) {
  GltfFile reader = open_gltf(file);
  const tinygltf::Model& gltf = reader.gltf;
  for (const tinygltf::Material& material : gltf.materials) {
    reader.model.materials.push_back(material_of(reader, material));
  }
  Material white;
  white.ambient = white.diffuse = glm::vec3{0.5f};
  reader.model.materials.push_back(white);
  const std::vector<PlacedNode> placed = placed_nodes(reader);
  std::vector<GltfPart> parts;
  for (const PlacedNode& at : placed) {
    const tinygltf::Node& node = gltf.nodes[static_cast<std::size_t>(at.number)];
    if (node.mesh >= 0) add_mesh(reader, node, at, placed, parts);
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
  level_lights(reader.model);
  if (!gltf.animations.empty()) warn_gltf(reader, "animations are left out");
  return std::move(reader.model);
}

}  // namespace softfocus
