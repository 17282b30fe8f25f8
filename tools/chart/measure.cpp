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
  for (const double number : {errors.psnr_db, errors.ssim, errors.flip, errors.hdr_flip}) {
    add_number(hash, number);
  }
  for (std::size_t i = 0; i < kRegions; ++i) {
    add_number(hash, errors.flip_by_region[i]);
    add_number(hash, errors.hdr_flip_by_region[i]);
  }
  for (const int number : {point.worst.x, point.worst.y, point.worst.side}) {
    add_number(hash, number);
  }
  for (const KeptPicture& of : kKeptPictures) add_text(hash, point.pictures.*of.picture);
  return hash.value;
}

}  // namespace softfocus
