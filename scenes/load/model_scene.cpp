#include "scenes/load/model_scene.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"

namespace softfocus {
namespace {

// The axes of the camera, and the box along them that holds the model.
struct SeenBox {
  glm::dvec3 axes[3];  // right, up, towards the camera
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
};

glm::dvec3 along_axes(const SeenBox& box, glm::dvec3 p) {
  return {dot(p, box.axes[0]), dot(p, box.axes[1]), dot(p, box.axes[2])};
}

// Where a model that is the scene has an object's positions.
struct ModelPlace {
  bool moves;
  glm::dmat4 matrix;

  ModelPlace(const Object& object, double frame) : moves(object.motion != nullptr), matrix{1.0} {
    if (!moves) return;
    matrix = matrix_at(*object.motion, frame);
    matrix[3] = matrix[3] + glm::dvec4{object.mesh_origin, 0.0};
  }
  glm::dvec3 operator()(glm::dvec3 p) const {
    if (!moves) return p;
    return glm::dvec3{((matrix[0] * p.x + matrix[1] * p.y) + matrix[2] * p.z) + matrix[3]};
  }
};

// At frame 0, and of what moves the corners of a box at others.
template <class Visit>
void for_each_position(const Scene& scene, Visit visit) {
  for (const Object& object : scene.objects) {
    const std::vector<glm::vec3>& positions = scene.meshes[object.mesh].positions;
    const ModelPlace place(object, 0.0);
    ModelBox box;
    for (const glm::vec3& position : positions) {
      visit(place(position));
      box.add(position);
    }
    if (!object.motion) continue;
    for (const double frame : telling_frames(*object.motion)) {
      const ModelPlace then(object, frame);
      for (const glm::dvec3& corner : box.corners()) visit(then(corner));
    }
  }
}

SeenBox seen_box(const Scene& scene, glm::dvec3 towards) {
  SeenBox box;
  box.axes[2] = towards;
  box.axes[0] = normalize(cross(scene.camera.up, towards));
  box.axes[1] = cross(box.axes[2], box.axes[0]);
  for_each_position(scene, [&](glm::dvec3 p) {
    const glm::dvec3 seen = along_axes(box, p);
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], seen[axis]);
      box.high[axis] = std::max(box.high[axis], seen[axis]);
    }
  });
  return box;
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
  for (const Object& object : scene.objects) {
    const Mesh& mesh = scene.meshes[object.mesh];
    const ModelPlace place(object, 0.0);
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const auto corner = [&](std::size_t k) { return place(mesh.positions[mesh.indices[i + k]]); };
      nearest = std::min(nearest, ray_to_triangle(eye, direction, corner(0), corner(1), corner(2)));
    }
  }
  return nearest;
}

constexpr glm::dvec3 kViewedFrom{0.6, 0.42, 1.0};
constexpr double kFilled = 0.9;  // of half the picture

// Stands where every point of the model lies inside the picture: with c its place
// along the camera's axes from the middle, |c.x| and |c.y| <= (d - c.z) * tangent.
void fit_camera(Scene& scene) {
  Camera& camera = scene.camera;
  const glm::dvec3 towards = normalize(kViewedFrom);
  const SeenBox box = seen_box(scene, towards);
  const glm::dvec3 middle = (box.low + box.high) * 0.5;
  const double tangent = kFilled * exact_math::tan_degrees(camera.fov_y_degrees / 2.0);
  double distance = 0.0;
  for_each_position(scene, [&](glm::dvec3 p) {
    const glm::dvec3 c = along_axes(box, p) - middle;
    distance = std::max(distance, c.z + std::max(std::fabs(c.x), std::fabs(c.y)) / tangent);
  });
  // A flat model seen on edge has no width.
  distance = std::max(distance, (box.high.z - middle.z) * 1.5);
  camera.target = (box.axes[0] * middle.x + box.axes[1] * middle.y) + box.axes[2] * middle.z;
  camera.position = camera.target + towards * distance;
  // Room to move the camera: half the way before the model, ten times the way behind.
  camera.near_m = (distance - (box.high.z - middle.z)) * 0.5;
  camera.far_m = distance * 10.0;
}

double depth_of(const Camera& camera, glm::dvec3 p) {
  return dot(p - camera.position, normalize(camera.target - camera.position));
}

// The last frame in which something moves, or 0.
double last_moving_frame(const Scene& scene) {
  double last = 0.0;
  for (const Object& object : scene.objects) {
    if (object.motion) last = std::max(last, last_frame(*object.motion));
  }
  const std::vector<Keyframe>& keys = scene.camera.position_keys[0];
  return keys.empty() ? last : std::max(last, keys.back().frame);
}

// How far things are from where the camera ever is, at most.
double farthest_ever(const Scene& scene) {
  constexpr std::size_t kMostEyes = 1000;
  ModelBox box;
  for_each_position(scene, [&](glm::dvec3 p) { box.add(p); });
  const PlaceKeys& keys = scene.camera.position_keys;
  double farthest = 0.0;
  for (std::size_t i = 0; i < keys[0].size(); i += keys[0].size() / kMostEyes + 1) {
    const glm::dvec3 eye{keys[0][i].value, keys[1][i].value, keys[2][i].value};
    for (const glm::dvec3& corner : box.corners()) {
      farthest = std::max(farthest, length_of(corner - eye));
    }
  }
  return farthest;
}

