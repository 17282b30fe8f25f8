// Stages `scene` and `frame`: the scenes drawn, and drawn and filtered.

#include <algorithm>
#include <map>
#include <memory>

#include "scenes/draw/draw_scene.h"
#include "scenes/load/load_scene.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/filter_on_gl.h"
#include "tools/gl/scene_on_gl.h"

namespace softfocus {
namespace {

constexpr std::string_view kTies = "ties", kPanes = "panes";

// Many triangles over each other at one depth, in two objects of one mesh. The first submitted is
// the nearest.
Scene tied_triangles() {
  Scene scene;
  scene.name = kTies;
  scene.camera = {.position = {0, 0, 0}, .target = {0, 0, -1}, .near_m = 0.5, .far_m = 50};
  RandomNumbers random{5};
  Mesh mesh;
  for (int i = 0; i < 3 * 200; ++i) {
    const float depth_m = 2.0f + 0.5f * static_cast<float>(i / 3 % 3);
    mesh.positions.push_back({random.between(-2.0f, 2.0f), random.between(-2.0f, 2.0f), -depth_m});
    mesh.normals.push_back({random.between(-0.5f, 0.5f), random.between(-0.5f, 0.5f), 0.7f});
    mesh.indices.push_back(static_cast<std::uint32_t>(i));
  }
  scene.meshes.push_back(std::move(mesh));
  scene.lights.push_back({LightKind::directional, {0.3f, 0.4f, 1.0f}, glm::vec3{1.0f}});
  for (std::uint32_t i = 0; i < 2; ++i) {
    Material material;
    material.diffuse = i == 0 ? glm::vec3{0.9f, 0.3f, 0.2f} : glm::vec3{0.2f, 0.4f, 0.9f};
    material.two_sided = true;
    scene.materials.push_back(material);
    Object object;
    object.material = i;
    scene.objects.push_back(object);
  }
  return scene;
}

// Those triangles, transparent, about a wall that is not.
Scene random_panes() {
  Scene scene = tied_triangles();
  scene.name = kPanes;
  scene.materials[0].opacity = 0.4f;
  scene.materials[1].opacity = 0.7f;
  scene.materials[1].specular = glm::vec3{0.6f};
  Material wall;
  wall.two_sided = true;
  wall.diffuse = {0.7f, 0.7f, 0.5f};
  scene.materials.push_back(wall);
  Mesh mesh;
  mesh.positions = {{-3, -3, -3.1f}, {3, -2, -2.9f}, {0, 3, -2.2f}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.indices = {0, 1, 2};
  scene.meshes.push_back(std::move(mesh));
  Object object;
  object.mesh = 1;
  object.material = 2;
  scene.objects.push_back(object);
  return scene;
}

Scene made_or_loaded(const std::string& name) {
  if (name == kTies) return tied_triangles();
  if (name == kPanes) return random_panes();
  return load_scene(name, scene_search_path({}));
}

struct SceneCase {
  std::string scene;
  int width;
  int height;
  double frame;
  const char* method = nullptr;  ///< none: not filtered
};

DofSettings settings_of(const Scene& scene, int height) {
  DofSettings settings;
  settings.coc =
      pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, height, scene.lens.coc_scale);
  settings.max_coc_px = static_cast<float>(scene.lens.max_coc_px_at_1024 * height / 1024.0);
  return settings;
}

void scene_both(const Bench& bench, Tally& tally, const SceneCase& what) {
  const Scene& scene = loaded_scene(what.scene);
  const CameraMatrices view = camera_matrices(scene.camera, what.frame, what.width, what.height);
  GlScene on_gl{bench.gl, bench.shaders, scene};
  const GlTarget drawn = make_scene_target(what.width, what.height);
  on_gl.draw(view, what.frame, drawn);
  const Image emulated =
      draw_scene(scene, view, what.frame, what.width, what.height, bench.profile, bench.pool);
  if (what.method == nullptr) {
    add_pictures(tally, read_colour(drawn, 0), emulated);
    return;
  }
  const DofSettings settings = settings_of(scene, what.height);
  const GlTarget filtered = filter_on_gl(bench.gl, bench.shaders, what.method, settings,
                                         drawn.colour[0], what.width, what.height);
  add_pictures(tally, read_colour(filtered, 0),
               apply(*find_method(what.method), {emulated, settings, bench.profile}, bench.pool));
}

constexpr std::size_t kPeeledLayers = 3;

void layers_both(const Bench& bench, Tally& tally, const SceneCase& what) {
  const Scene& scene = loaded_scene(what.scene);
  const CameraMatrices view = camera_matrices(scene.camera, what.frame, what.width, what.height);
  GlScene on_gl{bench.gl, bench.shaders, scene};
  const std::vector<Image> drawn =
      on_gl.draw_layers(view, what.frame, what.width, what.height, kPeeledLayers);
  const std::vector<Image> emulated = draw_layers(scene, view, what.frame, what.width, what.height,
                                                  kPeeledLayers, bench.profile, bench.pool);
  for (std::size_t i = 0; i < kPeeledLayers; ++i) add_pictures(tally, drawn[i], emulated[i]);
}

std::string size_and_frame(const SceneCase& what) {
  std::string name = what.scene + '-' + std::to_string(what.width) + 'x' +
                     std::to_string(what.height) + "-frame" +
                     std::to_string(static_cast<int>(what.frame));
  std::replace(name.begin(), name.end(), ':', '-');  // a file of --diff has this name
  return name;
}

}  // namespace

const Scene& loaded_scene(const std::string& name) {
  static std::map<std::string, Scene> scenes;
  auto found = scenes.find(name);
  if (found == scenes.end()) {
    found = scenes.emplace(name, made_or_loaded(name)).first;
  }
  return found->second;
}

void add_peel_cases(std::vector<Case>& cases) {
  const auto add = [&](const SceneCase& what, bool quick, bool slow_too) {
    cases.push_back(
        {"peel", size_and_frame(what), quick, slow_too,
         [what](const Bench& bench, Tally& tally) { layers_both(bench, tally, what); }});
  };
  for (const char* scene : {"ties", "sphere-world", "near-fence", "foliage", "lattice", "interior",
                            "canopy", "random:6", "random:20"}) {
    add({scene, 128, 96, 7}, true, true);
    add({scene, 512, 512, 7}, false, false);
  }
  add({"clutter", 333, 517, 31}, false, false);
}

void add_blend_cases(std::vector<Case>& cases) {
  const auto add = [&](const SceneCase& what, bool quick, bool slow_too) {
    cases.push_back({"blend", size_and_frame(what), quick, slow_too,
                     [what](const Bench& bench, Tally& tally) { scene_both(bench, tally, what); }});
  };
  for (const char* scene : {"panes", "glass"}) {
    add({scene, 128, 96, 7}, true, true);
    add({scene, 1, 1, 3}, false, true);
    add({scene, 512, 512, 7}, false, false);
    add({scene, 333, 517, 31}, false, false);
  }
}

void add_scene_cases(std::vector<Case>& cases) {
  const auto add = [&](const SceneCase& what, bool quick, bool slow_too) {
    std::string name = size_and_frame(what);
    if (what.method != nullptr) name += std::string("-") + what.method;
    cases.push_back({what.method == nullptr ? "scene" : "frame", name, quick, slow_too,
                     [what](const Bench& bench, Tally& tally) { scene_both(bench, tally, what); }});
  };
  for (const char* scene : {"figures", "cube-room", "sphere-world"}) {
    for (const char* method : {static_cast<const char*>(nullptr), "two-pass", "one-pass"}) {
      add({scene, 128, 96, 7, method}, true, true);
      add({scene, 1, 1, 3, method}, false, true);
      add({scene, 1, 300, 3, method}, false, true);
      add({scene, 512, 512, 0, method}, false, false);
      add({scene, 333, 517, 31, method}, false, false);
      add({scene, 1024, 512, 12, method}, false, false);
      if (method != nullptr && method == std::string_view("one-pass")) continue;  // for its time
      add({scene, 1024, 1024, 60, method}, false, false);
      if (method != nullptr) continue;
      add({scene, 512, 512, 7, method}, false, false);
      add({scene, 512, 512, 100, method}, false, false);
    }
  }
  for (const char* scene : {"bright-edges", "canopy", "clutter", "dunes", "foliage",
                            "grazing-floor", "interior", "lattice", "near-fence", "night-lights",
                            "portrait", "random:1", "random:6", "random:20", "random:48"}) {
    add({scene, 128, 96, 7, nullptr}, true, true);
    add({scene, 512, 512, 7, nullptr}, false, false);
    add({scene, 512, 512, 7, "two-pass"}, false, false);
    add({scene, 333, 517, 0, "one-pass"}, false, false);
  }
}

}  // namespace softfocus
