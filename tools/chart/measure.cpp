#include "tools/chart/measure.h"

#include <algorithm>

#include "dof/measure/heat_map.h"
#include "tools/chart/worst_crop.h"
#include "tools/files/base64.h"
#include "tools/files/image_file.h"

namespace softfocus {
namespace {

constexpr int kLeastCropPx = 16, kMostCropPx = 64;

std::string png_text(const Image& picture) { return base64(encode_png(picture)); }

int crop_side(const Image& picture) {
  const int shorter = std::min(picture.width, picture.height);
  return std::min(std::clamp(shorter / 8, kLeastCropPx, kMostCropPx), shorter);
}

int page_factor(int width, int height) { return reduction_factor(width, height, kPagePicturePx); }

}  // namespace

ChartErrors chart_errors(const MeasuredPictures& measured) {
  ChartErrors errors{measured.whole.psnr_db, measured.whole.ssim, measured.whole.flip, {}};
  for (std::size_t i = 0; i < kRegions; ++i) {
    errors.flip_by_region[i] = measured.by_region[i].flip;
  }
  return errors;
}

std::string page_picture(const Image& picture) {
  return png_text(reduced(picture, page_factor(picture.width, picture.height)));
}

void measure_point(ChartPoint& point, const Image& picture, const Image& truth, const Image& labels,
                   ThreadPool& pool) {
  const MeasuredPictures measured = measure_pictures(truth, picture, &labels, {}, pool);
  const PixelMap& flip = measured.flip;
  point.errors = chart_errors(measured);
  point.worst = worst_crop(flip, crop_side(picture));
  const int factor = page_factor(flip.width, flip.height);
  point.pictures = {.picture = page_picture(picture),
                    .error = png_text(heat_picture(reduced(flip, factor))),
                    .worst = png_text(cropped(picture, point.worst)),
                    .worst_truth = png_text(cropped(truth, point.worst)),
                    .worst_error = png_text(heat_picture(cropped(flip, point.worst)))};
}

}  // namespace softfocus
