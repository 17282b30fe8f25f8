#include "scenes/draw/frame_matrices.h"

#include <algorithm>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "scenes/models/node_motion.h"

namespace softfocus {
namespace {

// `v` turned about a unit axis (Rodrigues' formula).
glm::dvec3 turn_about(glm::dvec3 v, glm::dvec3 axis, double degrees) {
  const double cosine = exact_math::cos_degrees(degrees);
  const double sine = exact_math::sin_degrees(degrees);
  return v * cosine + cross(axis, v) * sine + axis * (dot(axis, v) * (1.0 - cosine));
}

// A turn in the plane of the two axes, from the first towards the second.
glm::dmat4 turn(int first, int second, double degrees) {
  const double cosine = exact_math::cos_degrees(degrees);
  const double sine = exact_math::sin_degrees(degrees);
  glm::dmat4 matrix{1.0};
  matrix[first][first] = cosine;
  matrix[first][second] = sine;
  matrix[second][first] = -sine;
  matrix[second][second] = cosine;
  return matrix;
}

glm::dmat4 look_at(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up) {
  const glm::dvec3 forward = normalize(target - eye);
  const glm::dvec3 right = normalize(cross(forward, up));
  const glm::dvec3 above = cross(right, forward);
  glm::dmat4 view{1.0};
  for (int i = 0; i < 3; ++i) {
    view[i][0] = right[i];
    view[i][1] = above[i];
    view[i][2] = -forward[i];
  }
  view[3][0] = -dot(right, eye);
  view[3][1] = -dot(above, eye);
  view[3][2] = dot(forward, eye);
  return view;
}

glm::dmat4 perspective(double fov_y_degrees, double aspect, double near_m, double far_m) {
  const double tangent = exact_math::tan_degrees(fov_y_degrees / 2.0);
  glm::dmat4 projection{0.0};
  projection[0][0] = 1.0 / (aspect * tangent);
  projection[1][1] = -1.0 / tangent;
  projection[2][2] = -(far_m + near_m) / (far_m - near_m);
  projection[2][3] = -1.0;
  projection[3][2] = -2.0 * far_m * near_m / (far_m - near_m);
  return projection;
}

}  // namespace

namespace {

glm::dvec3 place_at(const PlaceKeys& keys, Easing easing, glm::dvec3 without, double frame) {
  if (keys[0].empty()) return without;
  return {value_at(keys[0], easing, frame), value_at(keys[1], easing, frame),
          value_at(keys[2], easing, frame)};
}

}  // namespace

glm::dvec3 target_at(const Camera& camera, double frame) {
  return place_at(camera.target_keys, camera.easing, camera.target, frame);
}

namespace {

glm::dvec3 up_at(const Camera& camera, double frame) {
  return place_at(camera.up_keys, camera.easing, camera.up, frame);
}

}  // namespace

bool can_look(const Camera& camera, double frame) {
  const glm::dvec3 way = target_at(camera, frame) -
                         place_at(camera.position_keys, camera.easing, camera.position, frame);
  const glm::dvec3 up = up_at(camera, frame), aside = cross(way, up);
  // Shorter than this, the sideways axis would be rounding noise.
  return dot(aside, aside) > 1e-12 * (dot(way, way) * dot(up, up));
}

CameraMatrices camera_matrices(const Camera& camera, double frame, int width, int height) {
  const glm::dvec3 target = target_at(camera, frame);
  const glm::dvec3 position = place_at(camera.position_keys, camera.easing, camera.position, frame);
  const glm::dvec3 up = up_at(camera, frame);
  const glm::dvec3 arm =
      turn_about(position - target, normalize(up), camera.orbit_degrees_per_frame * frame);
  CameraMatrices matrices{};
  matrices.eye = target + arm;
  matrices.world_to_eye = look_at(matrices.eye, target, up);
  matrices.eye_to_clip =
      perspective(camera.fov_y_degrees, static_cast<double>(width) / static_cast<double>(height),
                  camera.near_m, camera.far_m);
  return matrices;
}

glm::dmat4 object_matrix(const Object& object, double frame) {
  const glm::dvec3 degrees = object.rotation_degrees + object.spin_degrees_per_frame * frame;
  const double phase = frame / object.sway_period_frames + object.sway_phase;
  const glm::dvec3 position =
      object.position + object.sway * exact_math::sin_degrees(360.0 * phase);

  glm::dmat4 scale{1.0};
  glm::dmat4 move{1.0};
  for (int i = 0; i < 3; ++i) {
    scale[i][i] = object.scale[i];
    move[3][i] = position[i];
  }
  const glm::dmat4 turned =
      multiply(multiply(turn(0, 1, degrees.z), turn(2, 0, degrees.y)), turn(1, 2, degrees.x));
  glm::dmat4 to_world = multiply(move, multiply(turned, scale));
  if (object.mesh_origin != glm::dvec3{0.0}) {
    glm::dmat4 origin{1.0};
    for (int i = 0; i < 3; ++i) origin[3][i] = object.mesh_origin[i];
    to_world = multiply(to_world, origin);
  }
  return object.motion ? multiply(to_world, matrix_at(*object.motion, frame)) : to_world;
}

namespace {

double slope(const Keyframe& a, const Keyframe& b) {
  return (b.value - a.value) / (b.frame - a.frame);
}

/// The speed at a key, in values a frame.
double speed_at(std::span<const Keyframe> keys, std::size_t key) {
  if (key == 0 || key + 1 == keys.size()) return 0.0;
  const double before = slope(keys[key - 1], keys[key]);
  const double behind = slope(keys[key], keys[key + 1]);
  if (!(before * behind > 0.0)) return 0.0;
  const double frames_before = keys[key].frame - keys[key - 1].frame;
  const double frames_behind = keys[key + 1].frame - keys[key].frame;
  const double weight_before = 2.0 * frames_behind + frames_before;
  const double weight_behind = frames_behind + 2.0 * frames_before;
  return (weight_before + weight_behind) / (weight_before / before + weight_behind / behind);
}

}  // namespace

double value_at(std::span<const Keyframe> keys, Easing easing, double frame) {
  const auto next =
      std::upper_bound(keys.begin(), keys.end(), frame,
                       [](double sought, const Keyframe& key) { return sought < key.frame; });
  if (next == keys.begin()) return keys.front().value;
  if (next == keys.end()) return keys.back().value;
  const auto right = static_cast<std::size_t>(next - keys.begin());
  const Keyframe& a = keys[right - 1];
  const Keyframe& b = keys[right];
  const double frames = b.frame - a.frame;
  const double t = (frame - a.frame) / frames;
  double way = (b.value - a.value) * t;
  if (easing == Easing::smooth) {
    // Hermite's cubic, less the value at a.
    const double u = 1.0 - t;
    way = (b.value - a.value) * (t * t * (3.0 - 2.0 * t)) +
          frames * (speed_at(keys, right - 1) * (t * u * u) - speed_at(keys, right) * (t * t * u));
  }
  const auto [least, most] = std::minmax(a.value, b.value);
  return std::clamp(a.value + way, least, most);
}

ThinLens lens_at(const SceneLens& lens, double frame) {
  ThinLens at_frame = lens.lens;
  for (const LensNumber& number : kLensNumbers) {
    const std::vector<Keyframe>& keys = lens.keys[number.place];
    if (!keys.empty()) at_frame.*number.place = value_at(keys, lens.easing, frame);
  }
  return at_frame;
}

}  // namespace softfocus
