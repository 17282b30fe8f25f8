#include "tools/chart/pictures.h"

#include <algorithm>
#include <map>

namespace softfocus {
namespace {

enum class Pictured { all, best, worst };

Pictured rule_for(std::size_t scenes, std::size_t points) {
  if (scenes > kMostPanels) return Pictured::worst;
  return points <= kMostPicturedPoints ? Pictured::all : Pictured::best;
}

Pictured rule_for(const std::vector<ChartPanel>& panels) {
  std::size_t points = 0;
  for (const ChartPanel& panel : panels) points += panel.points.size();
  return rule_for(panels.size(), points);
}

/// A profile's or an arithmetic's picture looks like the method's own.
bool is_best_of_method(const ChartPoint& point) {
  return point.best_setting && series_name(point.entry) == point.entry.method;
}

std::vector<PicturedPoint> worst_of_methods(const std::vector<ChartPanel>& panels) {
  std::map<std::string, PicturedPoint> worst;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    for (std::size_t k = 0; k < panels[i].points.size(); ++k) {
      const ChartPoint& point = panels[i].points[k];
      if (!is_best_of_method(point)) continue;
      const auto [found, is_first] = worst.try_emplace(point.entry.method, PicturedPoint{i, k});
      const PicturedPoint& before = found->second;
      double ChartErrors::*const error = panels[i].ranked[0].value;
      const ChartPoint& worst_before = panels[before.panel].points[before.point];
      if (!is_first && point.errors.*error > worst_before.errors.*error) {
        found->second = {i, k};
      }
    }
  }
  std::vector<PicturedPoint> points;
  points.reserve(worst.size());
  for (const auto& [method, point] : worst) points.push_back(point);
  std::sort(points.begin(), points.end(), [](const PicturedPoint& a, const PicturedPoint& b) {
    return a.panel != b.panel ? a.panel < b.panel : a.point < b.point;
  });
  return points;
}

}  // namespace

std::vector<PicturedPoint> pictured_points(const std::vector<ChartPanel>& panels) {
  const Pictured rule = rule_for(panels);
  if (rule == Pictured::worst) return worst_of_methods(panels);
  std::vector<PicturedPoint> points;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    for (std::size_t k = 0; k < panels[i].points.size(); ++k) {
      const ChartPoint& point = panels[i].points[k];
      if (rule == Pictured::all || is_best_of_method(point)) {
        points.push_back({i, k});
      }
    }
  }
  return points;
}

std::size_t expected_pictures(std::size_t scenes, std::size_t points_a_scene, std::size_t methods) {
  switch (rule_for(scenes, scenes * points_a_scene)) {
    case Pictured::all: return scenes * points_a_scene;
    case Pictured::best: return scenes * methods;
    case Pictured::worst: break;
  }
  return methods;
}

std::string pictured_text(const std::vector<ChartPanel>& panels) {
  switch (rule_for(panels)) {
    case Pictured::all: return "Every row of the table leads to its pictures.";
    case Pictured::best: return "Pictures are of every method at its best setting on each scene.";
    case Pictured::worst: break;
  }
  return "Pictures are of every method at its best setting, on the scene where its error is "
         "largest.";
}

}  // namespace softfocus
