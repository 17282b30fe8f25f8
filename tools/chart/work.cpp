#include "tools/chart/work.h"

#include <algorithm>

#include "tools/chart/key.h"
#include "tools/chart/measure.h"
#include "tools/chart/record.h"
#include "tools/chart/scene.h"
#include "tools/chart/time_left.h"
#include "tools/chart/truth.h"
#include "tools/cli/progress.h"
#include "tools/golden/hashes.h"

namespace softfocus {
namespace {

/// Slower contenders are timed less often.
constexpr double kLongMs = 1000.0;
constexpr std::size_t kRoundsOfLong = 3;

/// About how many drawings of a pinhole's picture each takes, to estimate the time left.
constexpr double kFilterCost = 6.0, kAutoCost = 60.0, kMeasureCost = 40.0;

double cost_of(const ChartEntry& entry) {
  if (entry.max_error) return kAutoCost;
  return entry.filter != nullptr ? kFilterCost : static_cast<double>(entry.samples);
}

/// What goes along with the work on all scenes.
struct Work {
  const ChartOptions& options;
  ThreadPool& pool;
  std::vector<ChartEntry> entries;
  ChartFindings findings;
  Progress progress{};
  TimeLeft left;

  void show(const std::string& stage) {
    const double seconds = left.seconds();
    progress.show(seconds > 0.0 ? stage + "; " + time_left_text(seconds) : stage);
  }
};

std::vector<ChartEntry> wanted_entries(const ChartOptions& options) {
  std::vector<ChartEntry> entries;
  for (const std::string& method : options.methods) {
    for (ChartEntry& entry : chart_entries(method, options.size.height, options.quick)) {
      entries.push_back(std::move(entry));
    }
  }
  return entries;
}

double all_units(const ChartOptions& options, const std::vector<ChartEntry>& entries) {
  double units = options.truth_samples;
  for (const ChartEntry& entry : entries) {
    units += kMeasureCost + (options.rounds + 1) * cost_of(entry);
  }
  return units * static_cast<double>(options.scenes.size());
}

ChartTruth truth_of(Work& work, const ChartScene& scene, const std::string& key) {
  const int samples = work.options.truth_samples;
  const std::filesystem::path file =
      work.options.directory / "cache" / (scene.scene.name + ".truth");
  ++work.findings.all;
  if (!work.options.again) {
    if (auto kept = load_truth(key, file)) {
      ++work.findings.kept;
      work.left.skipped(samples);
      return std::move(*kept);
    }
  }
  int before = 0;
  ChartTruth truth = make_truth(
      scene, samples,
      [&](int done) {
        work.left.done(done - before);
        before = done;
        work.show(scene.scene.name + ": ground truth, " + std::to_string(done) + " of " +
                  std::to_string(samples) + " samples");
      },
      work.pool);
  save_truth(truth, key, file);
  return truth;
}

/// Where no circle is larger than the smallest radius, all radii give one picture.
void measure_once(ChartPoint& point, const std::vector<ChartPoint>& before, const Image& picture,
                  const ChartTruth& truth, const ChartScene& scene, ThreadPool& pool) {
  const auto same = std::find_if(before.begin(), before.end(), [&](const ChartPoint& other) {
    return other.picture_hash == point.picture_hash;
  });
  if (same == before.end()) {
    measure_point(point, picture, truth.picture, scene.labels, pool);
    return;
  }
  point.errors = same->errors;
  point.worst = same->worst;
  point.pictures = same->pictures;
}

/// Draws each contender's picture once, which also wakes it up for the timing, and measures
/// those that are not kept.
void measure_errors(Work& work, const ChartScene& scene, const ChartTruth& truth,
                    const std::string& key, const std::filesystem::path& folder,
                    ChartRunner& runner, std::vector<ChartPoint>& points) {
  for (const ChartEntry& entry : work.entries) {
    if (!can_run(scene, entry)) {
      work.left.skipped(kMeasureCost + (work.options.rounds + 1) * cost_of(entry));
      continue;
    }
    work.show(scene.scene.name + ": error of " + entry.method + ", " + settings_text(entry));
    ChartPoint point{.entry = entry};
    runner.run(entry);
    if (entry.max_error) point.entry.chosen = runner.chosen();
    point.picture_hash = hash_image(runner.result());
    work.left.done(cost_of(entry));
    ++work.findings.all;
    const std::filesystem::path file = folder / (entry_id(entry) + ".json");
    if (!work.options.again && load_point(point, key, file)) {
      ++work.findings.kept;
      work.left.skipped(kMeasureCost);
    } else {
      measure_once(point, points, runner.result(), truth, scene, work.pool);
      save_point(point, key, file);
      work.left.done(kMeasureCost);
    }
    points.push_back(std::move(point));
  }
}

std::size_t wanted_rounds(const ChartPoint& point, std::size_t rounds) {
  const auto& ms = point.times.frame_ms;
  const bool takes_long = !ms.empty() && *std::min_element(ms.begin(), ms.end()) > kLongMs;
  return takes_long ? std::min(rounds, kRoundsOfLong) : rounds;
}

/// Round by round over all contenders, so that what disturbs the machine disturbs all.
void measure_times(Work& work, const ChartScene& scene, const std::filesystem::path& folder,
                   ChartRunner& runner, std::vector<ChartPoint>& points) {
  const std::string key = machine_key(work.options.pool);
  const std::filesystem::path file = folder / "times.json";
  const auto rounds = static_cast<std::size_t>(work.options.rounds);
  if (!work.options.again) load_times(points, key, file);
  for (const ChartPoint& point : points) {
    const std::size_t there = std::min(point.times.frame_ms.size(), rounds);
    work.left.skipped(static_cast<double>(there) * cost_of(point.entry));
    ++work.findings.all;
    work.findings.kept += there >= wanted_rounds(point, rounds) ? 1 : 0;
  }
  for (std::size_t round = 0; round < rounds; ++round) {
    bool timed = false;
    for (ChartPoint& point : points) {
      ChartTimes& times = point.times;
      if (times.frame_ms.size() > round) continue;
      if (times.frame_ms.size() < wanted_rounds(point, rounds)) {
        work.show(scene.scene.name + ": time of " + point.entry.method + ", round " +
                  std::to_string(round + 1) + " of " + std::to_string(rounds));
        const RunTime time = runner.run(point.entry);
        times.frame_ms.push_back(time.frame_ms);
        if (time.filter_ms) times.filter_ms.push_back(*time.filter_ms);
        timed = true;
      }
      work.left.done(cost_of(point.entry));
    }
    if (timed) save_times(points, key, file);
  }
}

ChartPanel measure_scene(Work& work, const std::string& name) {
  const ChartOptions& options = work.options;
  work.show(name + ": loading");
  const ChartScene scene = load_chart_scene(name, options, work.pool);
  const std::string key = truth_key(scene, scene_file_bytes(name, options.scene_path),
                                    options.truth_samples, work.pool);
  const std::filesystem::path folder = options.directory / "cache" / scene.scene.name;
  std::filesystem::create_directories(folder);
  const ChartTruth truth = truth_of(work, scene, key);

  ChartRunner runner{scene, work.pool};
  ChartPanel panel{.scene = scene.scene.name,
                   .title = scene.scene.title,
                   .truth_samples = options.truth_samples,
                   .noise_floor = truth.noise_floor,
                   .truth_picture = page_picture(truth.picture)};
  const std::string point_key = key + "; truth " + hash_text(hash_image(truth.picture)) +
                                "; pictures of " + std::to_string(kPagePicturePx);
  measure_errors(work, scene, truth, point_key, folder, runner, panel.points);
  measure_times(work, scene, folder, runner, panel.points);
  return panel;
}

}  // namespace

ChartFindings measure_chart(const ChartOptions& options, ThreadPool& pool) {
  const std::vector<ChartEntry> entries = wanted_entries(options);
  Work work{options, pool, entries, {}, {}, TimeLeft{all_units(options, entries)}};
  for (const std::string& name : options.scenes) {
    work.findings.panels.push_back(measure_scene(work, name));
  }
  return std::move(work.findings);
}

}  // namespace softfocus
