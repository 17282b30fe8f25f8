#pragma once
// All measures of how two pictures differ, for the whole picture and by region.

#include <array>
#include <optional>

#include "dof/measure/flip.h"
#include "dof/measure/regions.h"

namespace softfocus {

/// Of a region without pixels every value but `pixels` is NaN.
struct Measures {
  std::uint64_t pixels = 0;
  double mse = 0.0;        ///< linear light, clamped to 0..1
  double psnr_db = 0.0;    ///< of it
  double toned_mse = 0.0;  ///< through filmic_tone() and the sRGB curve
  double toned_psnr_db = 0.0;
  double ssim = 0.0;                 ///< of luma, clamped and through the sRGB curve
  double flip = 0.0;                 ///< of clamped light
  std::optional<double> hdr_flip{};  ///< where it was asked for
};

struct MeasureSettings {
  double pixels_per_degree = kUsualPixelsPerDegree;
  bool hdr_flip = false;  ///< takes as long as one FLIP for each exposure
};

struct MeasuredPictures {
  Measures whole;
  std::array<Measures, kRegions> by_region{};  ///< in the order of Region; only with labels
  PixelMap flip;                               ///< for heat_picture()
};

/// `labels`, from label_regions(), may be null. The pictures are RGBA16F and all of one
/// size. Alpha is not looked at.
MeasuredPictures measure_pictures(const Image& reference, const Image& test, const Image* labels,
                                  const MeasureSettings& settings, ThreadPool& pool);

}  // namespace softfocus
