#include "tools/bench/effect_bench.h"

#include <algorithm>
#include <memory>
#include <optional>

#include "raster/effects/effect_settings.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/velocity.h"
#include "scenes/temporal/frame_history.h"
#include "tools/bench/repeated_on_gl.h"
#include "tools/bench/report.h"
#include "tools/bench/work.h"
#include "tools/cli/option_values.h"
#include "tools/cli/timing.h"
#include "tools/files/json.h"
#include "tools/options/effect_options.h"

namespace softfocus {
namespace {

/// A frame that is made from those before, again and again: what `bench --effect temporal-aa`
/// times.
struct RepeatedFrame {
  FrameEffect effect;
  FrameHistory history;  ///< up to the frame's passes, with what they read
  Image frames;          ///< that the passes write, R32F
  Image between;
};

/// The first frame of `reproject` by its default is drawn, and then every other: the eighth is not.
constexpr int kFramesBefore = 7;

/// Draws the history of the work's frame: the effect's `warm-up` frames before it, or 7 where that
/// is 0, with a step of 1; and one more if the frame would be drawn whole. Needs a scene.
RepeatedFrame make_repeated_frame(const ChosenEffect& chosen, const BenchWork& work,
                                  ThreadPool& pool) {
  const auto [width, height] = work.size;
  const int warm_up = warm_up_frames(chosen);
  int before = warm_up > 0 ? warm_up : kFramesBefore;
  RepeatedFrame made{.effect = frame_effect(chosen),
                     .history = {},
                     .frames = make_image(Format::r32f, width, height),
                     .between = make_image(Format::rgba16f, width, height)};
  if (is_drawn_whole(made.effect, {.count = before})) ++before;
  PreparedScene prepared = prepare_scene(*work.scene, work.profile, pool);
  for (int i = 0; i < before; ++i) {
    draw_next(prepared, made.effect, work.frame - before + i, width, height, made.history, pool);
  }
  draw_sources(prepared, made.effect, work.frame, width, height, made.history, pool);
  return made;
}

/// The passes alone; the history stays as it is.
void run(RepeatedFrame& frame, Image& picture, const Profile& profile, ThreadPool& pool) {
  make_frame(frame.effect, sources_of(frame.effect, frame.history),
             {picture, frame.frames, frame.between}, profile, pool);
}

Json spread_json(const Spread& spread) {
  return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}};
}

/// The name and the numbers that differ from the effect's own.
std::string short_text(const ChosenEffect& chosen) {
  std::string text{chosen.effect->name};
  bool first = true;
  for (std::size_t i = 0; i < chosen.parameters.size(); ++i) {
    const Parameter& parameter = chosen.effect->parameters[i];
    if (chosen.parameters[i] == parameter.preset) continue;
    text += (first ? ":" : ",") + std::string{parameter.name} + "=" +
            short_number(chosen.parameters[i]);
    first = false;
  }
  return text;
}

/// A driver's pictures have the bits of ours: of `frames` only if it has made it.
bool are_equal(const std::vector<Image>& theirs, const Image& picture, const Image& frames) {
  return equal(theirs[0], picture) && (theirs.size() == 1 || equal(theirs[1], frames));
}

}  // namespace

