#include "tools/info/shadow_measures.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/draw/light_points.h"
#include "scenes/shadows/maps/draw_map_side.h"
#include "scenes/shadows/maps/map_errors.h"
#include "tools/cli/timing.h"
#include "tools/gl/frame_on_gl.h"

namespace softfocus {
namespace {

Scene with_shadows(Scene scene, ShadowKind kind) {
  set_shadows(scene, kind);
  return scene;
}

Scene with_settings(Scene scene, const ShadowMapSettings& settings) {
  for (Light& light : scene.lights) light.map = settings;
  return scene;
}

// The truths of all lights of a drawing, which has maps or projected shadows.
class LightTruths {
 public:
  LightTruths(const RepeatedShadows& drawing, ThreadPool& pool)
      : facets_(drawing.shadows().facets), view_(drawing.view()) {
    const SceneShadows& shadows = drawing.shadows();
    lights_.reserve(shadows.lights.size());
    for (const std::size_t number : shadows.lights) {
      lights_.push_back(shadow_light(drawing.scene.lights[number]));
      truths_.emplace_back(facets_, lights_.back(), view_, drawing.camera.eye, true);
      is_dark_.push_back(
          dark_pixels(truths_.back(), shadows.seen[0], view_.width, view_.height, pool));
    }
  }
  LightTruths(const LightTruths&) = delete;
  LightTruths& operator=(const LightTruths&) = delete;

  MapErrors errors(const RepeatedShadows& drawing, ThreadPool& pool) const {
    const SceneShadows& shadows = drawing.shadows();
    MapErrors sum;
    for (std::size_t i = 0; i < truths_.size(); ++i) {
      sum += map_errors(facets_, shadows.maps[i], truths_[i], is_dark_[i], shadows.seen[0],
                        shadows.masks[0], static_cast<int>(i), shadows.shares[0][i], view_.width,
                        view_.height, pool);
    }
    return sum;
  }

