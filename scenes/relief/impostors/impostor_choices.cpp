#include "scenes/relief/impostors/impostor_choices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "raster/numbers/vector_math.h"
#include "scenes/relief/impostors/impostor.h"
#include "scenes/relief/impostors/octahedral_atlas.h"

namespace softfocus {
namespace {

// Nanoseconds with two threads, AVX2: of a triangle that is drawn; of a relief's texel that is
// warped and mapped, or drawn and read.
constexpr double kTriangleNs = 24.0, kWarpNs = 3.5, kRenewalNs = 10.0;

// Each way: texels are filtered twice, by the warp and on the way to the picture.
constexpr double kTexelsPerPixel = 1.6;

// Of a relief, and of a texel: colour and depth. The same on every machine, as the choice is.
constexpr double kReliefBytes = 256.0, kTexelBytes = 6.0;

// With a budget of milliseconds: the tolerance may grow so many times.
constexpr int kMostTolerance = 16;

glm::dvec3 moved_by(const glm::dmat4& matrix, glm::dvec3 p) {
  return ((glm::dvec3{matrix[0]} * p.x + glm::dvec3{matrix[1]} * p.y) +
          glm::dvec3{matrix[2]} * p.z) +
         glm::dvec3{matrix[3]};
}

bool is_same_model(const Object& a, const Object& b) {
  return a.model != 0 && a.model == b.model && a.impostor == b.impostor;
}

bool can_be_impostor(const Scene& scene, const Object& object) {
  const Material& material = scene.materials[object.material];
  return object.impostor != ImpostorUse::never && !moves(object) && material.shaders == nullptr &&
         !is_transparent(material, scene.meshes[object.mesh]);
}

/// The corners of a box along the axes.
void add_corners(glm::dvec3 low, glm::dvec3 high, std::vector<glm::dvec3>& corners) {
  for (int corner = 0; corner < 8; ++corner) {
    glm::dvec3 p = low;
    for (int i = 0; i < 3; ++i) {
      if ((corner >> i & 1) != 0) p[i] = high[i];
    }
    corners.push_back(p);
  }
}

std::vector<glm::dvec3> corners_of_chunks(const Mesh& mesh) {
  const std::vector<glm::dvec3> points{mesh.positions.begin(), mesh.positions.end()};
  std::vector<glm::dvec3> corners;
  for (const PointChunk& chunk : chunks_of(points)) {
    add_corners(chunk.middle - chunk.half, chunk.middle + chunk.half, corners);
  }
  return corners;
}

struct Box {
  glm::dvec3 low{HUGE_VAL}, high{-HUGE_VAL};
};

Box box_of(std::span<const glm::dvec3> points) {
  Box box;
  for (const glm::dvec3& point : points) {
    for (int i = 0; i < 3; ++i) {
      box.low[i] = std::min(box.low[i], point[i]);
      box.high[i] = std::max(box.high[i], point[i]);
    }
  }
  return box;
}

void add_moved(std::span<const glm::dvec3> points, const Object& object,
               std::vector<glm::dvec3>& to) {
  const glm::dmat4 to_world = object_matrix(object, 0.0);
  for (const glm::dvec3& point : points) to.push_back(moved_by(to_world, point));
}

}  // namespace

ImpostorObjects impostor_objects(const Scene& scene) {
  ImpostorObjects found{&scene, {}, std::vector<std::vector<glm::dvec3>>(scene.meshes.size())};
  for (std::size_t first = 0; first < scene.objects.size();) {
    std::size_t end = first + 1;
    while (end < scene.objects.size() && is_same_model(scene.objects[first], scene.objects[end])) {
      ++end;
    }
    ImpostorObject object{first, end, scene.objects[first].impostor, {}, {}, 0.0, 0};
    bool can_be = true;
    for (std::size_t i = first; i < end; ++i) {
      can_be = can_be && can_be_impostor(scene, scene.objects[i]);
      if (!can_be) break;
      const Mesh& mesh = scene.meshes[scene.objects[i].mesh];
      object.triangles += mesh.indices.size() / 3;
      std::vector<glm::dvec3>& corners = found.mesh_corners[scene.objects[i].mesh];
      if (corners.empty()) corners = corners_of_chunks(mesh);
      if (corners.empty()) continue;
      const Box box = box_of(corners);
      std::vector<glm::dvec3> of_box;
      add_corners(box.low, box.high, of_box);
      add_moved(of_box, scene.objects[i], object.corners);
    }
    first = end;
    if (!can_be || object.triangles == 0) continue;
    const Box box = box_of(object.corners);
    object.middle = (box.low + box.high) * 0.5;
    for (const glm::dvec3& corner : object.corners) {
      object.radius_m = std::max(object.radius_m, length_of(corner - object.middle));
    }
    if (object.radius_m > 0.0) found.all.push_back(std::move(object));
  }
  return found;
}

void add_points(const ImpostorObjects& objects, const ImpostorObject& object,
                std::vector<glm::dvec3>& to) {
  for (std::size_t i = object.first; i < object.end; ++i) {
    const Object& part = objects.scene->objects[i];
    add_moved(objects.mesh_corners[part.mesh], part, to);
  }
}

namespace {

/// A view, as the choice of what to draw needs it.
struct ImpostorView {
  const CameraMatrices& camera;
  std::array<glm::dvec4, 6> planes;  ///< inwards, of unit length: near, far, four sides
  double pixel_tangent;
  double speed_m;     ///< a frame
  double farthest_m;  ///< whose half is not the background's
};

std::array<glm::dvec4, 6> planes_of(const CameraMatrices& camera) {
  const glm::dmat4 clip = multiply(camera.eye_to_clip, camera.world_to_eye);
  const auto row = [&](int i) {
    return glm::dvec4{clip[0][i], clip[1][i], clip[2][i], clip[3][i]};
  };
  std::array<glm::dvec4, 6> planes{row(3) + row(2), row(3) - row(2), row(3) + row(0),
                                   row(3) - row(0), row(3) + row(1), row(3) - row(1)};
  for (glm::dvec4& plane : planes) {
    const double length = length_of(glm::dvec3{plane});
    for (int i = 0; i < 4; ++i) plane[i] /= length;
  }
  return planes;
}

double distance_to(const glm::dvec4& plane, glm::dvec3 p) {
  return dot(glm::dvec3{plane}, p) + plane.w;
}

/// How far inside of a plane an object's boxes reach, and how far all of them are.
double farthest_corner(const ImpostorObject& object, const glm::dvec4& plane) {
  double most = -HUGE_VAL;
  for (const glm::dvec3& corner : object.corners)
    most = std::fmax(most, distance_to(plane, corner));
  return most;
}
double nearest_corner(const ImpostorObject& object, const glm::dvec4& plane) {
  double least = HUGE_VAL;
  for (const glm::dvec3& corner : object.corners) {
    least = std::fmin(least, distance_to(plane, corner));
  }
  return least;
}

bool is_out_of_view(const ImpostorObject& object, const ImpostorView& view) {
  return std::any_of(view.planes.begin(), view.planes.end(),
                     [&](const glm::dvec4& plane) { return farthest_corner(object, plane) < 0.0; });
}

/// How far the scene's eye moves in a frame.
double speed_of(const Camera& camera, double frame) {
  if (!moves(camera)) return 0.0;
  const double before = std::fmax(frame - 1.0, 0.0);
  return length_of(camera_matrices(camera, frame + 1.0, 1, 1).eye -
                   camera_matrices(camera, before, 1, 1).eye) /
         (frame + 1.0 - before);
}

glm::dvec3 up_for(glm::dvec3 direction) {
  constexpr double kAlongUp = 0.99;
  return std::fabs(direction.y) > kAlongUp ? glm::dvec3{0.0, 0.0, 1.0} : glm::dvec3{0.0, 1.0, 0.0};
}

/// None if the eye is too near, or the tolerance too strict.
std::optional<ImpostorChoice> choice_for(const ImpostorObject& object, std::size_t number,
                                         const ImpostorView& view, double tolerance_px) {
  const glm::dvec3 arm = view.camera.eye - object.middle;
  const double distance_m = length_of(arm);
  double shell_m = kNearestRadii * object.radius_m;
  if (distance_m < shell_m) return {};
  int shell = 0;
  for (; shell_m * kShellRatio <= distance_m; ++shell) shell_m *= kShellRatio;
  // Its eye stands in the shell's middle, and has the texels that the nearest eye wants.
  constexpr double kMiddle = 0.5 * (1.0 + kShellRatio);
  const double radius_px = object.radius_m / (shell_m * view.pixel_tangent);
  const double cell_radians = tolerance_px / radius_px;
  // n x n squares of this width have the area of the sphere: 4 pi = kSphere^2.
  constexpr double kSphere = 3.545;
  constexpr double kMostCells = 1 << 14;
  const double wanted = std::ceil(kSphere / cell_radians);
  if (!(wanted <= kMostCells)) return {};
  const int cells = std::max(static_cast<int>(wanted), 2);
  const glm::dvec2 place = octahedral_place(arm, false);
  const auto cell_of = [&](double along) {
    return std::clamp(static_cast<int>(along * cells), 0, cells - 1);
  };
  ImpostorChoice choice{};
  choice.cell = {number,
                 shell,
                 cells,
                 cell_of(place.x),
                 cell_of(place.y),
                 static_cast<float>(view.pixel_tangent)};
  const glm::dvec3 direction =
      octahedral_direction({(choice.cell.u + 0.5) / cells, (choice.cell.v + 0.5) / cells}, false);
  choice.view = {object.middle + direction * (shell_m * kMiddle), up_for(direction),
                 ReliefProjection::perspective};
  choice.texels_per_pixel = kMiddle * kTexelsPerPixel;
  const double across = std::fmin(2.0 * radius_px * kTexelsPerPixel, kMostReliefSize);
  choice.texels = across * across;
  const double cell_m = cell_radians * shell_m;
  const double renewals = std::fmin(view.speed_m / cell_m, 1.0);
  choice.geometry_ns = kTriangleNs * static_cast<double>(object.triangles);
  choice.cost_ns =
      kWarpNs * choice.texels + renewals * (choice.geometry_ns + kRenewalNs * choice.texels);
  return choice;
}

void hide(const ImpostorObject& object, std::vector<std::uint8_t>& hidden) {
  std::fill(hidden.begin() + static_cast<std::ptrdiff_t>(object.first),
            hidden.begin() + static_cast<std::ptrdiff_t>(object.end), std::uint8_t{1});
}

double bytes_for(const ImpostorChoice& choice) {
  return kReliefBytes + kTexelBytes * choice.texels;
}

void keep_to_memory(double bytes, ImpostorChoices& choices) {
  std::vector<ImpostorChoice>& chosen = choices.chosen;
  double sum = 0.0;
  for (const ImpostorChoice& choice : chosen) sum += bytes_for(choice);
  if (sum <= bytes) return;
  std::vector<std::size_t> order(chosen.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto saved = [&](std::size_t i) {
    return (chosen[i].geometry_ns - chosen[i].cost_ns) / chosen[i].texels;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return saved(a) > saved(b); });
  std::vector<std::size_t> fits;
  sum = 0.0;
  for (const std::size_t i : order) {
    const double more = bytes_for(chosen[i]);
    if (sum + more > bytes) continue;
    sum += more;
    fits.push_back(i);
  }
  std::sort(fits.begin(), fits.end());
  std::vector<ImpostorChoice> kept;
  kept.reserve(fits.size());
  for (const std::size_t i : fits) kept.push_back(chosen[i]);
  choices.counts.as_geometry += static_cast<int>(chosen.size() - kept.size());
  chosen = std::move(kept);
}

ImpostorChoices choices_for(const ImpostorObjects& objects, const ImpostorView& view,
                            double tolerance_px) {
  ImpostorChoices choices;
  choices.hidden.assign(objects.scene->objects.size(), 0);
  choices.counts.tolerance_px = tolerance_px;
  // A camera that looks nowhere sees nothing of anything.
  if (!std::isfinite(length_of(glm::dvec3{view.planes[0]}))) return choices;
  for (std::size_t i = 0; i < objects.all.size(); ++i) {
    const ImpostorObject& object = objects.all[i];
    if (is_out_of_view(object, view)) {
      hide(object, choices.hidden);
      ++choices.counts.out_of_view;
      continue;
    }
    const double depth_m = objects.scene->camera.near_m + farthest_corner(object, view.planes[0]);
    const bool is_cut = nearest_corner(object, view.planes[0]) < 0.0 || depth_m > view.farthest_m;
    const std::optional<ImpostorChoice> choice =
        is_cut ? std::nullopt : choice_for(object, i, view, tolerance_px);
    if (choice && (object.use == ImpostorUse::wherever_possible ||
                   choice->cost_ns < kMostCost * choice->geometry_ns)) {
      choices.chosen.push_back(*choice);
    } else {
      ++choices.counts.as_geometry;
    }
  }
  keep_to_memory(objects.scene->impostors.memory_mb * 1e6, choices);
  for (const ImpostorChoice& choice : choices.chosen) {
    hide(objects.all[choice.cell.object], choices.hidden);
    choices.counts.predicted_ms += 1e-6 * choice.cost_ns;
    choices.counts.texels += choice.texels;
  }
  for (std::size_t i = 0; i < choices.hidden.size(); ++i) {
    if (choices.hidden[i] != 0) continue;
    const Mesh& mesh = objects.scene->meshes[objects.scene->objects[i].mesh];
    choices.counts.triangles += static_cast<double>(mesh.indices.size()) / 3.0;
  }
  choices.counts.predicted_ms += 1e-6 * kTriangleNs * choices.counts.triangles;
  return choices;
}

}  // namespace

ImpostorChoices impostor_choices(const ImpostorObjects& objects, const CameraMatrices& camera,
                                 double frame, int height_px) {
  constexpr double kBeforeBackground = 0.999;
  const Scene& scene = *objects.scene;
  const ImpostorView view{camera, planes_of(camera), pixel_tangent_of(camera, height_px),
                          speed_of(scene.camera, frame),
                          kBeforeBackground * static_cast<double>(clear_colour(scene).w)};
  const ImpostorBudget& budget = scene.impostors;
  ImpostorChoices choices = choices_for(objects, view, budget.tolerance_px);
  if (budget.milliseconds == 0.0) return choices;
  for (int times = 2; times <= kMostTolerance; times *= 2) {
    if (choices.counts.predicted_ms <= budget.milliseconds) break;
    ImpostorChoices coarser = choices_for(objects, view, times * budget.tolerance_px);
    if (coarser.counts.predicted_ms >= choices.counts.predicted_ms) break;
    choices = std::move(coarser);
  }
  return choices;
}

void leave_as_geometry(const ImpostorObjects& objects, const ImpostorChoice& choice,
                       ImpostorChoices& choices) {
  const ImpostorObject& object = objects.all[choice.cell.object];
  for (std::size_t i = object.first; i < object.end; ++i) choices.hidden[i] = 0;
  ImpostorCounts& counts = choices.counts;
  ++counts.as_geometry;
  counts.triangles += static_cast<double>(object.triangles);
  counts.texels -= choice.texels;
  counts.predicted_ms += 1e-6 * (choice.geometry_ns - choice.cost_ns);
}

}  // namespace softfocus
