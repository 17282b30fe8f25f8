#include "tools/stress/answers.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "scenes/draw/shadowed_layers.h"
#include "scenes/frame/frame.h"
#include "scenes/lens_views/accumulation.h"
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

constexpr std::string_view kViewsMethod = "accumulation";

/// A trial's frame on its way to the frame maker: its sharp picture is drawn, its lens is known.
struct StressShot {
  Shot shot;
  DrawnFrame drawn;
  UsedLens lens;
};

StressShot shot_of(const StressFrame& frame, std::string_view method, int samples) {
  StressShot made{.shot = {.width = frame.sharp.width,
                           .height = frame.sharp.height,
                           .method = find_method_choice(method),
                           .sampling = {.samples = samples}},
                  .drawn = {},
                  .lens = {.settings = frame.settings}};
  made.drawn.parts.opaque = frame.sharp;
  if (!frame.scene) return made;
  const StressScene& scene = *frame.scene;
  made.shot.scene = &scene.scene;
  made.shot.sampling.shutter_frames = scene.shutter_frames;
  made.drawn.view = scene.camera;
  made.lens.lens.focus_m = scene.focus_m;
  made.lens.aperture_radius_m = scene.aperture_m;
  return made;
}

Image picture_of(const StressShot& made, ThreadPool& pool) {
  FrameMemory memory{.is_last = true};
  Frame frame = make_picture(made.shot, made.drawn, made.lens, memory, pool);
  finish_picture(made.shot, frame, pool);
  return std::move(frame.picture);
}

/// Depth of field, then motion blur, as engines have it.
Image motion_blurred(const std::string& method, const StressFrame& frame, ThreadPool& pool) {
  ChosenEffect chosen{find_effect(method), {}};
  for (const Parameter& parameter : chosen.effect->parameters) {
    chosen.parameters.push_back(parameter.preset);
  }
  chosen.parameters[0] = frame.scene->shutter_frames;
  StressShot made = shot_of(frame, kBeforeMotionBlur, 1);
  made.shot.effects = {chosen};
  return picture_of(made, pool);
}

Image method_picture(const std::string& method, const StressFrame& frame, ThreadPool& pool) {
  if (is_motion_blur(method)) return motion_blurred(method, frame, pool);
  if (is_relief_answer(method)) return relief_answer(method, frame, pool);
  if (const ShadowAnswer* answer = find_shadow_answer(method)) {
    return shadowed(*answer, frame, pool);
  }
  return picture_of(shot_of(frame, method, method == kViewsMethod ? kStressSamples : 1), pool);
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
  names.emplace_back(kAutoMethod);
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
    const StressShot made = shot_of(frame, kViewsMethod, kFirstTruthView + views);
    const LensViewInput input = lens_views_of(made.shot, made.drawn, made.lens);
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
