#include "dof/measure/measures.h"

#include "dof/measure/difference.h"
#include "dof/measure/flip.h"
#include "dof/measure/ssim.h"

namespace softfocus {

MeasuredPictures measure_pictures(const Image& reference, const Image& test, const Image* labels,
                                  const MeasureSettings& settings, ThreadPool& pool) {
  MeasuredPictures result;
  const ToneTable linear = clamped_tone();
  const ToneTable screen = srgb_encoded(linear);

  // Puts a map's means in their places, so that one map is kept at a time.
  const auto spread = [&](const PixelMap& map, const auto& put) {
    put(result.whole, RegionMean{map.values.size(), mean(map)});
    if (labels == nullptr) return;
    const auto means = means_by_region(map, *labels);
    for (std::size_t i = 0; i < kRegions; ++i) put(result.by_region[i], means[i]);
  };
  spread(squared_error_map(reference, test, linear, pool), [](Measures& to, const RegionMean& of) {
    to.pixels = of.pixels;
    to.mse = of.mean;
    to.psnr_db = psnr_db(of.mean);
  });
  spread(squared_error_map(reference, test, srgb_encoded(filmic_tone()), pool),
         [](Measures& to, const RegionMean& of) {
           to.toned_mse = of.mean;
           to.toned_psnr_db = psnr_db(of.mean);
         });
  spread(ssim_map(reference, test, screen, pool),
         [](Measures& to, const RegionMean& of) { to.ssim = of.mean; });
  if (settings.hdr_flip) {
    spread(hdr_flip_map(reference, test, pool, settings.pixels_per_degree),
           [](Measures& to, const RegionMean& of) { to.hdr_flip = of.mean; });
  }
  result.flip = flip_map(reference, test, linear, pool, settings.pixels_per_degree);
  spread(result.flip, [](Measures& to, const RegionMean& of) { to.flip = of.mean; });
  return result;
}

}  // namespace softfocus
