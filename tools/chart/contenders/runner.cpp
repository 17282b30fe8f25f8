#include "tools/chart/contenders/runner.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "dof/halve.h"
#include "raster/numbers/profile.h"
#include "scenes/draw/velocity.h"
#include "scenes/temporal/frame_history.h"

namespace softfocus {
namespace {

using Clock = std::chrono::steady_clock;

double ms_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double, std::milli>(end - start).count();
}

}  // namespace

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
  if (entry.of_scene != nullptr) return draw_otherwise(*entry.of_scene);
  if (is_of_effects(entry)) return draw_with_effects(entry);
  if (entry.shadows) return draw_with_shadows(entry);
  if (entry.turn) return {turn_contenders().run(*entry.turn, result_), std::nullopt};
  if (entry.method == kOfFilteredViews) return filter_views(entry.samples);
  if (entry.drawn_views > 0) return warp_views(entry.samples, entry.drawn_views);
  return entry.filter != nullptr ? filter(entry) : accumulate(entry.samples);
}

RunTime ChartRunner::run_warm(const ChartEntry& entry) {
  // A turn is long: its own first frames warm it up.
  if (!entry.turn) warm_up(entry);
  return run(entry);
}

FrameMemory& ChartRunner::memory_for(const std::string& profile) {
  FrameMemory& memory = memories_[profile];
  if (!memory.prepared) {
    memory.prepared = prepare_scene(scene_.scene, *find_profile(profile), pool_);
  }
  return memory;
}

Shot ChartRunner::shot_by(const MethodChoice& method, const Profile& profile) const {
  Shot shot{.scene = &scene_.scene,
            .frame = scene_.frame,
            .width = scene_.pinhole.width,
            .height = scene_.pinhole.height,
            .method = method,
            .blends = false,
            .sampling = views_.sampling,
            .profile = profile};
  if (method.filter == nullptr) shot.layers = 0;
  return shot;
}

/// Draws the shot and makes its picture, as `render` has it.
RunTime ChartRunner::run_shot(const Shot& shot, float max_coc_px, FrameMemory& memory) {
  const Clock::time_point start = Clock::now();
  draw_shot(shot, memory, frame_, pool_);
  const Clock::time_point drawn = Clock::now();
  make_result(shot, max_coc_px, memory);
  const Clock::time_point end = Clock::now();
  return {ms_between(start, end), ms_between(drawn, end)};
}

void ChartRunner::make_result(const Shot& shot, float max_coc_px, FrameMemory& memory) {
  memory.picture = std::move(result_);
  const UsedLens lens{.lens = scene_.lens,
                      .aperture_radius_m = scene_.aperture_m,
                      .settings = {.coc = scene_.coc, .max_coc_px = max_coc_px}};
  Frame made = make_picture(shot, frame_, lens, memory, pool_);
  result_ = std::move(made.picture);
  if (made.chosen) chosen_ = setting_text(made.chosen->choice);
}

// A lens's table is made once, as it would be for many frames.
const FixedTable& ChartRunner::table_for(float max_coc_px) {
  const auto found = tables_.find(max_coc_px);
  if (found != tables_.end()) return found->second;
  const fixed::Lens lens = fixed_lens({.coc = scene_.coc, .max_coc_px = max_coc_px});
  return tables_.emplace(max_coc_px, fixed_table(half_table(lens))).first->second;
}

RunTime ChartRunner::filter(const ChartEntry& entry) {
  FrameMemory& memory = memory_for(entry.profile);
  Shot shot = shot_by({.filter = entry.filter}, *find_profile(entry.profile));
  const float max_coc_px = entry.max_coc_px.value_or(DofSettings{}.max_coc_px);
  if (entry.arithmetic != Arithmetic::fixed_8) return run_shot(shot, max_coc_px, memory);
  shot.layers = 0;
  const Clock::time_point start = Clock::now();
  draw_shot(shot, memory, frame_, pool_);
  const Clock::time_point drawn = Clock::now();
  two_pass_bytes(frame_.parts.opaque, table_for(max_coc_px), result_, pool_);
  const Clock::time_point end = Clock::now();
  return {ms_between(start, end), ms_between(drawn, end)};
}

