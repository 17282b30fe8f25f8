// softfocus chart: speed against accuracy of every method on every scene. What it measures is kept
// in DIR/cache as it goes:
//
//   cache/SCENE.truth.npy, .json      the ground truth, and its noise
//   cache/SCENE/ENTRY.json            errors of a contender; its pictures, if the page shows them
//   cache/SCENE/truth.picture.json    the truth for the page
//   cache/SCENE/times.json            the times of all, written after each round

#include <algorithm>
#include <iostream>
#include <memory>
#include <vector>

#include "tools/chart/contenders/runner.h"
#include "tools/chart/measure.h"
#include "tools/chart/options.h"
#include "tools/chart/point.h"
#include "tools/chart/record.h"
#include "tools/chart/report/page.h"
#include "tools/chart/report/summary.h"
#include "tools/chart/scene.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/files/whole_file.h"
#include "tools/golden/hashes.h"
#include "tools/report/laboratory.h"
#include "tools/report/report.h"

namespace softfocus {
namespace {

/// Slower contenders are timed less often.
constexpr double kLongMs = 1000.0;
constexpr std::size_t kRoundsOfLong = 3;

/// Guesses of how long work takes, in drawings of a pinhole's picture. They count until the first
/// of its kind is done.
constexpr double kLoadGuess = 20.0, kFilterGuess = 6.0, kAutoGuess = 60.0, kSceneGuess = 60.0,
                 kMeasureGuess = 200.0, kPicturesGuess = 80.0;

double run_guess(const ChartEntry& entry) {
  if (entry.max_error) return kAutoGuess;
  if (entry.of_scene != nullptr) return kSceneGuess;
  if (is_of_pinhole(entry)) return kFilterGuess;
  return entry.filter != nullptr ? kFilterGuess : static_cast<double>(entry.samples);
}

/// A point's name in its record.
constexpr const char* kPoint = "point";
constexpr const char *kLoad = "load", *kTruth = "truth", *kMeasure = "measure",
                     *kPictures = "pictures";
std::string run_kind(const ChartEntry& entry) { return "run " + entry_id(entry); }
std::string time_kind(const ChartEntry& entry) { return "time " + entry_id(entry); }

/// Passed along with the work on all scenes.
struct Work {
  const ChartOptions& options;
  ThreadPool& pool;
  std::vector<ChartEntry> entries;
  std::uint64_t measures;  ///< measures_hash()
  std::vector<ChartPanel> panels{};
  Laboratory lab{options.quiet, options.again};

