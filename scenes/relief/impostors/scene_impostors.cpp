#include "scenes/relief/impostors/scene_impostors.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "raster/numbers/vector_math.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/relief/impostors/octahedral_atlas.h"

namespace softfocus {
namespace {

// Nanoseconds with two threads, AVX2: of a triangle that is drawn; of a relief's texel that is
// warped and mapped, or drawn, read and searched for critical points.
constexpr double kTriangleNs = 24.0, kWarpNs = 3.5, kRenewalNs = 10.0;

// Each way: texels are filtered twice, by the warp and on the way to the picture.
constexpr double kTexelsPerPixel = 1.6;

// An impostor errs, and where it is large its errors are seen most: it has to cost at most so much
// of what geometry does.
constexpr double kMostCost = 0.5;

// The error of the relief is the mean of so many regions each way.
constexpr int kErrorRegions = 8;

// Of a relief, and of a texel.
constexpr double kReliefBytes =
    kErrorRegions * kErrorRegions * sizeof(std::optional<CriticalRegion>) +
    sizeof(SceneImpostors::Kept);
constexpr double kTexelBytes = sizeof(std::uint16_t) + sizeof(std::uint32_t);

// With a budget of milliseconds: the tolerance may grow so many times.
constexpr int kMostTolerance = 16;

constexpr int kBandRows = 32;

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

std::vector<ImpostorObject> impostor_objects(const Scene& scene,
                                             std::vector<std::vector<glm::dvec3>>& mesh_corners) {
  std::vector<ImpostorObject> found;
  mesh_corners.resize(scene.meshes.size());
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
      std::vector<glm::dvec3>& corners = mesh_corners[scene.objects[i].mesh];
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
    if (object.radius_m > 0.0) found.push_back(std::move(object));
  }
  return found;
}

/// A view, as the choice of what to draw needs it.
struct ImpostorView {
  const CameraMatrices& camera;
  std::array<glm::dvec4, 6> planes;  ///< inwards, of unit length: near, far, four sides
  double pixel_tangent;
  int height_px;
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

/// What is drawn in place of an object, and what both would cost.
struct ImpostorChoice {
  ReliefCell cell;
  ReliefView view;
  double texels_per_pixel;
  double texels;  ///< about
  double cost_ns, geometry_ns;
};

glm::dvec3 up_for(glm::dvec3 direction) {
  constexpr double kAlongUp = 0.99;
  return std::fabs(direction.y) > kAlongUp ? glm::dvec3{0.0, 0.0, 1.0} : glm::dvec3{0.0, 1.0, 0.0};
}

/// None if the eye is too near.
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
  // The sphere's area over so many cells, a square of which is cell_radians wide.
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

struct Choices {
  std::vector<ImpostorChoice> chosen;
  std::vector<std::uint8_t> hidden;  ///< of the scene's objects
  ImpostorCounts counts;
};

void hide(const ImpostorObject& object, std::vector<std::uint8_t>& hidden) {
  std::fill(hidden.begin() + static_cast<std::ptrdiff_t>(object.first),
            hidden.begin() + static_cast<std::ptrdiff_t>(object.end), std::uint8_t{1});
}

double bytes_for(const ImpostorChoice& choice) {
  return kReliefBytes + kTexelBytes * choice.texels;
}

void keep_to_memory(double bytes, Choices& choices) {
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

Choices choices_for(const SceneImpostors& impostors, const ImpostorView& view,
                    double tolerance_px) {
  Choices choices;
  choices.hidden.assign(impostors.scene->objects.size(), 0);
  choices.counts.tolerance_px = tolerance_px;
  // A camera that looks nowhere sees nothing of anything.
  if (!std::isfinite(length_of(glm::dvec3{view.planes[0]}))) return choices;
  for (std::size_t i = 0; i < impostors.objects.size(); ++i) {
    const ImpostorObject& object = impostors.objects[i];
    if (is_out_of_view(object, view)) {
      hide(object, choices.hidden);
      ++choices.counts.out_of_view;
      continue;
    }
    const double depth_m = impostors.scene->camera.near_m + farthest_corner(object, view.planes[0]);
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
  keep_to_memory(impostors.scene->impostors.memory_mb * 1e6, choices);
  for (const ImpostorChoice& choice : choices.chosen) {
    hide(impostors.objects[choice.cell.object], choices.hidden);
    choices.counts.predicted_ms += 1e-6 * choice.cost_ns;
    choices.counts.texels += choice.texels;
  }
  for (std::size_t i = 0; i < choices.hidden.size(); ++i) {
    if (choices.hidden[i] != 0) continue;
    const Mesh& mesh = impostors.scene->meshes[impostors.scene->objects[i].mesh];
    choices.counts.triangles += static_cast<double>(mesh.indices.size()) / 3.0;
  }
  choices.counts.predicted_ms += 1e-6 * kTriangleNs * choices.counts.triangles;
  return choices;
}

/// With a tolerance for which the predicted time is within the budget, if there is one.
Choices choices_in_time(const SceneImpostors& impostors, const ImpostorView& view) {
  const ImpostorBudget& budget = impostors.scene->impostors;
  Choices choices = choices_for(impostors, view, budget.tolerance_px);
  if (budget.milliseconds == 0.0) return choices;
  for (int times = 2; times <= kMostTolerance; times *= 2) {
    if (choices.counts.predicted_ms <= budget.milliseconds) break;
    Choices coarser = choices_for(impostors, view, times * budget.tolerance_px);
    if (coarser.counts.predicted_ms >= choices.counts.predicted_ms) break;
    choices = std::move(coarser);
  }
  return choices;
}

ReliefForm form_of(const SceneImpostors& impostors, const ImpostorChoice& choice,
                   const CameraMatrices& camera, int height_px) {
  CameraMatrices from = camera;
  from.eye = choice.view.eye;
  ImpostorSettings settings;
  settings.projection = choice.view.projection;
  settings.texels_per_pixel = choice.texels_per_pixel;
  settings.depth_bits = 16;
  return impostor_form(impostors.maker, from, settings, choice.view.up, height_px);
}

std::optional<DrawnRelief> new_relief(SceneImpostors& impostors, const ImpostorChoice& choice,
                                      const CameraMatrices& camera, double frame, int height_px,
                                      ThreadPool& pool) {
  ReliefMaker& maker = impostors.maker;
  const ImpostorObject& object = impostors.objects[choice.cell.object];
  maker.frame = frame;
  maker.points.clear();
  for (std::size_t i = object.first; i < object.end; ++i) {
    const Object& part = impostors.scene->objects[i];
    add_moved(impostors.mesh_corners[part.mesh], part, maker.points);
  }
  maker.chunks = chunks_of(maker.points);
  maker.middle = object.middle;
  maker.radius_m = object.radius_m;
  maker.prepared.hidden.assign(impostors.scene->objects.size(), 1);
  for (std::size_t i = object.first; i < object.end; ++i) maker.prepared.hidden[i] = 0;
  const ReliefForm form = form_of(impostors, choice, camera, height_px);
  ReliefTexture relief =
      begin_relief(maker, relief_camera(maker, choice.view, form.width, form.height), form);
  draw_layers(maker.prepared,
              relief_matrices(relief.camera, form.width, form.height, choice.view.eye), frame,
              maker.picture, {}, pool);
  read_relief(maker, form, choice.view.eye, relief, pool);
  ImpostorSettings settings;
  settings.regions = kErrorRegions;
  return known_relief(std::move(relief), settings, choice.view.eye, pool);
}

std::size_t bytes_of(const SceneImpostors::Kept& kept) {
  return sizeof kept + (kept.relief ? bytes_of(*kept.relief) : 0);
}

/// Those that were used longest ago go, but none of this view.
void drop_old_reliefs(SceneImpostors& impostors) {
  const double most = impostors.scene->impostors.memory_mb * 1e6;
  std::size_t sum = 0;
  for (const auto& [cell, kept] : impostors.kept) sum += bytes_of(kept);
  while (static_cast<double>(sum) > most) {
    auto oldest = impostors.kept.end();
    for (auto at = impostors.kept.begin(); at != impostors.kept.end(); ++at) {
      if (at->second.used == impostors.views) continue;
      if (oldest == impostors.kept.end() || at->second.used < oldest->second.used) oldest = at;
    }
    if (oldest == impostors.kept.end()) break;
    sum -= bytes_of(oldest->second);
    impostors.kept.erase(oldest);
  }
  impostors.counts.bytes = sum;
}

ThreadPool& alone(SceneImpostors::Worker& worker, Isa isa) {
  if (worker.alone == nullptr) worker.alone = std::make_unique<ThreadPool>(1, isa);
  return *worker.alone;
}

/// Warps the reliefs of a view.
void warp_all(SceneImpostors& impostors, std::span<const DrawnRelief* const> reliefs,
              const CameraMatrices& camera, int width, int height, ThreadPool& pool) {
  impostors.shown_count = reliefs.size();
  if (impostors.shown.size() < reliefs.size()) impostors.shown.resize(reliefs.size());
  for_each_with(impostors.workers, pool, static_cast<int>(reliefs.size()),
                [&](int number, SceneImpostors::Worker& worker) {
                  const auto i = static_cast<std::size_t>(number);
                  const DrawnRelief& relief = *reliefs[i];
                  SceneImpostors::Shown& shown = impostors.shown[i];
                  shown.relief = &relief.texture;
                  const PlaneRectangle place =
                      *warped_extent(relief.texture, relief.extent, camera.eye);
                  warp_relief(relief.texture, relief.extent, camera.eye, place, WarpRule{},
                              shown.warped, alone(worker, pool.isa()));
                  shown.mapping = plane_mapping(relief.texture, camera, place, width, height);
                });
}

// Neighbours that stay are a texel apart.
bool serves(const DrawnRelief& relief, glm::dvec3 eye, double tolerance_px) {
  return warped_extent(relief.texture, relief.extent, eye).has_value() &&
         impostor_error(relief, eye) <= 1.0 + kMostErrors * kTexelsPerPixel * tolerance_px;
}

std::vector<std::uint8_t> prepare_view(SceneImpostors& impostors, const CameraMatrices& camera,
                                       double frame, int width, int height, ThreadPool& pool) {
  const Scene& scene = *impostors.scene;
  ++impostors.views;
  if (impostors.shadows_move && impostors.frame != frame) impostors.kept.clear();
  impostors.frame = frame;
  constexpr double kBeforeBackground = 0.999;
  const ImpostorView view{camera,
                          planes_of(camera),
                          pixel_tangent_of(camera, height),
                          height,
                          speed_of(scene.camera, frame),
                          kBeforeBackground * static_cast<double>(clear_colour(scene).w)};
  Choices choices = choices_in_time(impostors, view);
  std::vector<const DrawnRelief*> reliefs;
  for (const ImpostorChoice& choice : choices.chosen) {
    const auto [place, is_new] = impostors.kept.try_emplace(choice.cell);
    SceneImpostors::Kept& kept = place->second;
    kept.used = impostors.views;
    if (is_new) {
      kept.relief = new_relief(impostors, choice, camera, frame, height, pool);
      ++choices.counts.renewed;
      choices.counts.renewed_texels += choice.texels;
      choices.counts.renewed_triangles +=
          static_cast<double>(impostors.objects[choice.cell.object].triangles);
    }
    if (!kept.relief) continue;
    if (serves(*kept.relief, camera.eye, choices.counts.tolerance_px)) {
      reliefs.push_back(&*kept.relief);
      continue;
    }
    const ImpostorObject& object = impostors.objects[choice.cell.object];
    for (std::size_t i = object.first; i < object.end; ++i) choices.hidden[i] = 0;
    ImpostorCounts& counts = choices.counts;
    ++counts.as_geometry;
    counts.triangles += static_cast<double>(object.triangles);
    counts.texels -= choice.texels;
    counts.predicted_ms += 1e-6 * (choice.geometry_ns - choice.cost_ns);
  }
  choices.counts.shown = static_cast<int>(reliefs.size());
  impostors.counts = choices.counts;
  drop_old_reliefs(impostors);
  warp_all(impostors, reliefs, camera, width, height, pool);
  return std::move(choices.hidden);
}

// --- laying them into layers ---

constexpr std::size_t kTexelHalves = 4;

Rectangle rows_of(const Rectangle& area, int first, int end) {
  return {area.x_begin, std::max(area.y_begin, first), area.x_end, std::min(area.y_end, end)};
}

std::uint16_t* texel_at(Image& image, int x, int y) {
  return row<std::uint16_t>(image, y).data() + kTexelHalves * static_cast<std::size_t>(x);
}

/// Where an impostor's share of the pixel ends, what lay there before shows, and the other way
/// round where its share is the smaller. Returns whether the impostor has the pixel's centre.
bool set_edge(const std::uint16_t* texel, float share, const std::uint16_t* first,
              EdgePictures& edges, int x, int y) {
  const bool has_centre = share >= 0.5f;
  const bool is_nearer = texel[3] < first[3];
  if (!is_nearer) return has_centre;
  std::uint8_t& coverage = row<std::uint8_t>(edges.coverage, y)[static_cast<std::size_t>(x)];
  const float others = has_centre ? 1.0f - share : share;
  const auto byte = static_cast<std::uint8_t>(others * 255.0f + 0.5f);
  if (!has_centre && byte <= coverage) return false;
  coverage = byte;
  std::copy_n(has_centre ? first : texel, kTexelHalves, texel_at(edges.other, x, y));
  return has_centre;
}

/// Puts a pixel among the layers, by its depth. Returns whether it is the first.
bool insert_pixel(const std::uint16_t* texel, std::span<Image* const> layers, int x, int y) {
  std::array<std::uint16_t, kTexelHalves> carried;
  std::copy_n(texel, kTexelHalves, carried.begin());
  bool is_in = false, is_first = false;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    std::uint16_t* at = texel_at(*layers[i], x, y);
    // Depths are positive halves, whose bits have their order.
    if (!is_in && carried[3] >= at[3]) continue;
    is_first = is_first || (!is_in && i == 0);
    is_in = true;
    for (std::size_t c = 0; c < kTexelHalves; ++c) std::swap(carried[c], at[c]);
  }
  return is_first;
}

/// What a view's impostors are laid into.
struct LaidInto {
  std::span<Image* const> layers;
  EdgePictures* edges;
  std::span<std::uint8_t> changed;
  std::uint16_t far;  ///< a half: scratch that shows nothing
};

/// Lays an area of one of them by way of the scratch.
void lay_area(SceneImpostors& impostors, const SceneImpostors::Shown& shown,
              const PlaneMapping& mapping, const LaidInto& into, ThreadPool& pool) {
  const Rectangle& area = mapping.area;
  Image& scratch = impostors.scratch;
  for (int y = area.y_begin; y < area.y_end; ++y) {
    for (int x = area.x_begin; x < area.x_end; ++x) texel_at(scratch, x, y)[3] = into.far;
  }
  map_relief(shown.warped, mapping, scratch, pool,
             into.edges != nullptr ? &impostors.shares : nullptr);
  for (int y = area.y_begin; y < area.y_end; ++y) {
    for (int x = area.x_begin; x < area.x_end; ++x) {
      const std::uint16_t* texel = texel_at(scratch, x, y);
      if (texel[3] == into.far) continue;
      if (into.edges != nullptr) {
        const float share = row<float>(impostors.shares, y)[static_cast<std::size_t>(x)];
        const std::uint16_t* first = texel_at(*into.layers[0], x, y);
        if (!set_edge(texel, share, first, *into.edges, x, y)) continue;
      }
      if (!insert_pixel(texel, into.layers, x, y) || into.changed.empty()) continue;
      into.changed[static_cast<std::size_t>(y) * static_cast<std::size_t>(scratch.width) +
                   static_cast<std::size_t>(x)] = 1;
    }
  }
}

void size_scratch(SceneImpostors& impostors, int width, int height) {
  if (impostors.scratch.width == width && impostors.scratch.height == height) return;
  impostors.scratch = make_image(Format::rgba16f, width, height);
  impostors.shares = make_image(Format::r32f, width, height);
}

void lay(SceneImpostors& impostors, std::span<Image* const> layers, EdgePictures* edges,
         std::span<std::uint8_t> changed, ThreadPool& pool) {
  const int width = layers[0]->width, height = layers[0]->height;
  const bool is_direct = layers.size() == 1 && edges == nullptr && changed.empty();
  if (!is_direct) size_scratch(impostors, width, height);
  const LaidInto into{layers, edges, changed,
                      float_to_half(clear_colour(*impostors.scene).w, HalfRounding::nearest_even)};
  const int bands = (height + kBandRows - 1) / kBandRows;
  for_each_with(impostors.workers, pool, bands, [&](int band, SceneImpostors::Worker& worker) {
    const int first = band * kBandRows, end = std::min(first + kBandRows, height);
    ThreadPool& one = alone(worker, pool.isa());
    for (std::size_t i = 0; i < impostors.shown_count; ++i) {
      const SceneImpostors::Shown& shown = impostors.shown[i];
      PlaneMapping mapping = shown.mapping;
      mapping.area = rows_of(mapping.area, first, end);
      if (mapping.area.y_begin >= mapping.area.y_end) continue;
      if (is_direct) {
        map_relief(shown.warped, mapping, *layers[0], one);
      } else {
        lay_area(impostors, shown, mapping, into, one);
      }
    }
  });
}

}  // namespace

bool has_impostors(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [](const Object& object) { return object.impostor != ImpostorUse::never; });
}

std::shared_ptr<SceneImpostors> make_scene_impostors(const Scene& scene, ThreadPool& pool) {
  auto impostors = std::make_shared<SceneImpostors>();
  impostors->scene = &scene;
  impostors->objects = impostor_objects(scene, impostors->mesh_corners);
  impostors->maker = relief_maker(scene, pool);
  impostors->maker.prepared.keeps_depth = true;
  impostors->shadows_move =
      has_shadows(scene) && std::any_of(scene.objects.begin(), scene.objects.end(),
                                        [](const Object& object) { return moves(object); });
  return impostors;
}

std::shared_ptr<const StandIns> stand_ins_of(const std::shared_ptr<SceneImpostors>& impostors) {
  auto stand_ins = std::make_shared<StandIns>();
  stand_ins->prepare = [impostors](const CameraMatrices& camera, double frame, int width,
                                   int height, ThreadPool& pool) {
    return prepare_view(*impostors, camera, frame, width, height, pool);
  };
  stand_ins->lay = [impostors](std::span<Image* const> layers, EdgePictures* edges,
                               std::span<std::uint8_t> changed,
                               ThreadPool& pool) { lay(*impostors, layers, edges, changed, pool); };
  return stand_ins;
}

}  // namespace softfocus
