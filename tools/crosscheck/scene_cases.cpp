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

// Making a scene's textures takes longer than drawing it small: each is loaded once.
const Scene& loaded(const std::string& name) {
  static std::map<std::string, Scene> scenes;
  auto found = scenes.find(name);
  if (found == scenes.end()) {
    found = scenes.emplace(name, load_scene(name, scene_search_path({}))).first;
  }
  return found->second;
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
  const Scene& scene = loaded(what.scene);
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

}  // namespace

void add_scene_cases(std::vector<Case>& cases) {
  const auto add = [&](const SceneCase& what, bool quick, bool slow_too) {
    std::string name = what.scene + '-' + std::to_string(what.width) + 'x' +
                       std::to_string(what.height) + "-frame" +
                       std::to_string(static_cast<int>(what.frame));
    std::replace(name.begin(), name.end(), ':', '-');  // a file of --diff has this name
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
  for (const char* scene : {"bright-edges", "clutter", "dunes", "foliage", "grazing-floor",
                            "interior", "lattice", "near-fence", "night-lights", "portrait",
                            "random:1", "random:6", "random:20", "random:48"}) {
    add({scene, 128, 96, 7, nullptr}, true, true);
    add({scene, 512, 512, 7, nullptr}, false, false);
    add({scene, 512, 512, 7, "two-pass"}, false, false);
    add({scene, 333, 517, 0, "one-pass"}, false, false);
  }
}

}  // namespace softfocus
