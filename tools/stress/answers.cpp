#include "tools/stress/answers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/frame/frame.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/relief/impostors/impostor.h"
#include "scenes/relief/impostors/octahedral_atlas.h"
#include "scenes/relief/warp/march_relief.h"
#include "tools/report/laboratory.h"
#include "tools/stress/cases/stress_case.h"

namespace softfocus {
namespace {

constexpr std::string_view kRenewed = "impostor";

struct WarpAnswer {
  std::string_view method;
  Resampling resampling;
};
constexpr std::array kWarpAnswers{WarpAnswer{"relief-two-pass", Resampling::two_pass},
                                  WarpAnswer{"relief-asymmetric", Resampling::asymmetric},
                                  WarpAnswer{"relief-compensated", Resampling::compensated},
                                  WarpAnswer{"relief-intertwined", Resampling::intertwined}};

struct MarchAnswer {
  std::string_view method;
  MarchSettings march;
};
constexpr std::array kMarchAnswers{MarchAnswer{"relief-slices", {64, 0}},
                                   MarchAnswer{"relief-bisection", {32, 6}}};

struct AtlasAnswer {
  std::string_view method;
  int views, parallax;
};
constexpr std::array kAtlasAnswers{AtlasAnswer{"octahedral-flat", 6, 0},
                                   AtlasAnswer{"octahedral", 6, 1},
                                   AtlasAnswer{"octahedral-12", 12, 1}};

template <class Answers>
const auto* find_answer(const Answers& answers, const std::string& method) {
  const auto* const found = std::find_if(answers.begin(), answers.end(),
                                         [&](const auto& of) { return of.method == method; });
  return found == answers.end() ? nullptr : found;
}

/// By 8 x 8 regions and a tolerance of 4 texels.
ImpostorSettings renewed_settings() { return {.warp = {}, .tolerance_texels = 4.0, .regions = 8}; }

/// An eye of the case, and what is seen from it.
CameraMatrices seen_from(const StressFrame& frame, glm::dvec3 eye) {
  Camera camera = frame.scene->scene.camera;
  camera.position = eye;
  return camera_matrices(camera, 0.0, frame.sharp.width, frame.sharp.height);
}

/// A texel is a pixel, as for an impostor, but no relief is more than twice as large as the
/// picture: from within an object there is no end.
ReliefForm form_of(const StressFrame& frame, const ReliefMaker& maker,
                   const CameraMatrices& drawn_from) {
  ReliefForm form =
      impostor_form(maker, drawn_from, {}, frame.scene->scene.camera.up, frame.sharp.height);
  form.width = std::min(form.width, 2 * frame.sharp.width);
  form.height = std::min(form.height, 2 * frame.sharp.height);
  return form;
}

void show_octahedral(const AtlasAnswer& answer, const StressFrame& frame, ReliefMaker& maker,
                     Image& picture, ThreadPool& pool) {
  const glm::dvec3 arm = frame.scene->camera.eye - maker.middle;
  const double half_view = 1.0 / std::fabs(frame.scene->camera.eye_to_clip[1][1]);
  const double distance = std::sqrt(dot(arm, arm));
  const double across =
      pixels_across(frame.sharp.height, 2.0 * maker.radius_m, distance, half_view);
  const int texels = std::clamp(static_cast<int>(std::ceil(std::fmin(across, kMostReliefSize))), 4,
                                2 * frame.sharp.height);
  const OctahedralAtlas atlas = make_octahedral_atlas(
      maker, {.views = answer.views, .texels = texels, .distance_m = distance}, pool);
  draw_octahedral(atlas, frame.scene->camera, answer.parallax, picture, pool);
}

/// One relief warped or marched, the impostor that may renew it, and octahedral atlases.
std::vector<std::string> relief_answers() {
  std::vector<std::string> names;
  names.reserve(kWarpAnswers.size() + kMarchAnswers.size() + 8);
  for (const WarpAnswer& of : kWarpAnswers) names.emplace_back(of.method);
  for (const MarchAnswer& of : kMarchAnswers) names.emplace_back(of.method);
  names.emplace_back(kRenewed);
  for (const AtlasAnswer& of : kAtlasAnswers) names.emplace_back(of.method);
  return names;
}

bool is_relief_answer(const std::string& method) {
  const std::vector<std::string> names = relief_answers();
  return std::find(names.begin(), names.end(), method) != names.end();
}

/// The frame's scene has a relief.
Image relief_answer(const std::string& method, const StressFrame& frame, ThreadPool& pool) {
  const StressScene& of = *frame.scene;
  Image picture = make_image(Format::rgba16f, frame.sharp.width, frame.sharp.height);
  clear_image(picture, clear_colour(of.scene), Profile{});
  Scene drawn = of.scene;
  drawn.lights = of.relief->drawn_lights;
  ReliefMaker maker = prepare_relief(drawn, 0.0, pool);
  if (const AtlasAnswer* atlas = find_answer(kAtlasAnswers, method)) {
    show_octahedral(*atlas, frame, maker, picture, pool);
    return picture;
  }
  const CameraMatrices before = seen_from(frame, of.relief->drawn_from);
  const glm::dvec3 up = of.scene.camera.up;
  if (method == kRenewed) {
    Impostor impostor;
    update_impostor(impostor, maker, renewed_settings(), before, up, picture.height, pool);
    update_impostor(impostor, maker, renewed_settings(), of.camera, up, picture.height, pool);
    draw_impostor(impostor, of.camera, picture, pool);
    return picture;
  }
  const ReliefTexture relief =
      make_relief(maker, {before.eye, up}, form_of(frame, maker, before), pool);
  const std::optional<ReliefExtent> extent = relief_extent(relief);
  if (!extent) return picture;
  if (const MarchAnswer* march = find_answer(kMarchAnswers, method)) {
    march_relief(relief, march_mapping(relief, *extent, of.camera, picture.width, picture.height),
                 march->march, picture, pool);
    return picture;
  }
  const std::optional<PlaneRectangle> place = warped_extent(relief, *extent, of.camera.eye);
  if (!place) return picture;
  WarpedRelief warped;
  warp_relief(relief, *extent, of.camera.eye, *place,
              {.resampling = find_answer(kWarpAnswers, method)->resampling}, warped, pool);
  map_relief(warped, plane_mapping(relief, of.camera, *place, picture.width, picture.height),
             picture, pool);
  return picture;
}

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
  made.drawn.parts.edges = frame.edges;
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
  if (!frame.scene) return find_method_choice(method).filter != nullptr;
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
    const StressShot made = shot_of(frame, kViewsMethod, kFirstTruthView + views);
    HalvedViews found = halved_views(lens_views_of(made.shot, made.drawn, made.lens),
                                     kFirstTruthView, views, {}, pool);
    truth.first_half.push_back(std::move(found.first_half));
    truth.second_half.push_back(std::move(found.second_half));
    truth.pictures.push_back(std::move(found.all));
  }
  return truth;
}

}  // namespace softfocus
