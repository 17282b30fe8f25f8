#include "tools/stress/answers.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "scenes/auto/auto_picture.h"
#include "scenes/draw/frame_parts.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/draw/velocity.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/lens_views/lens_view_method.h"
#include "tools/stress/relief_answers.h"

namespace softfocus {
namespace {

/// The truth's points of the lens follow all that a method can take, so that no method is right
/// by taking the same. Blocks of a power of two are even wherever they begin (lens_points.h).
constexpr int kFirstTruthView = 4096;
static_assert(kFirstTruthView > kSampleCounts.back());

/// Motion blurs take the picture after kBeforeMotionBlur.
constexpr std::array<std::string_view, 3> kMotionBlurs{"motion-blur-simple", "motion-blur-2012",
                                                       "motion-blur"};
constexpr std::string_view kBeforeMotionBlur = "disc-layers";

bool is_motion_blur(const std::string& method) {
  return std::find(kMotionBlurs.begin(), kMotionBlurs.end(), method) != kMotionBlurs.end();
}

struct ShadowAnswer {
  std::string_view method;
  ShadowKind kind;
  ShadowMapSettings map{};
  VolumeCount count = VolumeCount::z_fail;
};
constexpr std::array kShadowAnswers{
    ShadowAnswer{"projected", ShadowKind::projected},
    ShadowAnswer{"volumes", ShadowKind::volumes},
    ShadowAnswer{"volumes-z-pass", ShadowKind::volumes, {}, VolumeCount::z_pass},
    ShadowAnswer{"map", ShadowKind::map},
    ShadowAnswer{"map-kernel", ShadowKind::map, {.kernel = 3}},
    ShadowAnswer{"map-cascades", ShadowKind::map, {.cascades = 3}}};

const ShadowAnswer* find_shadow_answer(const std::string& method) {
  const auto* const found =
      std::find_if(kShadowAnswers.begin(), kShadowAnswers.end(),
                   [&](const ShadowAnswer& of) { return of.method == method; });
  return found == kShadowAnswers.end() ? nullptr : found;
}

Image shadowed(const ShadowAnswer& answer, const StressFrame& frame, ThreadPool& pool) {
  Scene scene = frame.scene->scene;
  set_shadows(scene, answer.kind);
  for (Light& light : scene.lights) light.map = answer.map;
  PreparedScene prepared = prepare_scene(scene, Profile{}, pool);
  prepared.shadows->volume_count = answer.count;
  Image picture = make_image(Format::rgba16f, frame.sharp.width, frame.sharp.height);
  draw_scene(prepared, frame.scene->camera, 0.0, picture, pool);
  return picture;
}

constexpr std::string_view kViewsMethod = "accumulation", kChoosingMethod = "auto";

LensViewInput views_input(const StressFrame& frame, int samples) {
  const StressScene& scene = *frame.scene;
  return {.scene = scene.scene,
          .camera = scene.camera,
          .frame = 0.0,
          .pinhole = frame.sharp,
          .focus_m = scene.focus_m,
          .aperture_radius_m = scene.aperture_m,
          .sampling = {.samples = samples, .shutter_frames = scene.shutter_frames},
          .profile = Profile{},
          .progress = {}};
}

Image filtered(const Method& method, const StressFrame& frame, float max_coc_px, ThreadPool& pool) {
  DofSettings settings = frame.settings;
  settings.max_coc_px = max_coc_px;
  if (!frame.scene) return apply(method, {frame.sharp, settings, Profile{}}, pool);
  return filtered_frame(method, frame.scene->scene, frame.scene->camera, 0.0, frame.sharp, settings,
                        Profile{}, pool);
}

/// auto's own choice, with no goal but its own.
Image chosen_picture(const StressFrame& frame, ThreadPool& pool) {
  const LensViewInput views = views_input(frame, 1);
  return auto_picture({.views = views,
                       .settings = frame.settings,
                       .goal = {},
                       .limits = {{}, triangle_count(frame.scene->scene)}},
                      pool)
      .picture;
}

/// Depth of field, then motion blur, as engines have it.
Image motion_blurred(const std::string& method, const StressFrame& frame, ThreadPool& pool) {
  ChosenEffect chosen{find_effect(method), {}};
  for (const Parameter& parameter : chosen.effect->parameters) {
    chosen.parameters.push_back(parameter.preset);
  }
  chosen.parameters[0] = frame.scene->shutter_frames;
  const Image picture =
      filtered(*find_method(kBeforeMotionBlur), frame, frame.settings.max_coc_px, pool);
  const Image velocity = velocity_for(chosen, frame.scene->scene, 0.0, picture, Profile{}, pool);
  return apply(*chosen.effect, {picture, chosen.parameters, Profile{}, velocity}, pool);
}

Image method_picture(const std::string& method, const StressFrame& frame, ThreadPool& pool) {
  if (method == kViewsMethod) return accumulation(views_input(frame, kStressSamples), pool).picture;
  if (method == kChoosingMethod) return chosen_picture(frame, pool);
  if (const LensViewMethod* of_scene = find_lens_view_method(method)) {
    return of_scene->render(views_input(frame, 1), pool).picture;
  }
  if (is_motion_blur(method)) return motion_blurred(method, frame, pool);
  if (is_relief_answer(method)) return relief_answer(method, frame, pool);
  if (const ShadowAnswer* answer = find_shadow_answer(method)) {
    return shadowed(*answer, frame, pool);
  }
  return filtered(*find_method(method), frame, frame.settings.max_coc_px, pool);
}

/// While the shutter is open a filter of depth of field has no part; the pinhole shows an instant.
bool can_answer(const std::string& method, const StressFrame& frame) {
  if (!frame.scene) return find_method(method) != nullptr;
  const bool is_shadow = find_shadow_answer(method) != nullptr;
  if (is_shadow || frame.scene->shadows) return is_shadow && frame.scene->shadows;
  const bool is_relief = is_relief_answer(method);
  if (is_relief || frame.scene->relief) return is_relief && frame.scene->relief.has_value();
  const bool is_open = frame.scene->shutter_frames > 0.0;
  if (is_motion_blur(method)) return is_open;
  return !is_open || method == kViewsMethod || method == "pinhole";
}

}  // namespace

std::vector<std::string> stress_methods() {
  std::vector<std::string> names;
  for (const Method& method : methods()) names.emplace_back(method.name);
  names.emplace_back(kViewsMethod);
  for (const LensViewMethod& method : lens_view_methods()) {
    if (!method.samples_lens) names.emplace_back(method.name);
  }
  names.emplace_back(kChoosingMethod);
  names.insert(names.end(), kMotionBlurs.begin(), kMotionBlurs.end());
  for (const ShadowAnswer& answer : kShadowAnswers) names.emplace_back(answer.method);
  for (std::string& name : relief_answers()) names.push_back(std::move(name));
  return names;
}

std::optional<std::vector<Image>> method_pictures(const std::string& method,
                                                  const StressTrial& trial, ThreadPool& pool) {
  std::vector<Image> pictures;
  for (const StressFrame& frame : trial.frames) {
    if (!can_answer(method, frame)) return std::nullopt;
    pictures.push_back(method_picture(method, frame, pool));
  }
  return pictures;
}

StressTruth make_stress_truth(const StressTrial& trial, int views, ThreadPool& pool) {
  StressTruth truth;
  for (const StressFrame& frame : trial.frames) {
    if (views == 0) {
      truth.pictures.push_back(frame.truth);
      continue;
    }
    assert(views % (2 * kSampleGroup) == 0);
    const LensViewInput input = views_input(frame, kFirstTruthView + views);
    AccumulationBuffer buffer = make_accumulation_buffer(input, pool);
    SampleSums sums = make_sample_sums(frame.sharp.width, frame.sharp.height);
    const auto add = [&](int begin, int end) {
      for (int i = begin; i < end; i += kLensViewGroup) {
        add_lens_views(buffer, input, kFirstTruthView + i,
                       kFirstTruthView + std::min(i + kLensViewGroup, end), sums, pool);
      }
    };
    const auto mean_of = [&](const SampleSums& of) {
      return mean_picture(of, frame.sharp, Profile{}, pool);
    };
    add(0, views / 2);
    const SampleSums first = sums;
    add(views / 2, views);
    truth.first_half.push_back(mean_of(first));
    truth.second_half.push_back(mean_of(later_samples(first, sums)));
    truth.pictures.push_back(mean_of(sums));
  }
  return truth;
}

}  // namespace softfocus
