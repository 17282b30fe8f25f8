#pragma once
// What the numbers of an effect are to its passes: for a driver's side of a comparison, and what
// repeats an effect.

#include <span>

#include "raster/effects/bloom.h"
#include "raster/effects/effect.h"
#include "raster/effects/lens_flare.h"
#include "raster/effects/motion/motion_blur.h"
#include "raster/passes/bilateral.h"
#include "raster/passes/pyramid.h"

namespace softfocus {

BilateralSettings bilateral_settings(std::span<const double> parameters);
BloomSettings bloom_settings(std::span<const double> parameters);
GaussianBloomSettings gaussian_bloom_settings(std::span<const double> parameters);
LensFlareSettings lens_flare_settings(std::span<const double> parameters);
MotionBlurSettings motion_blur_settings(std::span<const double> parameters, MotionFilter filter);
struct DualFilterSettings {
  int levels;
  Widening widening;
};
DualFilterSettings dual_filter_settings(std::span<const double> parameters);

/// As apply(), into RGBA16F of the picture's size.
void apply_into(const Effect& effect, const EffectInput& input, const ImageView& result,
                ThreadPool& pool);

}  // namespace softfocus