/// Its picture: a scene's velocity is over the shutter of the chart.
Image ChartRunner::with_effect(ChosenEffect chosen, const Image& before) {
  Image velocity;
  if (chosen.effect->velocity != VelocityOf::nothing) {
    chosen.parameters[0] = views_.sampling.shutter_frames;
    velocity = velocity_for(chosen, scene_.scene, scene_.frame, before, Profile{}, pool_);
  }
  return apply(*chosen.effect, {before, chosen.parameters, Profile{}, velocity}, pool_);
}

/// The last of so many frames of the moment: what came before is no part of its time.
RunTime ChartRunner::draw_after_frames(const ChosenEffect& chosen, int frames) {
  PreparedScene& prepared = *memory_for("ieee").prepared;
  const FrameEffect effect = frame_effect(chosen);
  FrameHistory history;
  const auto draw = [&] {
    draw_next(prepared, effect, scene_.frame, drawn_.width, drawn_.height, history, pool_);
  };
  for (int i = 1; i < frames; ++i) draw();
  const Clock::time_point start = Clock::now();
  draw();
  const Clock::time_point end = Clock::now();
  result_ = std::move(history.picture);
  return {ms_between(start, end), std::nullopt};
}

RunTime ChartRunner::draw_with_effects(const ChartEntry& entry) {
  if (!entry.effects.empty() && entry.effects.front().effect->filter == nullptr) {
    return draw_after_frames(entry.effects.front(), static_cast<int>(entry.setting.value));
  }
  if (entry.multisample > 1) {
    const Clock::time_point start = Clock::now();
    draw_parts(*memory_for("ieee").prepared, scene_.view, scene_.frame, drawn_.width, drawn_.height,
               1, smooth_, pool_, {}, entry.multisample);
    const Clock::time_point drawn = Clock::now();
    with_dof_input(smooth_, {}, Profile{}, {}, {}, [&](const DofInput& input) {
      result_ = apply(*find_method(kPinhole), input, pool_);
    });
    return {ms_between(start, Clock::now()), ms_between(drawn, Clock::now())};
  }
  const bool is_large = entry.supersample > 1;
  if (is_large && !prepared_large_) {
    prepared_large_ = prepare_scene(scene_.scene, Profile{}, pool_);
    large_ = make_image(Format::rgba16f, entry.supersample * drawn_.width,
                        entry.supersample * drawn_.height);
  }
  PreparedScene& prepared = is_large ? *prepared_large_ : *memory_for("ieee").prepared;
  const Clock::time_point start = Clock::now();
  draw_scene(prepared, scene_.view, scene_.frame, is_large ? large_ : drawn_, pool_);
  const Clock::time_point drawn = Clock::now();
  if (is_large) result_ = halve(large_, Profile{}, pool_);
  for (const ChosenEffect& chosen : entry.effects) {
    const Image& before = &chosen == &entry.effects.front() && !is_large ? drawn_ : result_;
    result_ = with_effect(chosen, before);
  }
  const Clock::time_point end = Clock::now();
  return {ms_between(start, end), ms_between(drawn, end)};
}

ShadowContenders& ChartRunner::shadow_contenders() {
  if (!shadows_) shadows_.emplace(scene_, pool_);
  return *shadows_;
}

RunTime ChartRunner::draw_with_shadows(const ChartEntry& entry) {
  ShadowContenders& contenders = shadow_contenders();
  contenders.prepare(entry);
  const Clock::time_point start = Clock::now();
  contenders.draw(result_);
  return {ms_between(start, Clock::now()), std::nullopt};
}

TurnContenders& ChartRunner::turn_contenders() {
  if (!turns_) turns_.emplace(scene_, pool_);
  return *turns_;
}

void ChartRunner::add_turn_errors(const Image& truth, ChartErrors& errors) {
  if (turns_) turns_->add_errors(truth, result_, errors);
}

double ChartRunner::wrong_pixels(const ChartEntry& entry) {
  if (scene_.subject->ranked[0].value != kShadowErrors[0].value) return kNotTimed;
  return static_cast<double>(entry.shadows ? shadow_contenders().wrong_pixels()
                                           : shadow_contenders().wrong_without_shadows());
}

