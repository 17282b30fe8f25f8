#include "tools/chart/measure.h"

#include <algorithm>

#include "dof/measure/heat_map.h"
#include "dof/measure/regions.h"
#include "tools/files/base64.h"
#include "tools/pictures/image_file.h"
#include "tools/report/specimen.h"
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
        made.push_back(
            {key + "_" + name, name, title, flip.places,
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

}  // namespace softfocus
