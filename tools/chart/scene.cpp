#include "tools/chart/scene.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "dof/measure/regions.h"
#include "scenes/load/load_scene.h"
#include "tools/cli/errors.h"
#include "tools/options/lens_options.h"
#include "tools/options/run_options.h"

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
  chart.view = camera_matrices(chart.scene.camera, chart.frame, width, height);
  chart.lens = chart.scene.lens.lens;
  check_lens(chart.lens, {}, name);
  const double coc_scale = chart.scene.lens.coc_scale;
  chart.coc = checked_pixel_coc(chart.lens, chart.scene.camera.fov_y_degrees, height, coc_scale);
  chart.aperture_m = aperture_radius_m(chart.lens, coc_scale);
  chart.pinhole = draw_scene(chart.scene, chart.view, chart.frame, width, height, Profile{}, pool);
  chart.labels = label_regions(chart.pinhole, chart.coc);
  return chart;
}

LensViewInput accumulation_input(const ChartScene& scene, int samples) {
  return {.scene = scene.scene,
          .camera = scene.view,
          .frame = scene.frame,
          .pinhole = scene.pinhole,
          .focus_m = scene.lens.focus_m,
          .aperture_radius_m = scene.aperture_m,
          .sampling = {.samples = samples},
          .profile = Profile{},
          .progress = {}};
}

bool can_run(const ChartScene& scene, const ChartEntry& entry) {
  if (entry.arithmetic == Arithmetic::floats) return true;
  const float max_coc_px = entry.max_coc_px.value_or(DofSettings{}.max_coc_px);
  return fixed_settings_error({.coc = scene.coc, .max_coc_px = max_coc_px}) == nullptr;
}

ChartRunner::ChartRunner(const ChartScene& scene, ThreadPool& pool)
    : scene_(scene), views_(accumulation_input(scene, kSampleCounts.back())), pool_(pool) {
  const int width = scene.pinhole.width, height = scene.pinhole.height;
  drawn_ = make_image(Format::rgba16f, width, height);
  result_ = make_image(Format::rgba16f, width, height);
}

RunTime ChartRunner::run(const ChartEntry& entry) {
  if (entry.max_error) return choose(*entry.max_error);
  return entry.filter != nullptr ? filter(entry) : accumulate(entry.samples);
}

PreparedScene& ChartRunner::prepared_for(const std::string& profile) {
  const auto found = prepared_.find(profile);
  if (found != prepared_.end()) return found->second;
  return prepared_.emplace(profile, prepare_scene(scene_.scene, *find_profile(profile), pool_))
      .first->second;
}

void ChartRunner::filter_drawn(const Method& filter, float max_coc_px, const Profile& profile) {
  apply(filter, {drawn_, {.coc = scene_.coc, .max_coc_px = max_coc_px}, profile}, result_, pool_);
}

// What belongs to a lens is made once, as it would be for many frames.
const FixedTable& ChartRunner::table_for(float max_coc_px) {
  const auto found = tables_.find(max_coc_px);
  if (found != tables_.end()) return found->second;
  const fixed::Lens lens = fixed_lens({.coc = scene_.coc, .max_coc_px = max_coc_px});
  return tables_.emplace(max_coc_px, fixed_table(half_table(lens))).first->second;
}

void ChartRunner::filter_drawn(const ChartEntry& entry, const Profile& profile) {
  const float max_coc_px = entry.max_coc_px.value_or(DofSettings{}.max_coc_px);
  if (entry.arithmetic == Arithmetic::fixed_8) {
    two_pass_bytes(drawn_, table_for(max_coc_px), result_, pool_);
  } else {
    filter_drawn(*entry.filter, max_coc_px, profile);
  }
}

RunTime ChartRunner::filter(const ChartEntry& entry) {
  const Profile profile = *find_profile(entry.profile);
  PreparedScene& prepared = prepared_for(entry.profile);
  // Once without a clock: the contender before has filled the caches with its own.
  draw_scene(prepared, scene_.view, scene_.frame, drawn_, pool_);
  filter_drawn(entry, profile);

  const Clock::time_point start = Clock::now();
  draw_scene(prepared, scene_.view, scene_.frame, drawn_, pool_);
  const Clock::time_point drawn = Clock::now();
  filter_drawn(entry, profile);
  const Clock::time_point end = Clock::now();
  return {ms_between(start, end), ms_between(drawn, end)};
}

// Likewise: a first group is enough.
void ChartRunner::warm_up_views() {
  if (!buffer_) {
    buffer_ = make_accumulation_buffer(views_, pool_);
    sums_ = make_sample_sums(drawn_.width, drawn_.height);
  }
  clear_sums(sums_);
  add_lens_views(*buffer_, views_, 0, kLensViewGroup, sums_, pool_);
}

void ChartRunner::add_all_views(int samples) {
  clear_sums(sums_);
  while (sums_.count < samples) {
    const int end = std::min(sums_.count + kLensViewGroup, samples);
    add_lens_views(*buffer_, views_, sums_.count, end, sums_, pool_);
  }
  store_mean(sums_, scene_.pinhole, views_.profile, result_, pool_);
}

RunTime ChartRunner::accumulate(int samples) {
  warm_up_views();
  const Clock::time_point start = Clock::now();
  add_all_views(samples);
  return {ms_between(start, Clock::now()), std::nullopt};
}

void ChartRunner::carry_out(const AutoMethod& choice) {
  if (choice.samples > 0) return add_all_views(choice.samples);
  if (is_sharp(choice)) return std::swap(drawn_, result_);
  filter_drawn(*find_method(choice.method), choice.radius_px, views_.profile);
}

RunTime ChartRunner::choose(double max_error) {
  PreparedScene& prepared = prepared_for("ieee");
  const auto chosen = [&] {
    return auto_method(scene_traits(drawn_, scene_.coc, pool_), {max_error},
                       {{}, triangle_count(scene_.scene)});
  };
  draw_scene(prepared, scene_.view, scene_.frame, drawn_, pool_);
  const AutoMethod before = chosen();
  chosen_ = setting_text(before);
  if (before.samples > 0) {
    warm_up_views();
  } else {
    carry_out(before);
  }

  const Clock::time_point start = Clock::now();
  draw_scene(prepared, scene_.view, scene_.frame, drawn_, pool_);
  const Clock::time_point drawn = Clock::now();
  carry_out(chosen());
  const Clock::time_point end = Clock::now();
  return {ms_between(start, end), ms_between(drawn, end)};
}

}  // namespace softfocus