 private:
  const Facets& facets_;
  ShadowView view_;
  std::vector<ShadowLight> lights_;
  std::vector<ShadowTruth> truths_;
  std::vector<std::vector<std::uint8_t>> is_dark_;
};

std::size_t bytes_of(const SceneShadows& shadows) {
  std::size_t bytes = 0;
  for (const ShadowMap& map : shadows.maps) {
    for (const MapSide& side : map.sides) bytes += side.nearness.size() * sizeof(float);
  }
  return bytes;
}

struct TableRow {
  std::string name;
  std::string setting;  ///< that is changed alone; empty: several are, or one without a number
  double value;
  ShadowMapSettings settings;
};

std::vector<TableRow> table_rows(const ShadowMapSettings& usual) {
  std::vector<TableRow> rows;
  const auto add = [&](std::string name, const std::function<void(ShadowMapSettings&)>& change) {
    ShadowMapSettings settings = usual;
    change(settings);
    rows.push_back({std::move(name), "", 0.0, settings});
  };
  const auto sweep = [&](const char* setting, const std::vector<double>& values,
                         const std::function<void(ShadowMapSettings&, double)>& change) {
    for (const double value : values) {
      add(std::string{setting} + "=" + short_number(value),
          [&](ShadowMapSettings& map) { change(map, value); });
      rows.back().setting = setting;
      rows.back().value = value;
    }
  };
  const auto whole = [](double value) { return static_cast<int>(value); };
  sweep("size", {256, 512, 1024, 2048, 4096},
        [&](ShadowMapSettings& map, double size) { map.size = whole(size); });
  sweep("bias", {0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 16.0},
        [](ShadowMapSettings& map, double bias) { map.bias = bias; });
  sweep("slope-bias", {0.0, 0.25, 0.5, 0.75, 1.0, 2.0, 4.0},
        [](ShadowMapSettings& map, double bias) { map.slope_bias = bias; });
  add("no-bias", [](ShadowMapSettings& map) { map.bias = map.slope_bias = 0.0; });
  std::vector<double> kernels, cascades;
  for (int kernel = 1; kernel <= kMostMapKernel; kernel += 2) kernels.push_back(kernel);
  for (int count = 1; count <= kMostCascades; ++count) cascades.push_back(count);
  sweep("kernel", kernels,
        [&](ShadowMapSettings& map, double kernel) { map.kernel = whole(kernel); });
  sweep("cascades", cascades,
        [&](ShadowMapSettings& map, double count) { map.cascades = whole(count); });
  add("fit=scene", [](ShadowMapSettings& map) {
    map.fits_camera = false;
    map.cascades = 1;
  });
  for (int size = 1024; size <= 4096; size *= 2) {
    add("size=" + std::to_string(size) + ",cascades=4", [&](ShadowMapSettings& map) {
      map.size = size;
      map.cascades = 4;
    });
  }
  return rows;
}

Json map_errors_json(const MapErrors& errors) {
  return {{"seen", errors.seen},
          {"in_shadow", errors.in_shadow},
          {"near_edge", errors.near_edge},
          {"wrong", errors.wrong()},
          {"aliasing", errors.aliasing},
          {"acne", errors.acne},
          {"peter_panning", errors.peter_panning},
          {"missed_shares", errors.missed_share}};
}

// The sides of all maps, from casters that are cut already.
void time_maps_beside(const Driver& driver, const SceneShadows& shadows, int runs, Findings& found,
                      ThreadPool& pool) {
  // A GPU's has to be probed first; its bits are not expected to be ours.
  const Profile profile = find_profile(driver.profile).value_or(Profile{});
  const auto cut = [&](const ShadowMap& map) {
    MapCasters casters{map.settings, {}};
    for (const MapSide& side : map.sides) {
      casters.sides.emplace_back();
      if (side.texels == glm::dvec2{0.0}) continue;
      casters.sides.back() = cut_casters(shadows.facets, map.light, map.settings.size, side, pool);
    }
    return casters;
  };
  std::vector<ShadowMap> maps = shadows.maps;
  std::vector<MapCasters> casters(maps.size());
  const auto cut_all = [&] {
    for (std::size_t i = 0; i < maps.size(); ++i) casters[i] = cut(maps[i]);
  };
  const auto draw_all = [&] {
    for (std::size_t i = 0; i < maps.size(); ++i) {
      for (std::size_t k = 0; k < maps[i].sides.size(); ++k) {
        draw_casters(casters[i].sides[k], maps[i].settings.size, profile, maps[i].sides[k], pool);
      }
    }
  };
  cut_all();
  MapsRepeatedOnGl on_gl{driver, casters, pool.threads()};
  on_gl.draw();
  std::vector<Milliseconds> times{
      {"casters into maps"}, {"the same, " + std::string{driver.name}}, {"cutting, before either"}};
  time_in_turn(
      times, runs, draw_all, [&] { on_gl.draw(); }, cut_all);
  std::size_t texels = 0, differ = 0;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const int size = maps[i].settings.size;
    for (std::size_t k = 0; k < maps[i].sides.size(); ++k) {
      const std::vector<float>& ours = maps[i].sides[k].nearness;
      if (ours.empty()) continue;
      const Image theirs = on_gl.nearness(i, k);
      texels += ours.size();
      for (int y = 0; y < size; ++y) {
        const auto of_row = row<float>(theirs, y);
        const float* from = ours.data() + static_cast<std::size_t>(y) * of_row.size();
        for (std::size_t x = 0; x < of_row.size(); ++x) {
          differ += std::bit_cast<std::uint32_t>(of_row[x]) != std::bit_cast<std::uint32_t>(from[x])
                        ? 1
                        : 0;
        }
      }
    }
  }
  found.add_times(times);
  found.add_ratio(times, {{"differ", differ}, {"texels", texels}, {"renderer", on_gl.renderer()}});
}

}  // namespace

