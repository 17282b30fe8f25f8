#include "scenes/model_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"

namespace softfocus {
namespace {

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
};

Box bounding_box(const Scene& scene) {
  Box box;
  for (const Mesh& mesh : scene.meshes) {
    for (const glm::vec3& position : mesh.positions) {
      for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], static_cast<double>(position[axis]));
        box.high[axis] = std::max(box.high[axis], static_cast<double>(position[axis]));
      }
    }
  }
  return box;
}

std::array<glm::dvec3, 8> corners_of(const Box& box) {
  std::array<glm::dvec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    corners[i] = {(i & 1) != 0 ? box.high.x : box.low.x, (i & 2) != 0 ? box.high.y : box.low.y,
                  (i & 4) != 0 ? box.high.z : box.low.z};
  }
  return corners;
}

// Moeller and Trumbore 1997: how many `direction`s the triangle lies ahead, or infinity.
double ray_to_triangle(glm::dvec3 eye, glm::dvec3 direction, glm::dvec3 a, glm::dvec3 b,
                       glm::dvec3 c) {
  constexpr double kMiss = std::numeric_limits<double>::infinity();
  const glm::dvec3 edge1 = b - a;
  const glm::dvec3 edge2 = c - a;
  const glm::dvec3 p = cross(direction, edge2);
  const double determinant = dot(edge1, p);
  if (determinant == 0.0) return kMiss;
  const glm::dvec3 from_a = eye - a;
  const double u = dot(from_a, p) / determinant;
  const glm::dvec3 q = cross(from_a, edge1);
  const double v = dot(direction, q) / determinant;
  const double distance = dot(edge2, q) / determinant;
  const bool hit = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0;
  return hit ? distance : kMiss;
}

double first_hit(const Scene& scene, glm::dvec3 eye, glm::dvec3 direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Mesh& mesh : scene.meshes) {
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const auto corner = [&](std::size_t k) {
        return glm::dvec3{mesh.positions[mesh.indices[i + k]]};
      };
      nearest = std::min(nearest,
                         ray_to_triangle(eye, direction, corner(0), corner(1), corner(2)));
    }
  }
  return nearest;
}

constexpr glm::dvec3 kViewedFrom{0.6, 0.42, 1.0};
constexpr double kFilled = 0.9;  // of half the picture

// Stands where every corner c of the box lies inside the picture: with c seen along
// the camera's axes from the middle, |c.right| and |c.up| <= (d - c.towards) * tangent.
void fit_camera(Camera& camera, const Box& box) {
  const glm::dvec3 middle = (box.low + box.high) * 0.5;
  const glm::dvec3 towards = normalize(kViewedFrom);
  const glm::dvec3 right = normalize(cross(camera.up, towards));
  const glm::dvec3 up = cross(towards, right);
  const double tangent = kFilled * exact_math::tan_degrees(camera.fov_y_degrees / 2.0);
  double distance = 0.0;
  double depth = 0.0;  // of the box before and behind its middle
  for (const glm::dvec3 corner : corners_of(box)) {
    const glm::dvec3 c = corner - middle;
    const double aside = std::max(std::fabs(dot(c, right)), std::fabs(dot(c, up)));
    distance = std::max(distance, dot(c, towards) + aside / tangent);
    depth = std::max(depth, dot(c, towards));
  }
  camera.target = middle;
  camera.position = middle + towards * distance;
  // Room to move the camera: a hundredth of the way before, ten times behind.
  camera.near_m = std::max((distance - depth) * 0.5, distance * 0.01);
  camera.far_m = distance * 10.0;
}

void fit_lens(SceneLens& lens, const Scene& scene, const Box& box) {
  const Camera& camera = scene.camera;
  const glm::dvec3 way = camera.target - camera.position;
  const double to_middle = std::sqrt(dot(way, way));
  const glm::dvec3 forwards = normalize(way);
  const double hit = first_hit(scene, camera.position, forwards);
  const double focus = std::isfinite(hit) ? hit : to_middle;

  // r = (A/2) |1/z_f - 1/z| pixels, largest at one end of the box.
  double largest = 0.0;
  for (const glm::dvec3 corner : corners_of(box)) {
    const double z = dot(corner - camera.position, forwards);
    largest = std::max(largest, std::fabs(1.0 / focus - 1.0 / z));
  }
  const double pixels = 1024.0 / (2.0 * exact_math::tan_degrees(camera.fov_y_degrees / 2.0));
  const double aperture_m = 2.0 * kModelCocPx / (largest * pixels);
  lens.lens.focus_m = focus;
  lens.lens.focal_length_mm = focus * 1000.0 / 20.0;
  lens.lens.f_number = lens.lens.focal_length_mm / (aperture_m * 1000.0);
}

}  // namespace

void add_model(Scene& scene, ObjModel model, const Object& placement,
               std::optional<std::uint32_t> material) {
  const auto first_material = static_cast<std::uint32_t>(scene.materials.size());
  const auto first_texture = static_cast<std::uint32_t>(scene.textures.size());
  for (ObjModel::Part& part : model.parts) {
    Object object = placement;
    object.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    object.material = material.value_or(first_material + part.material);
    scene.meshes.push_back(std::move(part.mesh));
    scene.objects.push_back(object);
  }
  if (!material) {
    for (Texture& texture : model.textures) scene.textures.push_back(std::move(texture));
    for (Material& own : model.materials) {
      if (own.texture) *own.texture += first_texture;
      scene.materials.push_back(std::move(own));
    }
  }
  scene.warnings.insert(scene.warnings.end(), model.warnings.begin(), model.warnings.end());
}

Scene make_model_scene(ObjModel model, const std::string& name) {
  Scene scene;
  scene.name = name;
  scene.title = name;
  scene.background = {0.18f, 0.19f, 0.21f};
  scene.ambient_light = {0.30f, 0.31f, 0.34f};
  scene.lights = {
      {LightKind::directional, {-0.5f, 0.9f, 0.8f}, {0.95f, 0.92f, 0.86f}},
      {LightKind::directional, {1.0f, 0.25f, 0.35f}, {0.22f, 0.25f, 0.30f}},
  };
  add_model(scene, std::move(model), Object{}, std::nullopt);
  const Box box = bounding_box(scene);
  fit_camera(scene.camera, box);
  fit_lens(scene.lens, scene, box);
  return scene;
}

}  // namespace softfocus
