#include "tools/stress/relief_answers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/relief/impostors/impostor.h"
#include "scenes/relief/impostors/octahedral_atlas.h"
#include "scenes/relief/warp/march_relief.h"

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

}  // namespace

std::vector<std::string> relief_answers() {
  std::vector<std::string> names;
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

}  // namespace softfocus
