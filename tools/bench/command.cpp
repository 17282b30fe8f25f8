// softfocus bench: how long a frame takes here, and on a GL driver in turn.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>

#include "dof/fixed_pictures/arithmetic.h"
#include "dof/fixed_pictures/fixed_two_pass.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/frame/frame.h"
#include "tools/bench/effect_bench.h"
#include "tools/bench/options.h"
#include "tools/bench/paired_runs.h"
#include "tools/bench/repeated_on_gl.h"
#include "tools/bench/report.h"
#include "tools/bench/work.h"
#include "tools/cli/commands.h"
#include "tools/cli/platform.h"
#include "tools/cli/progress.h"
#include "tools/cli/timing.h"

namespace softfocus {
namespace {

/// Our contender: the work, and what its stages leave for the next frame: memory, and what a driver
/// has in place as well (decoded textures).
struct OurFrame {
  const BenchWork& work;
  ThreadPool& pool;
  bool one_picture =
      false;  ///< a filter gets no transparent layers: beside a driver, which has none
  FrameMemory memory{};
  DrawnFrame drawn{};
  Frame filtered{};
  Image copy{};  ///< of a pass's picture, if copies are timed
};

Shot shot_of(const OurFrame& frame) {
  const BenchWork& work = frame.work;
  Shot shot{.scene = &*work.scene,
            .frame = work.frame,
            .width = work.size.width,
            .height = work.size.height,
            .samples = work.samples,
            .method = work.method,
            .blends = false,
            .lens = ShotLens{.lens = {.focus_m = work.focus_m}},
            .sampling = work.sampling,
            .goal = work.goal,
            .verify = work.verify,
            .most_coc_px = work.largest_radius_px,
            .profile = work.profile};
  if (work.method.filter == nullptr || frame.one_picture) shot.layers = 0;
  return shot;
}

/// Draws the scene, with the objects' numbers if the method reads them; needs one.
void draw(OurFrame& frame) { draw_shot(shot_of(frame), frame.memory, frame.drawn, frame.pool); }

/// Gives depth of field to what was drawn, or to the work's picture. Auto looks at the picture and
/// chooses each time.
void filter(OurFrame& frame) {
  const BenchWork& work = frame.work;
  Image& picture = frame.filtered.picture;  // one memory for all frames
  if (!work.scene) {
    if (picture.bytes.empty())
      picture = make_image(work.picture.format, work.size.width, work.size.height);
    apply(*work.method.filter, {work.picture, work.settings, work.profile}, picture, frame.pool);
    return;
  }
  frame.memory.picture = std::move(picture);
  const UsedLens lens{.lens = {.focus_m = work.focus_m},
                      .aperture_radius_m = work.aperture_radius_m,
                      .settings = work.settings};
  frame.filtered = make_picture(shot_of(frame), frame.drawn, lens, frame.memory, frame.pool);
}

/// Copies a picture of the frame's size, as a program without frame-buffer objects does after each
/// pass. Our filter keeps what is between its passes in the caches, so it is one of the same size
/// that is copied.
void copy(OurFrame& frame, const Image& picture) {
  if (frame.copy.bytes.empty()) {
    frame.copy = make_image(picture.format, picture.width, picture.height);
  }
  constexpr int kRows = 16;
  frame.pool.for_each((picture.height + kRows - 1) / kRows, [&](int band) {
    for (int y = band * kRows; y < std::min((band + 1) * kRows, picture.height); ++y) {
      const auto from = row<std::uint16_t>(picture, y);
      std::copy(from.begin(), from.end(), row<std::uint16_t>(frame.copy, y).begin());
    }
  });
}

// The stages of one contender, by what it does to draw and to filter and how it ends:
// a frame is both without a pause between. `filters_copies` filters with a copy of each picture.
template <class Draw, class Filter, class FilterCopies, class Finish>
std::vector<TimedStage> stages_of(const BenchWork& work, Draw draws, Filter filters,
                                  FilterCopies filters_copies, Finish finishes) {
  const TimedStage dof{"dof", [=] { filters(), finishes(); }};
  if (!work.scene) return {dof};
  std::vector<TimedStage> stages{{"raster", [=] { draws(), finishes(); }},
                                 dof,
                                 {"frame", [=] { draws(), filters(), finishes(); }}};
  if (work.copies) stages.push_back({"copied", [=] { draws(), filters_copies(), finishes(); }});
  return stages;
}

// The driver's: drawing, then the filter and the frame of each of its shader's forms.
std::vector<TimedStage> stages_of(const BenchWork& work, RepeatedOnGl& on_gl) {
  const std::size_t forms = on_gl.forms().size();
  const auto finish = [&] { on_gl.finish(); };
  const auto draws = [&] { on_gl.draw(); };
  if (forms == 0) {
    return stages_of(
        work, draws, [] {}, [] {}, finish);
  }
  std::vector<TimedStage> stages;
  for (std::size_t form = 0; form < forms; ++form) {
    std::vector<TimedStage> of_form = stages_of(
        work, draws, [&on_gl, form] { on_gl.filter(form); },
        [&on_gl, form] { on_gl.copy_and_filter(form); }, finish);
    if (form > 0 && work.scene) of_form.erase(of_form.begin());  // drawn already
    stages.insert(stages.end(), of_form.begin(), of_form.end());
  }
  return stages;
}

// Keeps the driver's faster form; records both.
void keep_faster_form(BenchRecord& record, const std::vector<std::string>& forms) {
  if (forms.empty()) return;
  std::vector<StageSamples>& all = record.samples.peers;
  const std::size_t first = record.work.scene ? 1 : 0;  // after drawing
  const std::size_t stages = (all.size() - first) / forms.size();
  std::size_t fastest = 0;
  for (std::size_t form = 0; form < forms.size(); ++form) {
    const double median_ms = spread_of(all[first + form * stages].ms).median;
    record.peer->shaders.push_back({forms[form], median_ms});
    if (median_ms < record.peer->shaders[fastest].filter_ms) fastest = form;
  }
  record.peer->shader = forms[fastest];
  const auto at = [&](std::size_t stage) {
    return all.begin() + static_cast<std::ptrdiff_t>(stage);
  };
  std::vector<StageSamples> kept{at(0), at(first)};
  const std::size_t begin = first + fastest * stages;
  kept.insert(kept.end(), at(begin), at(begin + stages));
  all = std::move(kept);
}

bool same_pictures(const RepeatedOnGl& on_gl, const Image& ours) {
  const std::size_t forms = std::max<std::size_t>(on_gl.forms().size(), 1);
  for (std::size_t form = 0; form < forms; ++form) {
    if (!equal(on_gl.picture(form), ours)) return false;
  }
  return true;
}

// Why a driver's picture has other bits than ours, and what shows more.
std::string why_different(const Driver& driver, const BenchWork& work) {
  const std::string name{driver.name}, profile{driver.profile};
  if (profile.empty()) {
    return "the profile of " + name + " is not known; softfocus probe --driver " + name +
           " finds it";
  }
  if (work.profile != find_profile(profile)) {
    return name + " rounds as profile " + profile + ", not as " + work.profile_name +
           "; --profile " + profile + " gives its bits";
  }
  return profile + " should give its bits; softfocus crosscheck --driver " + name +
         " shows what differs";
}

void print(const BenchRecord& record) {
  std::cout << (record.options.json ? bench_json(record) : bench_text(record));
}

/// Times the filter in another arithmetic in turn with the one in floats: `dof` alone. Tables, and
/// for `fixed-8` the picture in bytes, are made beforehand.
BenchRecord bench_arithmetic(const BenchOptions& options, const BenchWork& work, ThreadPool& pool,
                             const std::function<void(int run)>& on_run) {
  const auto [width, height] = work.size;
  const Image picture =
      work.scene ? draw_scene(*work.scene, work.view, work.frame, width, height, work.profile, pool)
                 : work.picture;
  const bool bytes = options.arithmetic == Arithmetic::fixed_8;
  const BytePicture byte_form = bytes ? byte_picture(picture, pool) : BytePicture{};
  const FixedTable table = fixed_table(half_table(fixed_lens(work.settings)));
  Image ours = make_image(bytes ? Format::rgba8 : Format::rgba16f, width, height);
  Image theirs = make_image(Format::rgba16f, width, height);

  const std::vector<TimedStage> fixed{{"dof", [&] {
                                         if (bytes) {
                                           fixed_two_pass(byte_form.colours, byte_form.depths,
                                                          table, ours, pool);
                                         } else {
                                           fixed_two_pass(picture, table, ours, pool);
                                         }
                                       }}};
  const std::vector<TimedStage> floats{
      {"dof", [&] {
         apply(*work.method.filter, {picture, work.settings, work.profile}, theirs, pool);
       }}};
  warm_up(fixed);
  warm_up(floats);
  return {options, work, time_in_pairs(fixed, floats, options.runs, on_run),
          BenchPeer{"float", "the same filter in binary32", !bytes && equal(ours, theirs)}};
}

/// The whole command that makes the frame, from a process's start to a PNG. Nothing of methods that
/// are no filter, or where the program cannot run itself.
std::optional<StageSamples> time_command(const BenchOptions& options,
                                         const std::function<void(int run)>& on_run) {
  const auto program = own_program();
  std::error_code failed;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(failed);
  if (options.scene.empty() || options.method.filter == nullptr || !program ||
      program->stem() != "softfocus" || failed) {
    return std::nullopt;
  }
  const std::filesystem::path file =
      folder / ("softfocus-bench-" + std::to_string(process_number()) + ".png");
  std::vector<std::string> words{"render",    options.scene,
                                 "-o",        file.string(),
                                 "--size",    size_text(options.size),
                                 "--method",  std::string{options.method.name()},
                                 "--frame",   short_number(options.frame),
                                 "--profile", options.profile_name,
                                 "--threads", std::to_string(options.pool.threads),
                                 "--isa",     std::string{isa_name(options.pool.isa)}};
  words.insert(words.end(), {"--multisample", std::to_string(options.samples)});
  if (options.max_coc_px) {
    words.insert(words.end(), {"--max-coc", short_number(*options.max_coc_px)});
  }
  for (const LensNumber& number : kLensNumbers) {
    if (const auto value = options.lens.given[number.place]) {
      words.insert(words.end(), {"--" + std::string{number.parameter.name}, short_number(*value)});
    }
  }
  if (options.lens.coc_scale) {
    words.insert(words.end(), {"--coc-scale", short_number(*options.lens.coc_scale)});
  }
  for (const auto& directory : options.scene_path) {
    words.insert(words.end(), {"--scene-path", directory.string()});
  }
  StageSamples samples{"command", {}};
  bool is_well = true;
  for (int run = -1; run < options.runs && is_well; ++run) {  // one without a clock
    if (run >= 0) on_run(run);
    const auto start = std::chrono::steady_clock::now();
    is_well = run_quietly(*program, words) == 0;
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
    if (run >= 0) samples.ms.push_back(ms.count());
  }
  std::filesystem::remove(file, failed);
  return is_well ? std::optional{std::move(samples)} : std::nullopt;
}

/// Each frame of --frames, from its matrices to its picture.
std::vector<double> time_frames(const BenchOptions& options, BenchWork& work, OurFrame& frame,
                                Progress& progress) {
  std::vector<double> frames_ms;
  if (!options.frames) return frames_ms;
  for (const FrameNumber number : frames_of(*options.frames)) {
    progress.show("frame " + std::to_string(number));
    frames_ms.push_back(milliseconds_of([&] {
      set_frame(work, options, static_cast<double>(number));
      draw(frame);
      filter(frame);
    }));
  }
  set_frame(work, options, options.frame);  // what is reported
  return frames_ms;
}

int bench(const BenchOptions& options) {
  Progress progress{options.quiet};
  const auto show_run = [&](int run) {
    progress.show("run " + std::to_string(run + 1) + " of " + std::to_string(options.runs));
  };
  progress.show("preparing");
  BenchWork work = make_work(options);
  if (!options.effects.empty()) {
    ThreadPool pool{options.pool.threads, options.pool.isa};
    const EffectBench timed =
        bench_effects(options, work, pool, [&](const std::string& what) { progress.show(what); });
    progress.clear();
    std::cout << (options.json ? effect_bench_json(options, work, timed)
                               : effect_bench_text(options, work, timed));
    return kDone;
  }
  if (options.arithmetic != Arithmetic::floats) {
    ThreadPool pool{options.pool.threads, options.pool.isa};
    const BenchRecord record = bench_arithmetic(options, work, pool, show_run);
    progress.clear();
    print(record);
    return kDone;
  }

  std::unique_ptr<RepeatedOnGl> on_gl;
  if (options.versus != nullptr) {
    on_gl = std::make_unique<RepeatedOnGl>(*options.versus, work, options.pool.threads);
  }
  const std::vector<TimedStage> peers = on_gl ? stages_of(work, *on_gl) : std::vector<TimedStage>{};
  ThreadPool pool{options.pool.threads, options.pool.isa};
  OurFrame frame{work, pool, on_gl != nullptr};
  const std::vector<TimedStage> ours = stages_of(
      work, [&] { draw(frame); }, [&] { filter(frame); },
      [&] {
        copy(frame, frame.drawn.parts.opaque), filter(frame), copy(frame, frame.filtered.picture);
      },
      [] {});

  progress.show("warming up");
  warm_up(ours);
  if (on_gl) warm_up(peers);
  std::optional<BenchPeer> peer;
  if (on_gl) {
    peer = {std::string{options.versus->name}, on_gl->renderer(),
            same_pictures(*on_gl, frame.filtered.picture)};
    if (!peer->equal) peer->difference = why_different(*options.versus, work);
  }
  BenchRecord record{options, work, time_in_pairs(ours, peers, options.runs, show_run),
                     peer,    {},   frame.filtered.sampled ? frame.filtered.sampled->samples : 0};
  if (frame.filtered.chosen) record.choice = frame.filtered.chosen->choice;
  if (on_gl) {
    keep_faster_form(record, on_gl->forms());
  } else if (auto command = time_command(options, show_run)) {
    record.samples.ours.push_back(std::move(*command));
  }
  record.frames_ms = time_frames(options, work, frame, progress);
  progress.clear();
  print(record);
  return kDone;
}

}  // namespace

Command add_bench_command(CLI::App& program) {
  CLI::App* parser = add_command(
      program, "bench", "Time the drawing and the filter, alone or in turn with a GL driver");
  const auto options = std::make_shared<BenchOptions>();
  add_bench_options(*parser, *options);
  return {parser, [parser, options] {
            complete(*options, *parser);
            return bench(*options);
          }};
}

}  // namespace softfocus
