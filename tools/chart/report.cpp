#include "tools/chart/report.h"

#include <algorithm>

#include "tools/bench/timing.h"
#include "tools/chart/key.h"
#include "tools/chart/pareto.h"
#include "tools/chart/record.h"
#include "tools/files/json.h"
#include "tools/golden/hash_text.h"

namespace softfocus {
namespace {

/// What auto may take longer than the method that it chose, by a factor: it looks at the
/// picture first. That, and what times of one run differ by.
constexpr double kChoosing = 1.1;

Json point_json(const ChartPanel& panel, const ChartPoint& point) {
  Json json{{"scene", panel.scene},
            {"method", point.entry.method},
            {"settings", settings_json(point.entry)},
            {"median_ms", point.median_ms}};
  const Json errors = errors_json(point.errors);
  for (const std::string& name : errors.names()) json[name] = errors.at(name);
  json["filter_ms"] = nullptr;
  if (!point.times.filter_ms.empty()) {
    json["filter_ms"] = spread_of(point.times.filter_ms).median;
  }
  json["rounds"] = point.times.frame_ms.size();
  json["on_front"] = point.on_front;
  json["truth_samples"] = panel.truth_samples;
  const Json floor = errors_json(panel.noise_floor);
  json["noise_floor_flip"] = floor.at("flip");
  json["noise_floor_psnr_db"] = floor.at("psnr_db");
  json["picture_hash"] = hash_text(point.picture_hash);
  return json;
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string{"\"\""} : std::string{c};
  return result + "\"";
}

std::string csv_field(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_text()) return csv_text(value.text());
  if (!value.is_object()) return json_text(value);
  std::string settings;
  for (const std::string& name : value.names()) {
    const Json& setting = value.at(name);
    settings += (settings.empty() ? "" : ";") + name + "=" +
                (setting.is_text() ? setting.text() : json_text(setting));
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

Json chart_json(const std::vector<ChartPanel>& panels) {
  Json list = Json::array();
  for (const ChartPanel& panel : panels) {
    for (const ChartPoint& point : panel.points) list.push_back(point_json(panel, point));
  }
  return list;
}

std::string chart_csv(const std::vector<ChartPanel>& panels) {
  std::string text;
  const Json list = chart_json(panels);
  for (const Json& point : list.values()) {
    std::string names, values;
    for (const std::string& name : point.names()) {
      names += (names.empty() ? "" : ",") + name;
      values += (values.empty() ? "" : ",") + csv_field(point.at(name));
    }
    if (text.empty()) text = names + "\n";
    text += values + "\n";
  }
  return text;
}

}  // namespace softfocus
