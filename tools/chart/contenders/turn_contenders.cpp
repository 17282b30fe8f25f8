#include "tools/chart/contenders/turn_contenders.h"

#include <algorithm>
#include <cmath>

#include "dof/measure/regions.h"
#include "raster/images/texel.h"
#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "scenes/relief/warp/march_relief.h"
#include "scenes/surfaces/surface_stages.h"
#include "tools/cli/errors.h"
#include "tools/cli/timing.h"
#include "tools/relief/turn_frames.h"

namespace softfocus {
namespace {

constexpr int kQuickFrames = 48;  ///< of a turn
constexpr int kErrorRegions = 8;  ///< of the error, each way
/// By which reliefs that rays march through are renewed.
constexpr double kMarchedTolerance = 4.0;
constexpr int kBisections = 6;

struct TurnContender {
  std::string_view method;
  ChartTurn turn;
  std::string_view setting{};  ///< what its values are of
  std::vector<double> values{};
  std::vector<double> quick_values{};
};

ChartTurn by_impostor(Resampling resampling, int regions) {
  return {.by = TurnBy::impostor, .resampling = resampling, .regions = regions};
}

const std::vector<TurnContender>& turn_contenders() {
  // The four resamplings differ little from each other: the default gets all tolerances.
  static const std::vector<double> one{4.0}, tolerances{1.5, 2.5, 4.0, 8.0, 16.0};
  static const std::vector<TurnContender> all{
      {"impostor-two-pass", by_impostor(Resampling::two_pass, kErrorRegions), "tolerance", one,
       one},
      {"impostor-asymmetric", by_impostor(Resampling::asymmetric, kErrorRegions), "tolerance", one,
       one},
      {"impostor-compensated", by_impostor(Resampling::compensated, kErrorRegions), "tolerance",
       one, one},
      {"impostor-intertwined", by_impostor(Resampling::intertwined, kErrorRegions), "tolerance",
       tolerances, one},
      {"impostor-one-point",
       by_impostor(Resampling::intertwined, 1),
       "tolerance",
       {4.0, 8.0, 16.0},
       {8.0}},
      {"marched-slices", {.by = TurnBy::slices}, "slices", {16.0, 32.0, 64.0}, {32.0}},
      {"marched-bisection", {.by = TurnBy::bisection}, "slices", {16.0, 32.0, 64.0}, {32.0}},
      {"octahedral-flat", {.by = TurnBy::octahedral}, "views", {6.0, 12.0}, {6.0}},
      {"octahedral",
       {.by = TurnBy::octahedral, .parallax = 1},
       "views",
       {6.0, 8.0, 12.0, 16.0},
       {6.0}},
  };
  return all;
}

/// The camera of a turn: from the scene's side, the bounding sphere almost as high as the picture.
Camera camera_of_turn(const Scene& scene, const ReliefMaker& maker) {
  constexpr double kRoom = 1.05;
  Camera camera = scene.camera;
  const glm::dvec3 arm = camera.position - camera.target;
  const double tangent = exact_math::tan_degrees(0.5 * camera.fov_y_degrees);
  const double distance_m = kRoom * maker.radius_m * std::sqrt(1.0 + tangent * tangent) / tangent;
  camera.position_keys = camera.target_keys = {};
  camera.target = maker.middle;
  camera.position = maker.middle + normalize(arm) * distance_m;
  camera.near_m = 0.5 * (distance_m - maker.radius_m);
  camera.far_m = 10.0 * distance_m;
  camera.orbit_degrees_per_frame = 1.0;  // frames are degrees
  return camera;
}

double distance_of(const Camera& camera) {
  const glm::dvec3 arm = camera.position - camera.target;
  return std::sqrt(dot(arm, arm));
}

void copy_view(const Image& view, Image& sheet, int number) {
  const int left = number % kSheetViews * view.width, top = number / kSheetViews * view.height;
  for (int y = 0; y < view.height; ++y) {
    const auto texels = row<std::uint16_t>(view, y);
    std::copy(texels.begin(), texels.end(),
              row<std::uint16_t>(sheet, top + y).begin() + std::ptrdiff_t{4} * left);
  }
}

const Scene& with_triangles(const Scene& scene) {
  if (triangle_count(scene) == 0) {
    throw UsageError("--scenes '" + scene.name + "': has no triangles; impostors need some");
  }
  return scene;
}

int side_of_view(int side) {
  constexpr int kLeast = 16;
  if (side % kSheetViews != 0 || side < kSheetViews * kLeast) {
    throw UsageError("--size: a sheet of views has sides of 64 pixels or more, multiples of 4");
  }
  return side / kSheetViews;
}

ImpostorSettings impostor_settings(const ChartTurn& turn) {
  return {.warp = {.resampling = turn.resampling},
          .tolerance_texels = turn.tolerance_texels,
          .regions = turn.regions};
}

}  // namespace

std::vector<std::string> turn_methods() {
  std::vector<std::string> names{std::string{kPinhole}};
  for (const TurnContender& of : turn_contenders()) names.emplace_back(of.method);
  return names;
}

std::vector<ChartEntry> turn_entries(const std::string& method, int, bool quick) {
  const auto with_frames = [&](ChartTurn turn) {
    if (quick) turn.frames = kQuickFrames;
    return turn;
  };
  std::vector<ChartEntry> entries;
  for (const TurnContender& of : turn_contenders()) {
    if (of.method != method) continue;
    for (const double value : quick ? of.quick_values : of.values) {
      ChartTurn turn = with_frames(of.turn);
      if (of.setting == "views") {
        turn.views = static_cast<int>(value);
      } else if (of.setting == "slices") {
        turn.slices = static_cast<int>(value);
        turn.tolerance_texels = kMarchedTolerance;
        turn.regions = kErrorRegions;
      } else {
        turn.tolerance_texels = value;
      }
      entries.push_back(
          {.method = method, .turn = turn, .setting = {std::string{of.setting}, value}});
    }
  }
  if (entries.empty()) entries.push_back({.method = method, .turn = with_frames({})});
  return entries;
}

Image truth_of_turn(const ChartScene& chart, ThreadPool& pool) {
  TurnContenders contenders{chart, pool};
  const auto [width, height] = PictureSize{chart.pinhole.width, chart.pinhole.height};
  Image sheet = make_image(Format::rgba16f, width, height);
  contenders.run({.frames = kSheetViews * kSheetViews}, sheet);
  return sheet;
}

TurnContenders::TurnContenders(const ChartScene& chart, ThreadPool& pool)
    : chart_(chart),
      pool_(pool),
      width_(side_of_view(chart.pinhole.width)),
      height_(side_of_view(chart.pinhole.height)),
      maker_(prepare_relief(with_triangles(chart.scene), chart.frame, pool)),
      prepared_(prepare_scene(chart.scene, Profile{}, pool)),
      camera_(camera_of_turn(chart.scene, maker_)),
      distance_m_(distance_of(camera_)),
      blank_(make_image(Format::rgba16f, width_, height_)) {
  clear_image(blank_, turn_background(chart.scene, camera_), Profile{});
  shown_ = blank_;
  prepared_.depth = make_image(Format::r32f, width_, height_);
}

const OctahedralAtlas& TurnContenders::atlas_of(int views) {
  const auto found = atlases_.find(views);
  if (found != atlases_.end()) return found->second;
  // As sharp as a relief: a texel is a pixel, at the nearest point of the sphere.
  const double tangent = exact_math::tan_degrees(0.5 * camera_.fov_y_degrees);
  const double across =
      pixels_across(height_, 2.0 * maker_.radius_m, distance_m_ - maker_.radius_m, tangent);
  const int texels = std::clamp(static_cast<int>(std::ceil(across)) + 2, 4, kMostReliefSize);
  return atlases_
      .emplace(views,
               make_octahedral_atlas(
                   maker_, {.views = views, .texels = texels, .distance_m = distance_m_}, pool_))
      .first->second;
}

void TurnContenders::show_impostor(const ChartTurn& turn, const CameraMatrices& view) {
  const ImpostorStep step =
      update_impostor(impostor_, maker_, impostor_settings(turn), view, camera_.up, height_, pool_);
  draw_impostor(impostor_, view, shown_, pool_);
  renewals_ += step == ImpostorStep::renew ? 1 : 0;
  std::size_t bytes = impostor_.warped.colours.size() * (sizeof(std::uint32_t) + sizeof(float));
  if (impostor_.drawn) bytes += bytes_of(*impostor_.drawn);
  most_bytes_ = std::max(most_bytes_, bytes);
}

/// The impostor's rule of renewal, without a warp.
void TurnContenders::show_marched(const ChartTurn& turn, const CameraMatrices& view) {
  const ImpostorSettings settings = impostor_settings(turn);
  const double pixel_tangent = 2.0 / (std::fabs(view.eye_to_clip[1][1]) * height_);
  std::optional<DrawnRelief>& drawn = impostor_.drawn;
  if (!drawn || !can_serve(*drawn, settings, view.eye, pixel_tangent) ||
      impostor_error(*drawn, view.eye) > settings.tolerance_texels) {
    drawn.reset();
    ++renewals_;
    ReliefTexture texture =
        make_relief(maker_, {view.eye, camera_.up},
                    impostor_form(maker_, view, settings, camera_.up, height_), pool_);
    if (const std::optional<ReliefExtent> extent = relief_extent(texture)) {
      CriticalRegions critical = critical_regions(texture, *extent, turn.regions, turn.regions);
      drawn = DrawnRelief{std::move(texture), *extent, std::move(critical), view.eye};
    }
  }
  if (!drawn) return;
  most_bytes_ = std::max(most_bytes_, bytes_of(*drawn));
  march_relief(drawn->texture, march_mapping(drawn->texture, drawn->extent, view, width_, height_),
               {turn.slices, turn.by == TurnBy::bisection ? kBisections : 0}, shown_, pool_);
}

void TurnContenders::show(const ChartTurn& turn, const CameraMatrices& view) {
  if (turn.by == TurnBy::redraw) {
    RenderPass& pass = prepared_.pass;
    pass.targets.colour[0] = &shown_;
    pass.targets.depth = &prepared_.depth;
    record_scene(prepared_, view, chart_.frame, pass);
    pass.clear_colour = turn_background(chart_.scene, camera_);
    finish(pass, pool_);
    return;
  }
  clear_area(blank_, {0, 0, width_, height_}, shown_, pool_);
  if (turn.by == TurnBy::impostor) {
    show_impostor(turn, view);
  } else if (turn.by == TurnBy::octahedral) {
    draw_octahedral(atlas_of(turn.views), view, turn.parallax, shown_, pool_);
  } else {
    show_marched(turn, view);
  }
}

double TurnContenders::run(const ChartTurn& turn, Image& sheet) {
  impostor_ = {};
  renewals_ = 0;
  most_bytes_ = turn.by == TurnBy::octahedral ? bytes_of(atlas_of(turn.views)) : 0;
  const int every = turn.frames / (kSheetViews * kSheetViews);
  double sum_ms = 0.0;
  for (int i = 0; i < turn.frames; ++i) {
    const CameraMatrices view = camera_matrices(camera_, 360.0 * i / turn.frames, width_, height_);
    sum_ms += milliseconds_of([&] { show(turn, view); });
    if (i % every == 0) copy_view(shown_, sheet, i / every);
  }
  return sum_ms / turn.frames;
}

void TurnContenders::add_errors(const Image& truth, const Image& sheet, ChartErrors& errors) const {
  const std::uint16_t background = row<std::uint16_t>(blank_, 0)[3];
  errors.outline_px = outline_error(coverage_of(truth, background), coverage_of(sheet, background),
                                    truth.width, truth.height)
                          .mean_px;
  errors.renewals = renewals_;
  errors.megabytes = static_cast<double>(most_bytes_) / 1e6;
}

}  // namespace softfocus
