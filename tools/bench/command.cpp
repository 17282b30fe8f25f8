// softfocus bench: how long a frame takes here, and on a GL driver in turn.

#include <iostream>
#include <memory>

#include "scenes/draw/draw_scene.h"
#include "tools/bench/arithmetic.h"
#include "tools/bench/options.h"
#include "tools/bench/report.h"
#include "tools/bench/work.h"
#include "tools/cli/commands.h"
#include "tools/bench/repeated_on_gl.h"
#include "tools/bench/paired_runs.h"
#include "tools/cli/progress.h"

namespace softfocus {
namespace {

/// Our contender: the work, and what its stages leave.
struct OurFrame {
  const BenchWork& work;
  ThreadPool& pool;
  std::optional<PreparedScene> scene;  // as the driver has it: with its textures in place
  Image drawn;
  Image filtered;
};

void draw(OurFrame& frame) {
  const BenchWork& work = frame.work;
  if (!frame.scene) frame.scene = prepare_scene(*work.scene, work.profile, frame.pool);
  if (frame.drawn.bytes.empty()) {
    frame.drawn = make_image(Format::rgba16f, work.size.width, work.size.height);
  }
  draw_scene(*frame.scene, work.view, work.frame, frame.drawn, frame.pool);
}

void filter(OurFrame& frame) {
  const BenchWork& work = frame.work;
  const Image& scene = work.scene ? frame.drawn : work.picture;
  Image& filtered = frame.filtered;  // one memory for all frames
  if (filtered.bytes.empty()) filtered = make_image(scene.format, scene.width, scene.height);
  apply(*work.method, {scene, work.settings, work.profile}, filtered, frame.pool);
}

// The stages of one contender, by what it does to draw and to filter and how it ends:
// a frame is both without a pause between.
template <class Draw, class Filter, class Finish>
std::vector<TimedStage> stages_of(const BenchWork& work, Draw draws, Filter filters,
                                  Finish finishes) {
  const TimedStage dof{"dof", [=] { filters(), finishes(); }};
  if (!work.scene) return {dof};
  return {{"raster", [=] { draws(), finishes(); }}, dof, {"frame", [=] {
                                                            draws(), filters(), finishes();
                                                          }}};
}

void print(const BenchRecord& record) {
  std::cout << (record.options.json ? bench_json(record) : bench_text(record));
}

int bench(const BenchOptions& options) {
  Progress progress;
  const auto show_run = [&](int run) {
    progress.show("run " + std::to_string(run + 1) + " of " + std::to_string(options.runs));
  };
  progress.show("preparing");
  const BenchWork work = make_work(options);
  if (options.arithmetic != Arithmetic::floats) {
    ThreadPool pool{options.pool.threads, options.pool.isa};
    const BenchRecord record = bench_arithmetic(options, work, pool, show_run);
    progress.clear();
    print(record);
    return kDone;
  }

  std::unique_ptr<RepeatedOnGl> on_gl;
  std::vector<TimedStage> peers;
  if (options.versus != nullptr) {
    on_gl = std::make_unique<RepeatedOnGl>(*options.versus, work, options.pool.threads);
    peers = stages_of(
        work, [&] { on_gl->draw(); }, [&] { on_gl->filter(); }, [&] { on_gl->finish(); });
  }
  ThreadPool pool{options.pool.threads, options.pool.isa};
  OurFrame frame{work, pool, {}, {}, {}};
  const std::vector<TimedStage> ours = stages_of(
      work, [&] { draw(frame); }, [&] { filter(frame); }, [] {});

  progress.show("warming up");
  warm_up(ours);
  if (on_gl) warm_up(peers);
  std::optional<BenchPeer> peer;
  if (on_gl) {
    peer = {std::string{options.versus->name}, on_gl->renderer(),
            equal(on_gl->picture(), frame.filtered)};
  }
  const BenchRecord record{options, work, time_in_pairs(ours, peers, options.runs, show_run), peer};
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
