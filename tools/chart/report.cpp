#include "tools/chart/report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/chart/key.h"
#include "tools/chart/record.h"
#include "tools/golden/hash_text.h"
#include "tools/chart/pareto.h"
#include "tools/bench/timing.h"

namespace softfocus {
namespace {

using nlohmann::ordered_json;

/// What auto may take longer than the method that it chose, by a factor: it looks at the
/// picture first. That, and what times of one run differ by.
constexpr double kChoosing = 1.1;

ordered_json point_json(const ChartPanel& panel, const ChartPoint& point) {
  ordered_json json{{"scene", panel.scene},
                    {"method", point.entry.method},
                    {"settings", settings_json(point.entry)},
                    {"median_ms", point.median_ms}};
  json.update(errors_json(point.errors));
  json["filter_ms"] = nullptr;
  if (!point.times.filter_ms.empty()) {
    json["filter_ms"] = spread_of(point.times.filter_ms).median;
  }
  json["rounds"] = point.times.frame_ms.size();
  json["on_front"] = point.on_front;
  json["truth_samples"] = panel.truth_samples;
  const ordered_json floor = errors_json(panel.noise_floor);
  json["noise_floor_flip"] = floor["flip"];
  json["noise_floor_psnr_db"] = floor["psnr_db"];
  json["picture_hash"] = hash_text(point.picture_hash);
  return json;
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string{"\"\""} : std::string{c};
  return result + "\"";
}

std::string csv_field(const ordered_json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return csv_text(value.get<std::string>());
  if (!value.is_object()) return value.dump();
  std::string settings;
  for (const auto& [name, setting] : value.items()) {
    settings += (settings.empty() ? "" : ";") + name + "=" +
                (setting.is_string() ? setting.get<std::string>() : setting.dump());
  }
  return csv_text(settings);
}

}  // namespace

void settle_points(ChartPanel& panel) {
  std::vector<TwoCosts> costs;
  std::vector<ChartPoint*> fixed;
  for (ChartPoint& point : panel.points) {
    point.median_ms = spread_of(point.times.frame_ms).median;
    point.on_front = false;
    if (point.entry.max_error) continue;
    costs.push_back({point.median_ms, point.errors.flip});
    fixed.push_back(&point);
  }
  for (const std::size_t i : pareto_front(costs)) fixed[i]->on_front = true;
  for (ChartPoint& point : panel.points) {
    if (!point.entry.max_error) continue;
    point.on_front = std::none_of(fixed.begin(), fixed.end(), [&](const ChartPoint* other) {
      return other->errors.flip <= point.errors.flip &&
             other->median_ms * kChoosing < point.median_ms;
    });
  }
}

ordered_json chart_json(const std::vector<ChartPanel>& panels) {
  ordered_json list = ordered_json::array();
  for (const ChartPanel& panel : panels) {
    for (const ChartPoint& point : panel.points) list.push_back(point_json(panel, point));
  }
  return list;
}

std::string chart_csv(const std::vector<ChartPanel>& panels) {
  std::string text;
  for (const ordered_json& point : chart_json(panels)) {
    std::string names, values;
    for (const auto& [name, value] : point.items()) {
      names += (names.empty() ? "" : ",") + name;
      values += (values.empty() ? "" : ",") + csv_field(value);
    }
    if (text.empty()) text = names + "\n";
    text += values + "\n";
  }
  return text;
}

}  // namespace softfocus
