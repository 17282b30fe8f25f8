#include "tools/chart_scene.h"

#include <algorithm>
#include <chrono>

#include "measure/regions.h"
#include "scenes/load_scene.h"
#include "tools/errors.h"
#include "tools/lens_options.h"
#include "tools/scene_warnings.h"

namespace softfocus {
namespace {

using Clock = std::chrono::steady_clock;

double ms_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double, std::milli>(end - start).count();
}

}  // namespace

void check_scenes(const ChartOptions& options) {
  std::vector<std::string> names;
  for (const std::string& name : options.scenes) {
    const Scene scene = load_scene(name, scene_search_path(options.scene_path));
    check_lens(scene.lens.lens, {}, name);
    if (std::find(names.begin(), names.end(), scene.name) != names.end()) {
      throw UsageError("--scenes '" + name + "': another one is called " + scene.name +
                       " too; chart them one by one");
    }
    names.push_back(scene.name);
  }
}

ChartScene load_chart_scene(const std::string& name, const ChartOptions& options,
                            ThreadPool& pool) {
  ChartScene chart;
  const auto [width, height] = options.size;
  chart.scene = load_scene(name, scene_search_path(options.scene_path));
  print_scene_warnings(chart.scene.warnings, false);
  chart.frame = options.frame;
  chart.view = camera_view(chart.scene.camera, chart.frame, width, height);
  chart.lens = chart.scene.lens.lens;
  check_lens(chart.lens, {}, name);
  const double coc_scale = chart.scene.lens.coc_scale;
  chart.coc = checked_pixel_coc(chart.lens, chart.scene.camera.fov_y_degrees, height, coc_scale);
  chart.aperture_m = aperture_radius_m(chart.lens, coc_scale);
  chart.pinhole =
      draw_scene(chart.scene, chart.view, chart.frame, width, height, profiles().front(), pool);
  chart.labels = label_regions(chart.pinhole, chart.coc);
  return chart;
}

SceneMethodInput accumulation_input(const ChartScene& scene, int samples) {
  return {.scene = scene.scene,
          .view = scene.view,
          .frame = scene.frame,
          .pinhole = scene.pinhole,
          .focus_m = scene.lens.focus_m,
          .aperture_radius_m = scene.aperture_m,
          .sampling = {.samples = samples},
          .profile = profiles().front(),
          .progress = {}};
}

ChartRunner::ChartRunner(const ChartScene& scene, int most_samples, ThreadPool& pool)
    : scene_(scene), most_samples_(most_samples), pool_(pool) {
  const int width = scene.pinhole.width, height = scene.pinhole.height;
  drawn_ = make_image(Format::rgba16f, width, height);
  result_ = make_image(Format::rgba16f, width, height);
}

RunTime ChartRunner::run(const ChartEntry& entry) {
  return entry.filter != nullptr ? filter(entry) : accumulate(entry.samples);
}

RunTime ChartRunner::filter(const ChartEntry& entry) {
  const Profile profile = *find_profile(entry.profile);
  if (!prepared_.contains(entry.profile)) {
    prepared_.emplace(entry.profile, prepare_scene(scene_.scene, profile, pool_));
  }
  DofSettings settings;
  settings.coc = scene_.coc;
  if (entry.max_coc_px) settings.max_coc_px = *entry.max_coc_px;

  // Once without a clock: the contender before has filled the caches with its own.
  draw_scene(prepared_.at(entry.profile), scene_.view, scene_.frame, drawn_, pool_);
  entry.filter->apply({drawn_, settings, profile}, result_, pool_);

  const Clock::time_point start = Clock::now();
  draw_scene(prepared_.at(entry.profile), scene_.view, scene_.frame, drawn_, pool_);
  const Clock::time_point drawn = Clock::now();
  entry.filter->apply({drawn_, settings, profile}, result_, pool_);
  const Clock::time_point end = Clock::now();
  return {ms_between(start, end), ms_between(drawn, end)};
}

RunTime ChartRunner::accumulate(int samples) {
  const SceneMethodInput input = accumulation_input(scene_, most_samples_);
  if (!buffer_) {
    buffer_ = make_accumulation_buffer(input, pool_);
    sums_ = make_sample_sums(drawn_.width, drawn_.height);
  }
  // Likewise; its first group is enough of it.
  clear_sums(sums_);
  add_views(*buffer_, input, 0, std::min(kSampleGroup, samples), sums_, pool_);

  const Clock::time_point start = Clock::now();
  clear_sums(sums_);
  while (sums_.count < samples) {
    const int end = std::min(sums_.count + kSampleGroup, samples);
    add_views(*buffer_, input, sums_.count, end, sums_, pool_);
  }
  store_mean(sums_, scene_.pinhole, input.profile, result_, pool_);
  return {ms_between(start, Clock::now()), std::nullopt};
}

}  // namespace softfocus