// The memory is made once, as it would be for many frames.
AccumulationBuffer& ChartRunner::buffer() {
  if (!buffer_) {
    buffer_ = make_accumulation_buffer(views_, pool_);
    if (sums_.totals.empty()) sums_ = make_sample_sums(drawn_.width, drawn_.height);
  }
  return *buffer_;
}

void ChartRunner::add_views(int first, int last) {
  AccumulationBuffer& views = buffer();
  if (first == 0) clear_sums(sums_);
  add_lens_views(views, views_, first, last, sums_, pool_);
}

// As accumulation() has them.
void ChartRunner::place_views_of(int samples) {
  Sampling sampling = views_.sampling;
  sampling.samples = samples;
  place_views(buffer(), sampling);
}

void ChartRunner::add_all_views(int samples) {
  place_views_of(samples);
  for (int first = 0; first < samples; first += kLensViewGroup) {
    add_views(first, std::min(first + kLensViewGroup, samples));
  }
  store_mean(sums_, scene_.pinhole, views_.profile, result_, pool_);
}

RunTime ChartRunner::accumulate(int samples) {
  const Clock::time_point start = Clock::now();
  add_all_views(samples);
  return {ms_between(start, Clock::now()), std::nullopt};
}

RunTime ChartRunner::filter_views(int samples) {
  if (!filtered_) filtered_ = make_filtered_views_buffer(views_, pool_);
  if (sums_.totals.empty()) sums_ = make_sample_sums(drawn_.width, drawn_.height);
  const Clock::time_point start = Clock::now();
  clear_sums(sums_);
  set_views(*filtered_, views_, samples);
  add_filtered_views(*filtered_, views_, sums_, pool_);
  store_mean(sums_, scene_.pinhole, views_.profile, result_, pool_);
  return {ms_between(start, Clock::now()), std::nullopt};
}

RunTime ChartRunner::warp_views(int samples, int drawn_views) {
  LensViewInput views = views_;
  views.sampling.samples = samples;
  views.sampling.drawn_views = drawn_views;
  if (!warped_) warped_ = make_warped_views_buffer(views, pool_);
  const Clock::time_point start = Clock::now();
  result_ = warped_accumulation(*warped_, views, pool_).picture;
  return {ms_between(start, Clock::now()), std::nullopt};
}

// The sharp picture tells such a method what is seen, so its drawing counts.
RunTime ChartRunner::draw_otherwise(const LensViewMethod& method) {
  return run_shot(shot_by({.of_scene = &method}, Profile{}), 0.0f, memory_for("ieee"));
}

// As `render` has it: a doubtful choice is checked, which takes its time.
RunTime ChartRunner::choose(double max_error) {
  FrameMemory& memory = memory_for("ieee");
  memory.is_last = true;
  Shot shot = shot_by({}, Profile{});
  shot.goal = {max_error};
  const RunTime time = run_shot(shot, DofSettings{}.max_coc_px, memory);
  memories_.erase("ieee");  // its scene was moved from, perhaps
  return time;
}

// An accumulation's first group of pictures is enough.
void ChartRunner::warm_up(const ChartEntry& entry) {
  int samples = entry.samples;
  if (entry.max_error) {
    FrameMemory& memory = memory_for("ieee");
    Shot shot = shot_by({}, Profile{});
    draw_shot(shot, memory, frame_, pool_);
    const AutoMethod choice = auto_method(scene_traits(frame_.parts.opaque, scene_.coc, pool_),
                                          {*entry.max_error}, {{}, triangle_count(scene_.scene)});
    samples = choice.samples;
    if (samples == 0) {
      shot.method = find_method_choice(choice.method);
      make_result(shot, choice.radius_px, memory);
    }
  } else if (entry.filter != nullptr) {
    filter(entry);
  } else if (entry.of_scene != nullptr) {
    draw_otherwise(*entry.of_scene);
  } else if (is_of_pinhole(entry)) {
    run(entry);
  } else if (entry.method == kOfFilteredViews) {
    filter_views(std::min(samples, kFilteredViews));
    return;
  } else if (entry.drawn_views > 0) {
    warp_views(kSampleGroup, entry.drawn_views);
    return;
  }
  if (samples == 0) return;
  place_views_of(samples);
  add_views(0, std::min(samples, kLensViewGroup));
}

}  // namespace softfocus
