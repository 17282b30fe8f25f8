#include "scenes/models/gltf_model.h"

#include <algorithm>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "raster/numbers/vector_math.h"
#include "scenes/models/gltf_animations.h"
#include "scenes/models/gltf_materials.h"
#include "scenes/models/gltf_meshes.h"

namespace softfocus {
namespace {

// Of nodes, one below the other.
constexpr int kMostDepth = 1000;
// Of them that move: each matrix of a part is a product of so many.
constexpr int kMostMoving = 100;

glm::dmat4 own_matrix(const tinygltf::Node& node) {
  if (node.matrix.size() != 16) return matrix_at(standing(node), 0.0);
  glm::dmat4 m{1.0};
  for (std::size_t i = 0; i < 16; ++i) {
    m[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = node.matrix[i];
  }
  return m;
}

// Below another, or by itself.
PlacedNode place_node(const tinygltf::Node& node, int number, const NodeMotion* tracks,
                      const PlacedNode& parent) {
  PlacedNode placed = parent;
  placed.number = number;
  const glm::dmat4 own = tracks != nullptr ? matrix_at(*tracks, 0.0) : own_matrix(node);
  placed.to_world = multiply(parent.to_world, own);
  placed.to_motion = multiply(parent.to_motion, own);
  if (tracks == nullptr || !moves(*tracks)) return placed;
  auto motion = std::make_shared<NodeMotion>(*tracks);
  motion->above = parent.motion;
  motion->between = parent.to_motion;
  placed.motion = std::move(motion);
  placed.to_motion = glm::dmat4{1.0};
  ++placed.moving;
  return placed;
}

// The nodes of the file's scene, parents first.
std::vector<PlacedNode> placed_nodes(GltfFile& file) {
  const tinygltf::Model& gltf = file.gltf;
  const std::map<int, NodeMotion> tracks = read_animations(file);
  struct Open {
    int node, depth;
    PlacedNode parent;
  };
  const PlacedNode root{-1, glm::dmat4{1.0}, nullptr, glm::dmat4{1.0}};
  std::vector<Open> open;
  if (!gltf.scenes.empty()) {
    const tinygltf::Scene& scene =
        item_of(file, gltf.scenes, std::max(gltf.defaultScene, 0), "scene");
    for (const int node : scene.nodes) open.push_back({node, 0, root});
  } else {
    std::set<int> children;
    for (const tinygltf::Node& node : gltf.nodes) {
      children.insert(node.children.begin(), node.children.end());
    }
    for (int i = 0; i < static_cast<int>(gltf.nodes.size()); ++i) {
      if (!children.contains(i)) open.push_back({i, 0, root});
    }
  }
  std::reverse(open.begin(), open.end());
  std::vector<bool> is_seen(gltf.nodes.size());
  std::vector<PlacedNode> placed;
  while (!open.empty()) {
    const Open next = open.back();
    open.pop_back();
    const tinygltf::Node& node = item_of(file, gltf.nodes, next.node, "node");
    const auto number = static_cast<std::size_t>(next.node);
    if (is_seen[number]) {
      fail_gltf(file, numbered("node", number) +
                          " is in two places, or below itself; a tree would be right");
    }
    if (next.depth > kMostDepth) {
      fail_gltf(file, numbered("node", number) + " lies below more than " +
                          std::to_string(kMostDepth) + " others");
    }
    if (next.parent.moving > kMostMoving) {
      fail_gltf(file, numbered("node", number) + " lies below more than " +
                          std::to_string(kMostMoving) + " that move");
    }
    is_seen[number] = true;
    const auto moved = tracks.find(next.node);
    placed.push_back(
        place_node(node, next.node, moved == tracks.end() ? nullptr : &moved->second, next.parent));
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
      open.push_back({*child, next.depth + 1, placed.back()});
    }
  }
  return placed;
}

// Keys at all whole frames: a camera's own go by straight lines. Where it has no direction, the
// last stays.
void add_camera_keys(GltfFile& file, const PlacedNode& at, Camera& camera) {
  constexpr double kMostFrames = 36000.0;  // ten minutes
  const double last = std::ceil(last_frame(*at.motion));
  if (last > kMostFrames) warn_gltf(file, "the camera stands still after ten minutes");
  glm::dvec3 way = camera.target - camera.position, up = camera.up;
  for (int number = 0; number <= std::min(last, kMostFrames); ++number) {
    const double frame = number;
    const glm::dmat4 to_world = multiply(matrix_at(*at.motion, frame), at.to_motion);
    const glm::dvec3 eye = glm::dvec3{to_world[3]} - file.model.origin;
    const glm::dvec3 new_way = -normalize(glm::dvec3{to_world[2]});
    const glm::dvec3 new_up = normalize(glm::dvec3{to_world[1]}), aside = cross(new_way, new_up);
    if (dot(aside, aside) > 1e-6) {
      way = new_way;
      up = new_up;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      camera.position_keys[i].push_back({frame, eye[axis]});
      camera.target_keys[i].push_back({frame, (eye + way)[axis]});
      camera.up_keys[i].push_back({frame, up[axis]});
    }
  }
}

void add_camera(GltfFile& file, const tinygltf::Node& node, const PlacedNode& at) {
  const glm::dmat4& to_world = at.to_world;
  const tinygltf::Camera& from = item_of(file, file.gltf.cameras, node.camera, "camera");
  if (file.model.camera) return;
  if (from.type != "perspective") {
    warn_gltf(file, "a camera that is not perspective is left out");
    return;
  }
  const double fov_degrees = from.perspective.yfov * kDegrees;
  if (!(fov_degrees > 0.1 && fov_degrees < 170.0)) {
    warn_gltf(file, "a camera of " + std::to_string(fov_degrees) + " degrees is left out");
    return;
  }
  const glm::dvec3 eye{to_world[3]};
  const glm::dvec3 back = normalize(glm::dvec3{to_world[2]});
  const glm::dvec3 up = normalize(glm::dvec3{to_world[1]});
  const glm::dvec3 right = cross(up, back);
  const double away = std::max({std::fabs(eye.x), std::fabs(eye.y), std::fabs(eye.z)});
  if (!(away <= kLargestCoordinate) || !(dot(right, right) > 1e-6)) {
    warn_gltf(file, "a camera without a place or a direction is left out");
    return;
  }
  Camera camera;
  camera.position = eye - file.model.origin;
  camera.target = camera.position - back;
  camera.up = up;
  camera.fov_y_degrees = fov_degrees;
  if (at.motion) add_camera_keys(file, at, camera);
  file.model.camera = camera;
}

void add_light(GltfFile& file, const tinygltf::Node& node, const PlacedNode& at, glm::dvec3 middle,
               double size) {
  const glm::dmat4& to_world = at.to_world;
  const tinygltf::Value* named = extension(node.extensions, "KHR_lights_punctual");
  const int number = named != nullptr ? index_in(*named, "light") : -1;
  if (number < 0 || static_cast<std::size_t>(number) >= file.gltf.lights.size()) return;
  const tinygltf::Light& from = file.gltf.lights[static_cast<std::size_t>(number)];
  if (at.motion) warn_gltf(file, "lights stand as they do at frame 0");
  Light light;
  double throws = from.intensity;
  if (from.type == "directional") {
    light.position_or_direction = glm::vec3{normalize(glm::dvec3{to_world[2]})};
    if (dot(light.position_or_direction, light.position_or_direction) == 0.0f) {
      warn_gltf(file, "a light without a direction is left out");
      return;
    }
  } else {
    if (from.type == "spot") warn_gltf(file, "a spot light shines in all directions");
    light.kind = LightKind::point;
    const glm::dvec3 place = glm::dvec3{to_world[3]} - file.model.origin;
    light.position_or_direction = glm::vec3{place};
    // Within the model it counts as at its half size.
    const glm::dvec3 way = place - middle;
    throws /= std::max({dot(way, way), size * size / 16.0, 1e-12});
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const double colour = i < from.color.size() ? from.color[i] : 1.0;
    light.colour[static_cast<int>(i)] = static_cast<float>(std::max(colour * throws, 0.0));
  }
  file.model.lights.push_back(light);
}

void level_lights(GltfFile& file) {
  Model& model = file.model;
  float most = 0.0f;
  for (const Light& light : model.lights) {
    most = std::max({most, light.colour.x, light.colour.y, light.colour.z});
  }
  if (model.lights.empty()) return;
  if (!(most > 0.0f && most < std::numeric_limits<float>::infinity())) {
    warn_gltf(file, "lights that give nothing, or no number, are left out");
    model.lights.clear();
    return;
  }
  for (Light& light : model.lights) light.colour = light.colour / most;
  const auto brightness = [](const Light& light) {
    return light.colour.x + light.colour.y + light.colour.z;
  };
  if (model.lights.size() > kMostLights) {
    warn_gltf(file, "of " + std::to_string(model.lights.size()) + " lights the brightest " +
                        std::to_string(kMostLights) + " are there");
    std::stable_sort(model.lights.begin(), model.lights.end(),
                     [&](const Light& a, const Light& b) { return brightness(a) > brightness(b); });
    model.lights.resize(kMostLights);
  }
}

}  // namespace

Model load_gltf_model(const std::filesystem::path& path) {
  GltfFile file = open_gltf(path);
  const tinygltf::Model& gltf = file.gltf;
  const std::vector<PlacedNode> placed = placed_nodes(file);
  std::vector<const PlacedNode*> nodes(gltf.nodes.size());
  for (const PlacedNode& at : placed) nodes[static_cast<std::size_t>(at.number)] = &at;
  GltfParts grown;
  for (const PlacedNode& at : placed) {
    const tinygltf::Node& node = gltf.nodes[static_cast<std::size_t>(at.number)];
    if (node.mesh >= 0) add_mesh(file, at, nodes, grown);
  }
  std::vector<GltfPart>& parts = grown.parts;
  // Pictures of the materials that are used alone are read; the last is for none.
  file.model.materials.resize(gltf.materials.size());
  file.model.materials.push_back(material_of(file, tinygltf::Material{}));
  std::vector<bool> is_read(file.model.materials.size());
  is_read.back() = true;
  for (const GltfPart& part : parts) {
    if (is_read[part.material]) continue;
    is_read[part.material] = true;
    file.model.materials[part.material] = material_of(file, gltf.materials[part.material]);
  }
  parts.erase(std::remove_if(parts.begin(), parts.end(),
                             [](const GltfPart& part) { return part.mesh.indices.empty(); }),
              parts.end());
  if (parts.empty()) fail_gltf(file, "has no triangles in its scene; a mesh would be right");
  const auto [low, high] = finish_parts(file, parts);
  const glm::dvec3 middle = (low + high) * 0.5, extent = high - low;
  const double size = std::sqrt(dot(extent, extent));
  for (const PlacedNode& at : placed) {
    const tinygltf::Node& node = gltf.nodes[static_cast<std::size_t>(at.number)];
    if (node.camera >= 0) add_camera(file, node, at);
    add_light(file, node, at, middle, size);
  }
  level_lights(file);
  return std::move(file.model);
}

}  // namespace softfocus
