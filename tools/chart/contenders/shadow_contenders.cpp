#include "tools/chart/contenders/shadow_contenders.h"

#include <numeric>

#include "scenes/draw/shadowed_layers.h"
#include "scenes/shadows/maps/map_errors.h"
#include "tools/cli/errors.h"

namespace softfocus {
namespace {

struct ShadowContender {
  std::string_view method;
  ChartShadows shadows;
  std::vector<int> sizes{};  ///< of maps
  std::vector<int> quick_sizes{};
};

const std::vector<ShadowContender>& shadow_contenders() {
  static const std::vector<ShadowContender> all{
      {.method = "by-rays", .shadows = {.by_rays = true}},
      {.method = "projected", .shadows = {}},
      {.method = "projected-kept", .shadows = {.kept = true}},
      {.method = "volumes", .shadows = {.kind = ShadowKind::volumes}},
      {.method = "volumes-z-pass",
       .shadows = {.kind = ShadowKind::volumes, .count = VolumeCount::z_pass}},
      {.method = "volumes-kept", .shadows = {.kind = ShadowKind::volumes, .kept = true}},
      {.method = "map",
       .shadows = {.kind = ShadowKind::map},
       .sizes = {256, 512, 1024, 2048, 4096},
       .quick_sizes = {256, 1024}},
      {.method = "map-kernel",
       .shadows = {.kind = ShadowKind::map, .map = {.kernel = 3}},
       .sizes = {512, 1024, 2048, 4096},
       .quick_sizes = {256, 1024}},
      {.method = "map-cascades",
       .shadows = {.kind = ShadowKind::map, .map = {.cascades = 3}},
       .sizes = {512, 1024, 2048, 4096},
       .quick_sizes = {256, 1024}},
      {.method = "map-kept",
       .shadows = {.kind = ShadowKind::map, .map = {.fits_camera = false}, .kept = true},
       .sizes = {1024, 2048, 4096},
       .quick_sizes = {1024}},
  };
  return all;
}

void give_shadows(const ChartShadows& shadows, Scene& scene) {
  set_shadows(scene, shadows.kind);
  for (Light& light : scene.lights) light.map = shadows.map;
}

}  // namespace

std::vector<std::string> shadow_methods() {
  std::vector<std::string> names{std::string{kPinhole}};
  for (const ShadowContender& of : shadow_contenders()) names.emplace_back(of.method);
  return names;
}

std::vector<ChartEntry> shadow_entries(const std::string& method, int, bool quick) {
  for (const ShadowContender& of : shadow_contenders()) {
    if (of.method != method) continue;
    if (of.sizes.empty()) return {{.method = method, .shadows = of.shadows}};
    std::vector<ChartEntry> entries;
    for (const int size : quick ? of.quick_sizes : of.sizes) {
      entries.push_back({.method = method,
                         .shadows = of.shadows,
                         .setting = {"size", static_cast<double>(size)}});
      entries.back().shadows->map.size = size;
    }
    return entries;
  }
  return {{.method = method, .filter = find_method(method)}};
}

Image truth_of_shadows(const ChartScene& chart, ThreadPool& pool) {
  ShadowContenders contenders{chart, pool};
  contenders.prepare({.method = "by-rays", .shadows = ChartShadows{.by_rays = true}});
  Image picture = make_image(Format::rgba16f, chart.pinhole.width, chart.pinhole.height);
  contenders.draw(picture);
  return picture;
}

ShadowContenders::ShadowContenders(const ChartScene& chart, ThreadPool& pool)
    : chart_(chart),
      pool_(pool),
      scene_(chart.scene),
      view_{multiply(chart.view.eye_to_clip, chart.view.world_to_eye), chart.pinhole.width,
            chart.pinhole.height, Profile{}} {
  const std::size_t lights = scene_.lights.size();
  if (lights == 0 || lights > kMostShadowLights) {
    throw UsageError("--scenes '" + scene_.name + "': has " + std::to_string(lights) +
                     " lights; for shadows 1 to " + std::to_string(kMostShadowLights) +
                     " would do");
  }
}

void ShadowContenders::prepare(const ChartEntry& entry) {
  const ChartShadows& shadows = *entry.shadows;
  keeps_ = shadows.kept;
  if (prepared_ && prepared_id_ == entry_id(entry)) return;
  prepared_.reset();
  give_shadows(shadows, scene_);
  prepared_ = prepare_scene(scene_, Profile{}, pool_);
  prepared_->shadows->volume_count = shadows.count;
  prepared_->shadows->by_rays = shadows.by_rays;
  prepared_id_ = entry_id(entry);
}

void ShadowContenders::draw(Image& picture) {
  forget(*prepared_->shadows, !keeps_);
  draw_scene(*prepared_, chart_.view, chart_.frame, picture, pool_);
}

const std::vector<ShadowContenders::LightTruth>& ShadowContenders::truths() {
  if (!truths_.empty()) return truths_;
  facets_ = scene_facets(chart_.scene, chart_.frame);
  seen_ = prepared_->shadows->seen[0];
  lights_.reserve(scene_.lights.size());
  for (const Light& light : scene_.lights) {
    lights_.push_back(shadow_light(light));
    ShadowTruth truth{facets_, lights_.back(), view_, chart_.view.eye, true};
    std::vector<std::uint8_t> is_dark = dark_pixels(truth, seen_, view_.width, view_.height, pool_);
    truths_.push_back({std::move(truth), std::move(is_dark)});
  }
  return truths_;
}

std::size_t ShadowContenders::wrong_bits(std::size_t light) const {
  const LightTruth& of = truths_[light];
  const std::vector<std::uint8_t>& mask = prepared_->shadows->masks[0];
  std::vector<std::size_t> of_rows(static_cast<std::size_t>(view_.height));
  pool_.for_each(view_.height, [&](int y) {
    std::vector<std::uint32_t> memory;
    for (int x = 0; x < view_.width; ++x) {
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width) +
          static_cast<std::size_t>(x);
      if (!shows_facet(seen_[pixel]) || (mask[pixel] >> light & 1) == of.is_dark[pixel]) continue;
      const glm::dvec2 centre{x + 0.5, y + 0.5};
      if (!of.truth.is_near_edge(seen_[pixel], centre, memory)) {
        ++of_rows[static_cast<std::size_t>(y)];
      }
    }
  });
  return std::accumulate(of_rows.begin(), of_rows.end(), std::size_t{0});
}

std::size_t ShadowContenders::wrong_pixels() {
  const std::vector<LightTruth>& all = truths();
  const SceneShadows& shadows = *prepared_->shadows;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool has_shares = !shadows.shares.empty() && !shadows.shares[0][i].empty();
    wrong += has_shares ? map_errors(facets_, shadows.maps[i], all[i].truth, all[i].is_dark, seen_,
                                     shadows.masks[0], static_cast<int>(i), shadows.shares[0][i],
                                     view_.width, view_.height, pool_)
                              .wrong()
                        : wrong_bits(i);
  }
  return wrong;
}

std::size_t ShadowContenders::wrong_without_shadows() {
  if (!prepared_) {
    prepare({.method = "by-rays", .shadows = ChartShadows{.by_rays = true}});
    Image picture = make_image(Format::rgba16f, view_.width, view_.height);
    draw(picture);
  }
  std::size_t dark = 0;
  for (const LightTruth& of : truths()) {
    dark += std::accumulate(of.is_dark.begin(), of.is_dark.end(), std::size_t{0});
  }
  return dark;
}

}  // namespace softfocus