EffectBench bench_effects(const BenchOptions& options, const BenchWork& work, ThreadPool& pool,
                          const std::function<void(const std::string& what)>& on_run) {
  const auto [width, height] = work.size;
  const Image picture =
      work.scene ? draw_scene(*work.scene, work.view, work.frame, width, height, work.profile, pool)
                 : work.picture;
  Image result = make_image(Format::rgba16f, width, height);
  EffectBench bench;
  std::unique_ptr<EffectsRepeatedOnGl> on_gl;
  if (options.versus != nullptr) {
    on_gl = std::make_unique<EffectsRepeatedOnGl>(*options.versus, picture, options.pool.threads);
    bench.renderer = on_gl->renderer();
  }
  for (const ChosenEffect& chosen : options.effects) {
    EffectTimes times{.name = short_text(chosen)};
    on_run(times.name);
    Image velocity;
    std::optional<RepeatedFrame> frame;
    if (chosen.effect->filter == nullptr) {
      frame = make_repeated_frame(chosen, work, pool);
    } else if (chosen.effect->velocity != VelocityOf::nothing) {
      velocity = velocity_for(chosen, *work.scene, work.frame, picture, work.profile, pool);
    }
    const std::vector<TimedStage> ours{
        {"ours", [&] {
           if (frame) return run(*frame, result, work.profile, pool);
           apply_into(*chosen.effect, {picture, chosen.parameters, work.profile, velocity}, result,
                      pool);
         }}};
    std::vector<TimedStage> peers;
    warm_up(ours);
    if (on_gl) {
      if (frame) {
        on_gl->choose(frame->effect, sources_of(frame->effect, frame->history));
      } else {
        on_gl->choose(chosen, velocity.width > 0 ? &velocity : nullptr);
      }
      peers = {{"triangle", [&] { on_gl->run(false); }}, {"quad", [&] { on_gl->run(true); }}};
      warm_up(peers);
      const Image frames = frame ? frame->frames : Image{};
      times.equal = are_equal(on_gl->pictures(), result, frames);
      on_gl->run(false);
      times.equal = times.equal && are_equal(on_gl->pictures(), result, frames);
    }
    PairedSamples samples =
        time_in_pairs(ours, peers, options.runs, [&](int) { on_run(times.name); });
    times.ours_ms = std::move(samples.ours[0].ms);
    if (on_gl) {
      times.peers_ms = std::move(samples.peers[0].ms);
      times.quads_ms = std::move(samples.peers[1].ms);
    }
    bench.effects.push_back(std::move(times));
  }
  return bench;
}

std::string effect_bench_text(const BenchOptions& options, const BenchWork& work,
                              const EffectBench& bench) {
  std::string text = work.name + ", " + size_text(work.size) + ", effects on the sharp picture\n" +
                     run_text(options, work);
  const bool has_peer = !bench.renderer.empty();
  if (has_peer) text += "against " + bench.renderer + "\n";
  std::size_t widest = 8;
  for (const EffectTimes& times : bench.effects) widest = std::max(widest, times.name.size() + 2);
  constexpr std::size_t kTimes = 26, kRatio = 22;
  text += "\n" + padded("effect", widest);
  if (!has_peer) {
    text += "ms [min, max]\n";
    for (const EffectTimes& times : bench.effects) {
      text += padded(times.name, widest) + spread_text(spread_of(times.ours_ms), 2) + "\n";
    }
    return text;
  }
  const std::string driver{options.versus->name};
  text += padded("ours, ms [min, max]", kTimes) + padded(driver + ", ms [min, max]", kTimes) +
          padded(driver + " / ours", kRatio) + padded("quad / triangle", kRatio) + "bits\n";
  for (const EffectTimes& times : bench.effects) {
    text += padded(times.name, widest) + padded(spread_text(spread_of(times.ours_ms), 2), kTimes) +
            padded(spread_text(spread_of(times.peers_ms), 2), kTimes) +
            padded(spread_text(spread_of(pair_ratios(times.ours_ms, times.peers_ms)), 1), kRatio) +
            padded(spread_text(spread_of(pair_ratios(times.peers_ms, times.quads_ms)), 2), kRatio) +
            (times.equal ? "equal" : "differ") + "\n";
  }
  return text;
}

std::string effect_bench_json(const BenchOptions& options, const BenchWork& work,
                              const EffectBench& bench) {
  Json json = run_json(options, work);
  json["effects"] = Json::array();
  if (!bench.renderer.empty()) {
    json["peer"] = {{"driver", options.versus->name}, {"renderer", bench.renderer}};
  }
  for (const EffectTimes& times : bench.effects) {
    Json effect{{"effect", times.name},
                {"ms", spread_json(spread_of(times.ours_ms))},
                {"peer_ms", nullptr},
                {"ratio", nullptr},
                {"quad_over_triangle", nullptr},
                {"equal", nullptr}};
    if (!times.peers_ms.empty()) {
      effect["peer_ms"] = spread_json(spread_of(times.peers_ms));
      effect["ratio"] = spread_json(spread_of(pair_ratios(times.ours_ms, times.peers_ms)));
      effect["quad_over_triangle"] =
          spread_json(spread_of(pair_ratios(times.peers_ms, times.quads_ms)));
      effect["equal"] = times.equal;
    }
    json["effects"].push_back(effect);
  }
  return json_text(json, 2) + "\n";
}

}  // namespace softfocus
