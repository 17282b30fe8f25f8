#include "tools/chart/measure.h"

#include <algorithm>
#include <map>

#include "dof/measure/heat_map.h"
#include "dof/measure/regions.h"
#include "tools/files/base64.h"
#include "tools/pictures/image_file.h"
#include "tools/report/kept_results.h"
#include "tools/report/worst_crop.h"

namespace softfocus {
namespace {

constexpr int kLeastCropPx = 16, kMostCropPx = 64;

std::string png_text(const Image& picture) { return base64(encode_png(picture)); }

int crop_side(const Image& picture) {
  const int shorter = std::min(picture.width, picture.height);
  return std::min(std::clamp(shorter / 8, kLeastCropPx, kMostCropPx), shorter);
}

int page_factor(int width, int height) { return reduction_factor(width, height, kPagePicturePx); }

/// Circles of up to some 8 pixels.
constexpr PixelCoc kSpecimenCoc{.radius_at_infinity_px = 4.0f, .focus_m = 2.0f};

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

ChartErrors chart_errors(const MeasuredPictures& measured) {
  const auto hdr_flip = [](const Measures& of) { return of.hdr_flip.value(); };
  ChartErrors errors{.psnr_db = measured.whole.psnr_db,
                     .ssim = measured.whole.ssim,
                     .flip = measured.whole.flip,
                     .hdr_flip = hdr_flip(measured.whole)};
  for (std::size_t i = 0; i < kRegions; ++i) {
    errors.flip_by_region[i] = measured.by_region[i].flip;
    errors.hdr_flip_by_region[i] = hdr_flip(measured.by_region[i]);
  }
  return errors;
}

const std::vector<ChartMeasure>& chart_measures() {
  static const std::vector<ChartMeasure> all = [] {
    std::vector<ChartMeasure> made;
    const auto add = [&](const char* key, const char* title, int places, double ChartErrors::*value,
                         bool is_own = false) {
      made.push_back({key, title, "", places,
                      [value](ChartErrors& errors) -> double& { return errors.*value; }, is_own});
    };
    using ByRegion = std::array<double, kRegions>;
    const auto add_flip = [&](const RankedError& flip, ByRegion ChartErrors::*by_region) {
      const std::string key{flip.key}, title{flip.title};
      add(key.c_str(), "whole", flip.places, flip.value);
      made.back().group = title;
      for (const Region region : kAllRegions) {
        const auto i = static_cast<std::size_t>(region);
        const std::string name{region_name(region)};
        std::string own_key = key;
        own_key.append("_").append(name);
        made.push_back(
            {own_key, name, title, flip.places,
             [by_region, i](ChartErrors& errors) -> double& { return (errors.*by_region)[i]; }});
      }
    };
    add("psnr_db", "PSNR, dB", 2, &ChartErrors::psnr_db);
    add("ssim", "SSIM", 4, &ChartErrors::ssim);
    add_flip(kPictureErrors[0], &ChartErrors::flip_by_region);
    add_flip(kPictureErrors[1], &ChartErrors::hdr_flip_by_region);
    add("wrong_pixels", "wrong pixels", 0, &ChartErrors::wrong_pixels, true);
    add("outline_px", "outline, px", 3, &ChartErrors::outline_px, true);
    add("renewals", "renewals", 0, &ChartErrors::renewals, true);
    add("megabytes", "MB", 2, &ChartErrors::megabytes, true);
    return made;
  }();
  return all;
}

std::string page_picture(const Image& picture) {
  return png_text(reduced(picture, page_factor(picture.width, picture.height)));
}

ChartErrors measure_picture(const Image& picture, const Image& truth, const Image& labels,
                            ThreadPool& pool) {
  return chart_errors(measure_pictures(truth, picture, &labels, {.hdr_flip = true}, pool));
}

void add_point_pictures(ChartPoint& point, const Image& picture, const Image& truth,
                        ThreadPool& pool) {
  const PixelMap flip = flip_map(truth, picture, clamped_tone(), pool);
  point.worst = worst_crop(flip, crop_side(picture));
  const int factor = page_factor(flip.width, flip.height);
  point.pictures = {.picture = page_picture(picture),
                    .error = png_text(heat_picture(reduced(flip, factor))),
                    .worst = png_text(cropped(picture, point.worst)),
                    .worst_truth = png_text(cropped(truth, point.worst)),
                    .worst_error = png_text(heat_picture(cropped(flip, point.worst)))};
}

std::uint64_t measures_hash(ThreadPool& pool) {
  const SpecimenPair pair = specimen_pair();
  const Image labels = label_regions(pair.truth, kSpecimenCoc);
  const ChartErrors errors = measure_picture(pair.picture, pair.truth, labels, pool);
  ChartPoint point;
  add_point_pictures(point, pair.picture, pair.truth, pool);
  Hash hash;
  for (const ChartMeasure& measure : chart_measures()) add_number(hash, measure.value(errors));
  for (const int number : {point.worst.x, point.worst.y, point.worst.side}) {
    add_number(hash, number);
  }
  for (const KeptPicture& of : kKeptPictures) add_text(hash, point.pictures.*of.picture);
  return hash.value;
}

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
