#include "tools/chart/scene.h"

#include <algorithm>

#include "dof/measure/regions.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/load/load_scene.h"
#include "tools/cli/errors.h"
#include "tools/options/lens_options.h"
#include "tools/options/run_options.h"

namespace softfocus {
namespace {

bool moves(const Scene& scene) {
  return moves(scene.camera) || std::any_of(scene.objects.begin(), scene.objects.end(),
                                            [](const Object& object) { return moves(object); });
}

// Changes a scene as the subject asks.
void prepare_for(const ChartSubject& subject, ChartScene& chart) {
  chart.sampling = subject.sampling;
  // Its pinhole is without, and each contender gives all lights its own. Reliefs have none.
  if (subject.ranked[0].value == kShadowErrors[0].value || subject.turns)
    set_shadows(chart.scene, ShadowKind::none);
  if (subject.sampling.shutter_frames == 0.0) return;
  Camera& camera = chart.scene.camera;
  if (camera.shutter_frames > 0.0) chart.sampling.shutter_frames = camera.shutter_frames;
  if (!moves(chart.scene)) camera.orbit_degrees_per_frame = subject.orbit_degrees_per_frame;
}

}  // namespace

std::vector<ReadFile> check_scenes(const ChartOptions& options) {
  std::vector<std::string> names;
  std::vector<ReadFile> files;
  for (const std::string& name : options.scenes) {
    const Scene scene = load_scene(name, scene_search_path(options.scene_path));
    check_lens(scene.lens.lens, {}, name);
    if (std::find(names.begin(), names.end(), scene.name) != names.end()) {
      throw UsageError("--scenes '" + name + "': another one is called " + scene.name +
                       " too; chart them one by one");
    }
    names.push_back(scene.name);
    for (const auto& file : scene.files)
      files.push_back({file, "a file of the scene " + scene.name});
  }
  return files;
}

ChartScene load_chart_scene(const std::string& name, const ChartOptions& options,
                            ThreadPool& pool) {
  ChartScene chart;
  const auto [width, height] = options.size;
  chart.scene = load_scene(name, scene_search_path(options.scene_path), &pool);
  print_scene_warnings(chart.scene.warnings, false);
  chart.subject = options.subject;
  prepare_for(*options.subject, chart);
  chart.frame = options.frame;
  chart.view = camera_matrices(chart.scene.camera, chart.frame, width, height);
  chart.lens = lens_at(chart.scene.lens, chart.frame);
  check_lens(chart.lens, {}, name);
  const double coc_scale = chart.scene.lens.coc_scale;
  chart.coc = checked_pixel_coc(chart.lens, chart.scene.camera.fov_y_degrees, height, coc_scale);
  if (options.subject->through_lens) chart.aperture_m = aperture_radius_m(chart.lens, coc_scale);
  chart.pinhole = draw_scene(chart.scene, chart.view, chart.frame, width, height, Profile{}, pool);
  if (options.subject->turns) chart.pinhole = options.subject->truth_of(chart, pool);
  chart.labels = label_regions(chart.pinhole, chart.coc);
  return chart;
}

LensViewInput accumulation_input(const ChartScene& scene, int samples) {
  Sampling sampling = scene.sampling;
  sampling.samples = samples;
  return {.scene = scene.scene,
          .camera = scene.view,
          .frame = scene.frame,
          .pinhole = scene.pinhole,
          .focus_m = scene.lens.focus_m,
          .aperture_radius_m = scene.aperture_m,
          .sampling = sampling,
          .profile = Profile{},
          .progress = {}};
}

}  // namespace softfocus