// For a camera of the file's, which may stand in the model: all that is before it, to a
// 10,000th of the farthest.
void set_near_and_far(Scene& scene) {
  Camera& camera = scene.camera;
  double farthest = 0.0, nearest = std::numeric_limits<double>::infinity();
  for_each_position(scene, [&](glm::dvec3 p) {
    const double z = depth_of(camera, p);
    farthest = std::max(farthest, z);
    if (z > 0.0) nearest = std::min(nearest, z);
  });
  const bool stands = camera.position_keys[0].empty();
  camera.far_m = farthest > 0.0 ? 1.5 * farthest : 100.0;
  if (!stands) camera.far_m = std::max(camera.far_m, 1.1 * farthest_ever(scene));
  camera.near_m = camera.far_m * 1e-4;
  if (stands) camera.near_m = std::max(std::min(nearest, camera.far_m) * 0.5, camera.near_m);
  // Where it looks at nothing, the middle of the depths is the focus.
  if (farthest > 0.0) {
    const glm::dvec3 forwards = normalize(camera.target - camera.position);
    camera.target = camera.position + forwards * ((nearest + farthest) / 2.0);
  }
}

void fit_lens(Scene& scene) {
  const Camera& camera = scene.camera;
  const glm::dvec3 way = camera.target - camera.position;
  const double to_middle = std::sqrt(dot(way, way));
  const glm::dvec3 forwards = normalize(way);
  const double hit = first_hit(scene, camera.position, forwards);
  const double focus = std::isfinite(hit) ? hit : to_middle;

  // r = (A/2) |1/z_f - 1/z| pixels; a flat model seen square on gets the lens of one
  // that is a tenth of its distance deep.
  double largest = 0.1 / focus;
  for_each_position(scene, [&](glm::dvec3 p) {
    // Before a camera that stands in the model, an eighth of the focus is the nearest.
    const double z = std::max(depth_of(camera, p), focus / 8.0);
    largest = std::max(largest, std::fabs(1.0 / focus - 1.0 / z));
  });
  const double pixels = 1024.0 / (2.0 * exact_math::tan_degrees(camera.fov_y_degrees / 2.0));
  const double aperture_m = 2.0 * kModelCocPx / (largest * pixels);
  ThinLens& lens = scene.lens.lens;
  lens.focus_m = focus;
  lens.focal_length_mm = std::min(50.0, focus * 50.0);
  lens.f_number = 2.0;
  scene.lens.coc_scale = aperture_m * 1000.0 * lens.f_number / lens.focal_length_mm;
}

}  // namespace

void add_model(Scene& scene, Model model, const Object& placement,
               std::optional<std::uint32_t> material) {
  const auto first_material = static_cast<std::uint32_t>(scene.materials.size());
  const auto first_texture = static_cast<std::uint32_t>(scene.textures.size());
  const auto number = static_cast<std::uint32_t>(scene.objects.size() + 1);
  for (Model::Part& part : model.parts) {
    Object object = placement;
    object.model = number;
    object.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    object.motion = part.motion;
    object.mesh_origin = part.motion ? glm::dvec3{0.0} : model.origin;
    object.material = material.value_or(first_material + part.material);
    if (!material) place_uvs(part.mesh, part.placement);
    scene.meshes.push_back(std::move(part.mesh));
    scene.objects.push_back(object);
  }
  if (!material) {
    for (Texture& texture : model.textures) scene.textures.push_back(std::move(texture));
    for (Material& own : model.materials) {
      if (own.texture) *own.texture += first_texture;
      if (own.opacity_texture) *own.opacity_texture += first_texture;
      scene.materials.push_back(std::move(own));
    }
  }
  scene.warnings.insert(scene.warnings.end(), model.warnings.begin(), model.warnings.end());
  scene.files.insert(scene.files.end(), model.files.begin(), model.files.end());
}

Scene make_model_scene(Model model, const std::string& name) {
  Scene scene;
  scene.name = name;
  scene.title = name;
  scene.background = {0.14f, 0.15f, 0.17f};
  scene.ambient_light = {0.17f, 0.175f, 0.19f};
  scene.lights = {
      {LightKind::directional, {-0.5f, 0.9f, 0.8f}, {1.05f, 1.0f, 0.92f}},
      {LightKind::directional, {1.0f, 0.25f, 0.35f}, {0.25f, 0.28f, 0.34f}},
  };
  if (!model.lights.empty()) scene.lights = model.lights;
  const std::optional<Camera> camera = model.camera;
  const glm::dvec3 origin = model.origin;
  add_model(scene, std::move(model), Object{}, std::nullopt);
  for (Object& object : scene.objects) object.mesh_origin = object.mesh_origin - origin;
  if (camera) {
    scene.camera = *camera;
    set_near_and_far(scene);
  } else {
    fit_camera(scene);
  }
  fit_lens(scene);
  const SceneLens& lens = scene.lens;
  const auto rounded = [](double value) {
    std::ostringstream text;
    text << std::setprecision(3) << value;
    return text.str();
  };
  scene.notes.push_back(name + ": a lens of " + rounded(lens.lens.focal_length_mm) + " mm at f/" +
                        rounded(lens.lens.f_number) + ", focused at " + rounded(lens.lens.focus_m) +
                        " m, circles " + rounded(lens.coc_scale) + " times as large (--coc-scale)");
  if (const double last = last_moving_frame(scene); last > 0.0) {
    scene.notes.push_back(name + ": moves up to frame " +
                          std::to_string(static_cast<long long>(std::ceil(last))) +
                          ", 60 a second (--frames)");
  }
  return scene;
}

}  // namespace softfocus
