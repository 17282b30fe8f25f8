#include "scenes/load/scene_sections.h"

#include <map>
#include <optional>
#include <utility>

#include "raster/numbers/random_bits.h"
#include "scenes/load/model_scene.h"
#include "scenes/make/shapes.h"

namespace softfocus {
namespace {

constexpr Range kAnyAngle{-36000.0, 36000.0};

ImpostorUse read_impostor(Section& section) {
  const toml::node* node = find_key(section, "impostor");
  if (node == nullptr) return ImpostorUse::never;
  if (node->is_boolean()) {
    return *node->value<bool>() ? ImpostorUse::wherever_possible : ImpostorUse::never;
  }
  if (node->value<std::string_view>() == "auto") return ImpostorUse::where_cheaper;
  fail_at(section, "impostor", "is none of true, false and \"auto\"");
}

// Where and how an object stands and moves; mesh and material are the caller's.
Object read_placement(Section& section) {
  Object object;
  object.position = read_vector(section, "position", object.position, kAnyPlace);
  object.rotation_degrees =
      read_vector(section, "rotation_degrees", object.rotation_degrees, kAnyAngle);
  const toml::node* scale = find_key(section, "scale");
  if (scale != nullptr && scale->is_array()) {
    object.scale = read_vector(section, "scale", object.scale, kAnySize);
  } else {
    object.scale = glm::dvec3{read_number(section, "scale", 1.0, kAnySize)};
  }
  object.spin_degrees_per_frame =
      read_vector(section, "spin_degrees_per_frame", object.spin_degrees_per_frame, kAnyAngle);
  object.sway = read_vector(section, "sway", object.sway, kAnyPlace);
  object.sway_period_frames = read_number(section, "sway_period_frames", 100.0, {1.0, 1e6});
  object.sway_phase = read_number(section, "sway_phase", object.sway_phase, {-1.0, 1.0});
  object.impostor = read_impostor(section);
  if (object.impostor != ImpostorUse::never && moves(object)) {
    fail_at(section, "impostor",
            "is of an object that moves; false, or neither spin nor sway, would be right");
  }
  return object;
}

// Of all meshes of a scene: a gigabyte, and more than a picture has pixels.
constexpr std::size_t kMostTriangles = 25'000'000;

void check_triangles(const Section& section, const Scene& scene, const Mesh& next) {
  std::size_t count = next.indices.size() / 3;
  for (const Mesh& mesh : scene.meshes) count += mesh.indices.size() / 3;
  if (count <= kMostTriangles) return;
  fail_at(section, "shape",
          "with this one the scene's meshes have " + std::to_string(count) +
              " triangles; fewer segments, rings or cells would do, for up to " +
              std::to_string(kMostTriangles));
}

std::uint32_t add_mesh(const Section& section, Scene& scene, Mesh mesh) {
  check_triangles(section, scene, mesh);
  scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(scene.meshes.size() - 1);
}

std::uint32_t read_material_key(Section& section, const NamedSurfaces& surfaces) {
  if (!has_key(section, "material")) {
    fail_at(section, "material", "is missing; the name of a [material.NAME] table would be right");
  }
  return material_named(section, "material", read_text(section, "material", ""), surfaces);
}

/// The objects of a model's file that has been read, for others of the same file.
struct ReadModel {
  std::size_t first_object, count;
};
/// By the file, and whether it has its own materials.
using ReadModels = std::map<std::pair<std::filesystem::path, bool>, ReadModel>;

void read_model(Section& section, const std::filesystem::path& directory,
                const NamedSurfaces& surfaces, ReadModels& models, Scene& scene, ThreadPool* pool) {
  if (!has_key(section, "file")) {
    fail_at(section, "file",
            "is missing; the path of a model, .gltf, .glb, .obj, .ply or .stl, would be right");
  }
  const Object placement = read_placement(section);
  std::optional<std::uint32_t> material;
  if (has_key(section, "material")) material = read_material_key(section, surfaces);
  const std::filesystem::path file = directory / read_text(section, "file", "");
  const auto [place, is_new] = models.try_emplace({file, !material}, ReadModel{});
  ReadModel& model = place->second;
  if (is_new) {
    model.first_object = scene.objects.size();
    add_model(scene, load_model(file, pool), placement, material);
    model.count = scene.objects.size() - model.first_object;
    return;
  }
  const auto number = static_cast<std::uint32_t>(scene.objects.size() + 1);
  for (std::size_t i = 0; i < model.count; ++i) {
    const Object& same = scene.objects[model.first_object + i];
    Object object = placement;
    object.model = number;
    object.mesh = same.mesh;
    object.mesh_origin = same.mesh_origin;
    object.motion = same.motion;
    object.material = material.value_or(same.material);
    scene.objects.push_back(object);
  }
}

void read_object(Section& section, const std::filesystem::path& directory,
                 const NamedSurfaces& surfaces, ReadModels& models, Scene& scene,
                 ThreadPool* pool) {
  if (is_model(section)) return read_model(section, directory, surfaces, models, scene, pool);
  Object object = read_placement(section);
  object.material = read_material_key(section, surfaces);
  object.mesh = add_mesh(section, scene, read_shape(section));
  scene.objects.push_back(object);
}

BallRule read_ball_rule(Section& section, double mesh_radius) {
  BallRule rule;
  rule.count = read_whole_number(section, "count", 1, 1, kMostBalls);
  rule.seed = static_cast<std::uint64_t>(read_whole_number(section, "seed", 1, 0, 1 << 30));
  rule.region_min = read_vector(section, "region_min", rule.region_min, kAnyPlace);
  rule.region_max = read_vector(section, "region_max", rule.region_max, kAnyPlace);
  for (int axis = 0; axis < 3; ++axis) {
    if (rule.region_min[axis] > rule.region_max[axis]) {
      fail_at(section, "region_min", "must not exceed region_max along any axis");
    }
  }
  const auto scales = read_numbers(section, "scale_range", {1.0, 1.0}, 2, kAnySize);
  if (scales[0] > scales[1]) {
    fail_at(section, "scale_range", "must have the smaller number first");
  }
  rule.radius_min = scales[0] * mesh_radius;
  rule.radius_max = scales[1] * mesh_radius;
  rule.gap = read_number(section, "gap", rule.gap, {0.0, 1e6});
  rule.on_ground = read_flag(section, "on_ground", rule.on_ground);
  return rule;
}

void read_balls(Section& section, const NamedSurfaces& surfaces, std::vector<Ball>& placed,
                Scene& scene) {
  Mesh mesh = read_shape(section);
  const double mesh_radius = bounding_radius(mesh);
  const BallRule rule = read_ball_rule(section, mesh_radius);

  std::vector<std::uint32_t> materials;
  for (const std::string& name : read_texts(section, "materials")) {
    materials.push_back(material_named(section, "materials", name, surfaces));
  }
  if (materials.empty()) {
    fail_at(section, "materials", "is missing; an array of names of materials would be right");
  }
  const bool turned = read_flag(section, "turned", false);
  std::vector<Ball> obstacles = placed;
  for (const auto& row : read_rows(section, "avoid", 4, kAnyPlace)) {
    if (row[3] < 0.0) {
      fail_at(section, "avoid", "has a negative radius; [x, y, z, radius] would be right");
    }
    obstacles.push_back({{row[0], row[1], row[2]}, row[3]});
  }

  const auto balls = place_balls(rule, obstacles);
  if (!balls) {
    fail_at(section, "count",
            "there is no room for so many in the region; a larger region, a smaller count, "
            "scale_range or gap would do");
  }
  // Of a sequence of its own, so that turning moves nothing.
  RandomSequence random{mix_bits(rule.seed)};
  Object object;
  object.mesh = add_mesh(section, scene, std::move(mesh));
  for (const Ball& ball : *balls) {
    object.position = ball.centre;
    object.scale = glm::dvec3{ball.radius / mesh_radius};
    object.material = materials[static_cast<std::size_t>(next_bits(random) % materials.size())];
    if (turned) {
      for (int axis = 0; axis < 3; ++axis) {
        object.rotation_degrees[axis] = next_between(random, 0.0, 360.0);
      }
    }
    scene.objects.push_back(object);
  }
  placed.insert(placed.end(), balls->begin(), balls->end());
}

}  // namespace

void read_objects(Section& top, const std::filesystem::path& directory,
                  const NamedSurfaces& surfaces, Scene& scene, ThreadPool* pool) {
  ReadModels models;
  for (Section& section : read_sections(top, "object")) {
    read_object(section, directory, surfaces, models, scene, pool);
    finish_section(section);
  }
  std::vector<Ball> placed;
  for (Section& section : read_sections(top, "scatter")) {
    read_balls(section, surfaces, placed, scene);
    finish_section(section);
  }
}

}  // namespace softfocus
