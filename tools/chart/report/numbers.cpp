#include "tools/chart/report/numbers.h"

#include "tools/chart/record.h"
#include "tools/cli/timing.h"
#include "tools/files/json.h"
#include "tools/golden/hashes.h"

namespace softfocus {
namespace {

Json point_json(const ChartPanel& panel, const ChartPoint& point) {
  Json json{{"scene", panel.scene},
            {"method", point.entry.method},
            {"settings", settings_json(point.entry)},
            {"median_ms", number_or_null(point.median_ms)},
            {"pinhole_frames", number_or_null(point.pinhole_frames)}};
  const Json errors = errors_json(point.errors);
  for (const std::string& name : errors.names()) json[name] = errors.at(name);
  json["filter_ms"] = nullptr;
  if (!point.times.filter_ms.empty()) {
    json["filter_ms"] = spread_of(point.times.filter_ms).median;
  }
  json["rounds"] = point.times.frame_ms.size();
  json["on_front"] = point.times.frame_ms.empty() ? Json() : Json(point.on_front);
  json["best_setting"] = point.best_setting;
  json["truth_samples"] = panel.truth_samples;
  const Json floor = errors_json(panel.noise_floor);
  json["noise_floor_flip"] = floor.at("flip");
  json["noise_floor_hdr_flip"] = floor.at("hdr_flip");
  json["noise_floor_psnr_db"] = floor.at("psnr_db");
  json["picture_hash"] = hash_text(point.picture_hash);
  return json;
}

}  // namespace

Json chart_json(const std::vector<ChartPanel>& panels) {
  Json list = Json::array();
  for (const ChartPanel& panel : panels) {
    for (const ChartPoint& point : panel.points) list.push_back(point_json(panel, point));
  }
  return list;
}

Json best_json(const std::vector<BestForBudget>& best) {
  Json list = Json::array();
  for (const BestForBudget& of : best) {
    const RankedError& ranked = of.ranked;
    list.push_back({{"scene", of.scene},
                    {"budget", number_or_null(of.budget)},
                    {"measure", ranked.key},
                    {"method", of.point->entry.method},
                    {"settings", settings_json(of.point->entry)},
                    {"error", of.point->errors.*ranked.value},
                    {"pinhole_frames", number_or_null(of.point->pinhole_frames)},
                    {"median_ms", number_or_null(of.point->median_ms)}});
  }
  return list;
}

Json summary_json(const std::vector<SummaryRow>& summary) {
  Json list = Json::array();
  for (const SummaryRow& row : summary) {
    Json json{{"method", row.method},
              {"settings", row.settings},
              {"scenes", row.scenes},
              {"pinhole_frames_median", number_or_null(row.pinhole_frames.median)},
              {"pinhole_frames_worst", number_or_null(row.pinhole_frames.worst)}};
    const auto add = [&](const std::string& name, const OverScenes& of) {
      json[name + "_median"] = number_or_null(of.median);
      json[name + "_p90"] = number_or_null(of.p90);
      json[name + "_worst"] = number_or_null(of.worst);
      json[name + "_worst_scene"] = of.worst_scene;
    };
    for (std::size_t i = 0; i < row.ranked.size(); ++i) {
      const std::string key{row.ranked[i].key};
      add(key + "_ratio", row.ratios[i]);
      add(key, row.errors[i]);
    }
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace softfocus