void measure_maps(const ShadowMeasure& measure, bool check, Findings& found, ThreadPool& pool) {
  ThreadPool one{1, pool.isa()};
  RepeatedShadows mapped{measure.scene, measure, pool};
  RepeatedShadows projected{with_shadows(measure.scene, ShadowKind::projected), measure, pool};
  RepeatedShadows plain{with_shadows(measure.scene, ShadowKind::none), measure, pool};
  for (RepeatedShadows* of : {&mapped, &projected, &plain}) of->draw();
  SceneShadows& shadows = mapped.shadows();
  found.add({{"scene", measure.scene.name},
             {"triangles", shadows.facets.facets.size()},
             {"map_lights", shadows.lights.size()},
             {"map_megabytes", static_cast<double>(bytes_of(shadows)) / 1e6}});
  const MapCamera camera = map_camera(mapped.scene, mapped.camera);
  const ShadowView view{camera.world_to_clip, measure.size.width, measure.size.height, Profile{}};
  const auto maps_by = [&](ThreadPool& by) {
    shadows.maps.assign(shadows.lights.size(), {});
    draw_maps(shadows, mapped.scene.lights, camera, Profile{}, by);
  };
  std::vector<Milliseconds> times{{"draw maps, 1 thread"}, {"draw maps, all"},
                                  {"look up, all"},        {"frame, nothing kept"},
                                  {"frame, maps kept"},    {"projected, nothing kept"},
                                  {"projected, kept"},     {"frame without shadows"}};
  time_in_turn(
      times, measure.runs, [&] { maps_by(one); }, [&] { maps_by(pool); },
      [&] {
        std::fill(shadows.masks[0].begin(), shadows.masks[0].end(), std::uint8_t{0});
        look_up_maps(shadows, 0, view, camera.eye, pool);
      },
      [&] { mapped.draw_anew(); }, [&] { mapped.draw(); }, [&] { projected.draw_anew(); },
      [&] { projected.draw(); }, [&] { plain.draw(); });
  found.add_times(times);
  if (measure.versus != nullptr) {
    time_maps_beside(*measure.versus, shadows, measure.runs, found, pool);
  }
  if (!check) return;
  found.add(map_errors_json(LightTruths{mapped, pool}.errors(mapped, pool)), "check");
}

void find_map_table(const ShadowMeasure& measure, Findings& found, ThreadPool& pool) {
  RepeatedShadows projected{with_shadows(measure.scene, ShadowKind::projected), measure, pool};
  projected.draw();
  const LightTruths truths{projected, pool};
  found.add({{"scene", measure.scene.name}, {"runs", measure.runs}});
  found.begin_table("settings", {{"name", 22},
                                 {"ms", 9, 1},
                                 {"wrong", 9},
                                 {"aliasing", 9},
                                 {"acne", 9},
                                 {"peter_panning", 13},
                                 {"near_edge", 9},
                                 {"missed_shares", 13},
                                 {"projected_ms", 12, 1}});
  for (const TableRow& row : table_rows(measure.scene.lights[0].map)) {
    RepeatedShadows mapped{with_settings(measure.scene, row.settings), measure, pool};
    mapped.draw();
    std::vector<Milliseconds> times{{"mapped"}, {"projected"}};
    time_in_turn(
        times, measure.runs, [&] { mapped.draw_anew(); }, [&] { projected.draw_anew(); });
    Json record{{"name", row.name},
                {"ms", spread_of(times[0].ms).median},
                {"projected_ms", spread_of(times[1].ms).median}};
    const Json errors = map_errors_json(truths.errors(mapped, pool));
    for (const std::string& key : errors.names()) record[key] = errors.at(key);
    if (!row.setting.empty()) {
      record["setting"] = row.setting;
      record["value"] = row.value;
    }
    found.add_row(record);
  }
}

}  // namespace softfocus
