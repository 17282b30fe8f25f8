#include "tools/chart/report/summary.h"

#include <algorithm>
#include <cmath>

#include "tools/chart/point.h"
#include "tools/chart/record.h"
#include "tools/cli/timing.h"
#include "tools/files/json.h"
#include "tools/golden/hashes.h"

namespace softfocus {
namespace {

struct Contender {
  const ChartPanel* panel;
  const ChartPoint* point;
};

/// The contender that all scenes' points share: auto's choices differ.
ChartEntry without_choice(ChartEntry entry) {
  entry.chosen.clear();
  return entry;
}

double seen_error(const ChartPanel& panel, const ChartPoint& point, const RankedError& error) {
  const double noise = panel.noise_floor.*error.value;
  const double own = std::max(point.errors.*error.value, error.least_in_ratio);
  return std::isnan(noise) ? own : std::max(own, noise);
}

/// Over the least error within the contender's time. NaN without times.
double ratio_of(const Contender& of, const RankedError& error) {
  if (std::isnan(of.point->median_ms)) return kNotTimed;
  const double own = seen_error(*of.panel, *of.point, error);
  double least = own;
  for (const ChartPoint& other : of.panel->points) {
    if (other.median_ms <= of.point->median_ms) {
      least = std::min(least, seen_error(*of.panel, other, error));
    }
  }
  return own / least;
}

SummaryRow row_of(std::string method, std::string settings,
                  const std::vector<Contender>& contenders) {
  SummaryRow row{.method = std::move(method),
                 .settings = std::move(settings),
                 .scenes = static_cast<int>(contenders.size())};
  const auto over = [&](const auto& number_of) {
    std::vector<SceneNumber> numbers;
    numbers.reserve(contenders.size());
    for (const Contender& of : contenders) numbers.push_back({number_of(of), of.panel->scene});
    return over_scenes(numbers);
  };
  row.pinhole_frames = over([](const Contender& of) { return of.point->pinhole_frames; });
  if (!contenders.empty()) row.ranked = contenders.front().panel->ranked;
  for (std::size_t i = 0; i < row.ranked.size(); ++i) {
    const RankedError& error = row.ranked[i];
    row.ratios[i] = over([&](const Contender& of) { return ratio_of(of, error); });
    row.errors[i] = over([&](const Contender& of) { return of.point->errors.*error.value; });
  }
  return row;
}

/// The entries of all panels, each once, those of a series one after the other.
std::vector<ChartEntry> entries_of(const std::vector<ChartPanel>& panels) {
  std::vector<ChartEntry> entries;
  for (const ChartPanel& panel : panels) {
    for (const ChartPoint& point : panel.points) {
      const std::string id = entry_id(point.entry);
      const bool is_there =
          std::any_of(entries.begin(), entries.end(),
                      [&](const ChartEntry& other) { return entry_id(other) == id; });
      if (!is_there) entries.push_back(without_choice(point.entry));
    }
  }
  return entries;
}

template <class Wanted>
std::vector<Contender> contenders_of(const std::vector<ChartPanel>& panels, const Wanted& wanted) {
  std::vector<Contender> contenders;
  for (const ChartPanel& panel : panels) {
    for (const ChartPoint& point : panel.points) {
      if (wanted(point)) contenders.push_back({&panel, &point});
    }
  }
  return contenders;
}

/// Null if none is within the budget.
const ChartPoint* best_within(const ChartPanel& panel, double budget, double ChartErrors::*error) {
  const ChartPoint* best = nullptr;
  for (const ChartPoint& point : panel.points) {
    if (point.pinhole_frames > budget) continue;
    const double own = point.errors.*error;
    if (best == nullptr || own < best->errors.*error ||
        (own == best->errors.*error && point.median_ms < best->median_ms)) {
      best = &point;
    }
  }
  return best;
}

}  // namespace

OverScenes over_scenes(std::span<const SceneNumber> numbers) {
  std::vector<double> sorted;
  OverScenes result;
  for (const SceneNumber& of : numbers) {
    if (!std::isfinite(of.number)) return {};
    sorted.push_back(of.number);
    if (std::isnan(result.worst) || of.number > result.worst) {
      result.worst = of.number;
      result.worst_scene = of.scene;
    }
  }
  if (sorted.empty()) return {};
  result.median = spread_of(sorted).median;
  std::sort(sorted.begin(), sorted.end());
  // The rank in whole numbers: 0.9 * 10 would be above 9.
  result.p90 = sorted[(9 * sorted.size() + 9) / 10 - 1];
  return result;
}

std::vector<SummaryRow> summary_of(const std::vector<ChartPanel>& panels) {
  std::vector<SummaryRow> rows;
  const std::vector<ChartEntry> entries = entries_of(panels);
  std::vector<std::string> done;
  for (const ChartEntry& first : entries) {
    const std::string series = series_name(first);
    if (std::find(done.begin(), done.end(), series) != done.end()) continue;
    done.push_back(series);
    const std::size_t before = rows.size();
    for (const ChartEntry& entry : entries) {
      if (series_name(entry) != series) continue;
      const std::string id = entry_id(entry);
      rows.push_back(row_of(series, setting_within_series(entry),
                            contenders_of(panels, [&](const ChartPoint& point) {
                              return entry_id(point.entry) == id;
                            })));
    }
    if (rows.size() - before < 2) continue;
    rows.push_back(row_of(series, std::string{kBestSetting},
                          contenders_of(panels, [&](const ChartPoint& point) {
                            return point.best_setting && series_name(point.entry) == series;
                          })));
  }
  return rows;
}

bool has_times(const std::vector<SummaryRow>& summary) {
  return std::none_of(summary.begin(), summary.end(),
                      [](const SummaryRow& row) { return std::isnan(row.pinhole_frames.median); });
}

std::vector<BestForBudget> best_for_budgets(const std::vector<ChartPanel>& panels) {
  std::vector<BestForBudget> list;
  for (const ChartPanel& panel : panels) {
    const auto add = [&](double budget) {
      for (std::size_t i = 0; i < panel.ranked.size(); ++i) {
        const ChartPoint* point = best_within(panel, budget, panel.ranked[i].value);
        if (point != nullptr) list.push_back({panel.scene, budget, i, panel.ranked[i], point});
      }
    };
    if (has_times(panel)) {
      for (const double budget : kBudgets) add(budget);
    }
    add(kAnyTime);
  }
  return list;
}

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