  std::filesystem::path folder_of(const std::string& scene) const {
    return options.directory / "cache" / name_for_files(scene);
  }
  KeptResults record_of(const ChartPanel& panel, const ChartEntry& entry) const {
    return {folder_of(panel.scene) / (entry_id(entry) + ".json"), panel.key};
  }
};

std::vector<ChartEntry> wanted_entries(const ChartOptions& options) {
  std::vector<ChartEntry> entries;
  for (const std::string& method : options.methods) {
    for (ChartEntry& entry : options.subject->entries(method, options.size.height, options.quick)) {
      entries.push_back(std::move(entry));
    }
  }
  return entries;
}

void plan(Work& work) {
  const ChartOptions& options = work.options;
  const auto scenes = static_cast<double>(options.scenes.size());
  work.lab.left.plan(kLoad, scenes, kLoadGuess);
  work.lab.left.plan(kTruth, scenes * options.truth_samples, 1.0);
  for (const ChartEntry& entry : work.entries) {
    work.lab.left.plan(run_kind(entry), scenes, run_guess(entry));
    work.lab.left.plan(kMeasure, scenes, kMeasureGuess);
    work.lab.left.plan(time_kind(entry), scenes * options.rounds, 2.0 * run_guess(entry));
  }
  const std::size_t pictures =
      expected_pictures(options.scenes.size(), work.entries.size(), options.methods.size());
  work.lab.left.plan(kPictures, static_cast<double>(pictures), kPicturesGuess);
}

struct FoundTruth {
  ChartTruth truth;
  bool kept;  ///< by an earlier run
};

/// Nothing is loaded if `anew`.
FoundTruth truth_of(Work& work, const ChartScene& scene, const std::string& key, bool anew) {
  const int samples = work.options.truth_samples;
  const std::string name = name_for_files(scene.scene.name);
  const std::filesystem::path file = work.options.directory / "cache" / (name + ".truth");
  if (!anew) {
    if (auto kept = load_truth(key, file)) return {std::move(*kept), true};
  }
  int before = 0;
  work.lab.left.start();
  ChartTruth truth = make_truth(
      scene, samples,
      [&](int done) {
        work.lab.left.done(kTruth, done - before);
        before = done;
        work.lab.show(scene.scene.name + ": ground truth, " + std::to_string(done) + " of " +
                      std::to_string(samples) + " samples");
      },
      work.pool);
  save_truth(truth, key, file);
  return {std::move(truth), false};
}

/// If no circle is larger than the smallest radius, all radii give one picture.
const ChartPoint* same_picture(const ChartPoint& point, const std::vector<ChartPoint>& before) {
  // A light may be too weak for a pixel to show whether its shadow is right.
  // And two turns of one picture may differ in renewals and memory.
  if (point.entry.shadows || point.entry.turn) return nullptr;
  const auto same = std::find_if(before.begin(), before.end(), [&](const ChartPoint& other) {
    return other.picture_hash == point.picture_hash;
  });
  return same == before.end() ? nullptr : &*same;
}

LabContender contender(Work& work, const ChartScene& scene, const ChartTruth& truth,
                       ChartRunner& runner, ChartPoint& point,
                       const std::vector<ChartPoint>& before) {
  const ChartEntry& entry = point.entry;
  return {.name = kPoint,
          .stage = scene.scene.name + ": error of " + entry.method + ", " + settings_text(entry),
          .kind = run_kind(entry),
          .run =
              [&] {
                runner.run(entry);
                if (entry.max_error) point.entry.chosen = runner.chosen();
                point.picture_hash = hash_image(runner.result());
                return std::optional{hash_text(point.picture_hash)};
              },
          .measures =
              [&](const std::string&) {
                const ChartPoint* const same = same_picture(point, before);
                const auto errors = [&, same] {
                  if (same != nullptr) return errors_json(same->errors);
                  ChartErrors found =
                      measure_picture(runner.result(), truth.picture, scene.labels, work.pool);
                  found.wrong_pixels = runner.wrong_pixels(entry);
                  runner.add_turn_errors(truth.picture, found);
                  return errors_json(found);
                };
                if (same != nullptr) work.lab.left.drop(kMeasure, 1);
                return std::vector<LabMeasure>{
                    {.name = "errors",
                     .make = errors,
                     .take = [&](const Json& json) { point.errors = errors_of(json); },
                     .kind = kMeasure,
                     .units = same != nullptr ? 0.0 : 1.0}};
              }};
}

/// Draws each contender's picture once, and measures those that are not kept.
void measure_errors(Work& work, const ChartScene& scene, const ChartTruth& truth,
                    ChartRunner& runner, ChartPanel& panel) {
  for (const ChartEntry& entry : work.entries) {
    if (!can_run(scene, entry)) {
      work.lab.left.drop(run_kind(entry), 1);
      work.lab.left.drop(kMeasure, 1);
      work.lab.left.drop(time_kind(entry), work.options.rounds);
      continue;
    }
    ChartPoint point{.entry = entry};
    KeptResults record = work.record_of(panel, entry);
    work.lab.run(record, contender(work, scene, truth, runner, point, panel.points));
    record.save();
    panel.points.push_back(std::move(point));
  }
}

std::size_t wanted_rounds(const ChartPoint& point, std::size_t rounds) {
  const auto& ms = point.times.frame_ms;
  const bool takes_long = !ms.empty() && *std::min_element(ms.begin(), ms.end()) > kLongMs;
  return takes_long ? std::min(rounds, kRoundsOfLong) : rounds;
}

/// Takes out the rounds that are not to be run.
void drop_rounds(Work& work, const ChartPoint& point, std::size_t count) {
  work.lab.left.drop(time_kind(point.entry), static_cast<double>(count));
}

/// Round by round over all contenders, so that what disturbs the machine disturbs all.
void measure_times(Work& work, const std::string& scene, ChartRunner& runner,
                   std::vector<ChartPoint>& points) {
  const auto rounds = static_cast<std::size_t>(work.options.rounds);
  if (rounds == 0) return;
  const std::string key = machine_key(work.options.pool);
  const std::filesystem::path file = work.folder_of(scene) / "times.json";
  if (!work.options.again) load_times(points, key, file);
  for (const ChartPoint& point : points) {
    const std::size_t there = std::min(point.times.frame_ms.size(), rounds);
    const std::size_t wanted = wanted_rounds(point, rounds);
    drop_rounds(work, point, rounds - (wanted - std::min(there, wanted)));
    ++work.lab.all;
    work.lab.kept += there >= wanted ? 1 : 0;
  }
  for (std::size_t round = 0; round < rounds; ++round) {
    bool timed = false;
    for (ChartPoint& point : points) {
      ChartTimes& times = point.times;
      const std::size_t wanted = wanted_rounds(point, rounds);
      if (times.frame_ms.size() > round || times.frame_ms.size() >= wanted) continue;
      work.lab.show(scene + ": time of " + point.entry.method + ", round " +
                    std::to_string(round + 1) + " of " + std::to_string(wanted));
      work.lab.left.start();
      const RunTime time = runner.run_warm(point.entry);
      work.lab.left.done(time_kind(point.entry), 1);
      times.frame_ms.push_back(time.frame_ms);
      if (time.filter_ms) times.filter_ms.push_back(*time.filter_ms);
      if (times.frame_ms.size() == 1) {
        drop_rounds(work, point, wanted - wanted_rounds(point, rounds));
      }
      timed = true;
    }
    if (timed) save_times(points, key, file);
  }
}

std::string key_of(Work& work, const ChartScene& scene, const std::string& given_name) {
  return truth_key(scene, scene_file_bytes(given_name, work.options.scene_path),
                   work.options.truth_samples, work.measures, work.pool);
}

ChartPanel measure_scene(Work& work, const std::string& given_name) {
  const ChartOptions& options = work.options;
  work.lab.show(given_name + ": loading");
  work.lab.left.start();
  const ChartScene scene = load_chart_scene(given_name, options, work.pool);
  const std::string& name = scene.scene.name;
  const std::string key = key_of(work, scene, given_name);
  make_directory(work.folder_of(name));
  work.lab.left.done(kLoad, 1);
  ++work.lab.all;
  const auto [truth, kept] = truth_of(work, scene, key, options.again);
  if (kept) {
    ++work.lab.kept;
    work.lab.left.drop(kTruth, options.truth_samples);
  }

  ChartRunner runner{scene, work.pool};
  ChartPanel panel{.scene = name,
                   .title = scene.scene.title,
                   .truth_samples = options.truth_samples,
                   .noise_floor = truth.noise_floor,
                   .given_name = given_name,
                   .key = point_key(key, truth.picture),
                   .ranked = options.subject->ranked};
  measure_errors(work, scene, truth, runner, panel);
  measure_times(work, name, runner, panel.points);
  settle_points(panel);
  return panel;
}

/// Loads the scene again if pictures are not kept.
void add_pictures(Work& work, ChartPanel& panel, const std::vector<ChartPoint*>& wanted) {
  struct Drawn {
    ChartScene scene;
    ChartTruth truth;
    ChartRunner runner;
    Drawn(ChartScene of, ChartTruth right, ThreadPool& pool)
        : scene(std::move(of)), truth(std::move(right)), runner(scene, pool) {}
  };
  std::unique_ptr<Drawn> drawn;
  const auto draw = [&]() -> Drawn& {
    if (drawn != nullptr) return *drawn;
    ChartScene scene = load_chart_scene(panel.given_name, work.options, work.pool);
    ChartTruth truth = truth_of(work, scene, key_of(work, scene, panel.given_name), false).truth;
    work.lab.left.start();
    drawn = std::make_unique<Drawn>(std::move(scene), std::move(truth), work.pool);
    return *drawn;
  };
  KeptResults of_truth{work.folder_of(panel.scene) / "truth.picture.json", panel.key};
  work.lab.settle(of_truth, "truth", "",
                  {.name = "picture",
                   .make = [&] { return page_picture(draw().truth.picture); },
                   .take = [&](const Json& json) { panel.truth_picture = json.text(); },
                   .is_result = false});
  of_truth.save();
  for (ChartPoint* point : wanted) {
    const auto pictures = [&] {
      work.lab.show(panel.scene + ": pictures of " + point->entry.method);
      draw().runner.run(point->entry);
      add_point_pictures(*point, drawn->runner.result(), drawn->truth.picture, work.pool);
      return pictures_json(*point);
    };
    KeptResults record = work.record_of(panel, point->entry);
    work.lab.settle(record, kPoint, hash_text(point->picture_hash),
                    {.name = "pictures",
                     .make = pictures,
                     .take = [&](const Json& json) { take_pictures(json, *point); },
                     .is_result = false,
                     .kind = kPictures});
    record.save();
  }
}

void add_all_pictures(Work& work) {
  std::vector<ChartPanel>& panels = work.panels;
  const std::vector<PicturedPoint> chosen = pictured_points(panels);
  work.lab.left.drop(kPictures, work.lab.left.units_left(kPictures));
  work.lab.left.plan(kPictures, static_cast<double>(chosen.size()), kPicturesGuess);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    std::vector<ChartPoint*> wanted;
    for (const PicturedPoint& of : chosen) {
      if (of.panel == i) wanted.push_back(&panels[i].points[of.point]);
    }
    if (!wanted.empty()) add_pictures(work, panels[i], wanted);
  }
}

/// Settled panels with pictures. Measures what is not kept already, with a line on the terminal
/// that says how long it takes. Needs the directory, with "cache" in it.
std::vector<ChartPanel> measure_chart(const ChartOptions& options, ThreadPool& pool) {
  Work work{options, pool, wanted_entries(options), measures_hash(pool)};
  plan(work);
  for (const std::string& name : options.scenes) {
    work.panels.push_back(measure_scene(work, name));
  }
  add_all_pictures(work);
  work.lab.print_kept("results");
  return std::move(work.panels);
}

void write_list(const Json& list, const std::string& name, const ChartOptions& options) {
  write_text(options.directory / (name + ".csv"), csv_of(list));
  write_json(options.directory / (name + ".json"), list);
}

/// The command with what was settled, but for what is usual.
std::string command_of(const ChartOptions& options) {
  std::vector<std::string> words{"softfocus", "chart",
                                 "--of",      std::string{options.subject->name},
                                 "--scenes",  joined_names(options.scenes),
                                 "--size",    size_text(options.size),
                                 "--rounds",  std::to_string(options.rounds),
                                 "--frame",   short_number(options.frame)};
  if (options.methods != options.subject->methods()) {
    words.insert(words.end(), {"--methods", joined_names(options.methods)});
  }
  if (options.subject->truth_of == nullptr) {
    words.insert(words.end(), {"--samples", std::to_string(options.truth_samples)});
  }
  if (options.quick) words.emplace_back("--quick");
  return command_text(words);
}

void write_chart(const std::vector<ChartPanel>& panels, const ChartOptions& options) {
  const std::vector<BestForBudget> best = best_for_budgets(panels);
  const std::vector<SummaryRow> summary = summary_of(panels);
  write_list(chart_json(panels), "chart", options);
  write_list(best_json(best), "best", options);
  write_list(summary_json(summary), "summary", options);
  write_text(options.directory / "index.html",
             report_page(chart_report({.subject = *options.subject,
                                       .panels = panels,
                                       .best = best,
                                       .summary = summary,
                                       .size = size_text(options.size),
                                       .command = command_of(options),
                                       .machine = machine_key(options.pool)})));
}

void print_fronts(const std::vector<ChartPanel>& panels) {
  for (const ChartPanel& panel : panels) {
    const RankedError& error = panel.ranked[0];
    std::cout << panel.scene << ": ";
    if (panel.noise_floor.flip > 0.0) {
      std::cout << "noise of the truth, FLIP " << short_number(panel.noise_floor.flip) << "; ";
    }
    std::cout << "best for their time:\n";
    std::vector<const ChartPoint*> front;
    for (const ChartPoint& point : panel.points) {
      if (point.on_front) front.push_back(&point);
    }
    std::sort(front.begin(), front.end(),
              [](const ChartPoint* a, const ChartPoint* b) { return a->median_ms < b->median_ms; });
    for (const ChartPoint* point : front) {
      std::cout << "  " << short_number(point->median_ms) << " ms, " << error.title << ' '
                << short_number(point->errors.*error.value) << ": " << point->entry.method << ' '
                << settings_text(point->entry) << '\n';
    }
  }
}

/// Each method at its best setting.
void print_summary(const std::vector<ChartPanel>& panels) {
  std::cout << panels.front().ranked[0].title << " over " << panels.size()
            << " scenes, at the best setting of each: median, 90 %"
            << ", worst\n";
  for (const SummaryRow& row : summary_of(panels)) {
    if (row.settings != kBestSetting && !row.settings.empty()) continue;
    const OverScenes& error = row.errors[0];
    std::cout << "  " << short_number(error.median) << ", " << short_number(error.p90) << ", "
              << short_number(error.worst) << ": " << row.method << '\n';
  }
}

/// All that a chart writes but its cache.
std::vector<std::filesystem::path> output_files(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files{directory / "index.html"};
  for (const char* name : {"chart", "best", "summary"}) {
    for (const char* ending : {".csv", ".json"}) {
      files.push_back(directory / (std::string{name} + ending));
    }
  }
  return files;
}

int chart(const ChartOptions& options) {
  const std::vector<std::filesystem::path> outputs = output_files(options.directory);
  const std::vector<ReadFile> inputs = check_scenes(options);
  for (const auto& file : outputs) check_not_read("-o", file, inputs);
  prepare_results(options.directory, outputs);
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const std::vector<ChartPanel> panels = measure_chart(options, pool);
  write_chart(panels, options);
  if (options.rounds > 0 && panels.size() <= kMostPanels) print_fronts(panels);
  if (panels.size() > 1) print_summary(panels);
  std::cout << "written to " << (options.directory / "index.html").string() << '\n';
  return kDone;
}

}  // namespace

Command add_chart_command(CLI::App& program) {
  CLI::App* parser =
      add_command(program, "chart", "Measure speed against accuracy of all methods, and draw it");
  const auto options = std::make_shared<ChartOptions>();
  add_chart_options(*parser, *options);
  return {parser, [options] {
            complete(*options);
            return chart(*options);
          }};
}

}  // namespace softfocus
