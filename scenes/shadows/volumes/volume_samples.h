#pragma once
// The samples of what pixels show (volume_mask.h), in blocks.

#include <cstdint>
#include <span>
#include <vector>

#include "scenes/shadows/projected_shadows.h"
#include "scenes/shadows/volumes/face_bands.h"

namespace softfocus {

/// What a band of the picture is counted with. Pixels lie block by block.
struct Band {
  std::vector<double> x, y, q;
  std::vector<std::int64_t> counts;
  std::vector<std::uint8_t> counted;  ///< whether the pixel has a sample
  struct Block {
    Extremes q;
    std::int64_t count = 0;  ///< of all its pixels
  };
  std::vector<Block> blocks;
};

/// A pixel whose sample lies elsewhere.
struct FarSample {
  std::size_t pixel;
  glm::dvec3 place;
};

/// What samples are taken of.
struct SampledScene {
  const Facets& facets;
  const ShadowLight& light;
  std::span<const LitSide> lit;
};

/// Rows of the picture, and the bit that they get.
struct MaskRows {
  std::span<const SeenFacet> seen;
  std::span<std::uint8_t> mask;
  std::uint8_t bit;
  int y_begin, y_end;
};

/// Fills a band with the samples of its rows; those that lie elsewhere go to `far`. False if it has
/// none.
bool find_samples(const SampledScene& scene, const MaskRows& rows, const ShadowView& view,
                  const PixelSpace& space, Band& band, std::vector<FarSample>& far);

/// Of a pixel of the picture, with the row of the band that it is in.
std::size_t place_in_band(int x, int row, int width);

/// Of a pixel with a sample.
inline std::int64_t count_at(const Band& band, std::size_t place) {
  return band.blocks[place / kSampleBlockPixels].count + band.counts[place];
}

/// Sets the bits of pixels that a volume holds. `of_eye` is added to each count.
void set_mask(const MaskRows& rows, int width, std::int32_t of_eye, const Band& band);

}  // namespace softfocus
