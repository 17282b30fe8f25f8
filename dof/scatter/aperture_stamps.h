#pragma once
// An aperture's image at many radii, by the share of each pixel that it covers.

#include <cstdint>
#include <span>
#include <vector>

#include "dof/lens.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// A row of a stamp about the pixel x = 0: the difference of each pixel's cover from that of the
/// pixel on its left, where it is not 0. There are two runs of them, for the two edges.
struct StampRow {
  std::int16_t left_at, right_at;  ///< their first pixels
  std::uint16_t left, right;       ///< how many there are
  std::uint32_t first;             ///< in ApertureStamps::differences; the right run follows
};

struct Stamp {
  std::int32_t row;    ///< in ApertureStamps::rows: its row y = 0
  std::int32_t reach;  ///< rows above and below it
  float weight;        ///< 1 / sum of its covers
};

/// The stamps of the radii of a picture.
struct ApertureStamps {
  std::vector<Stamp> stamps;
  std::vector<StampRow> rows;
  /// Multiples of 2^-20, so that those of a row add to 0 exactly.
  std::vector<float> differences;
  int reach = 0;  ///< columns that the largest goes to either side, and one more
};

/// Radii that differ by less than 2^-12 of themselves have one number, and up to half a pixel,
/// where nothing leaves its pixel, number 0. `upside_down_differs`: radii below 0 have their own.
std::uint32_t stamp_number(float radius_px, bool upside_down_differs);

/// Whether the aperture is another one upside down.
inline bool differs_upside_down(const Aperture& aperture) { return aperture.blades % 2 == 1; }

/// Replaces the numbers of stamp_number() by indices of the stamps that are made here.
ApertureStamps make_stamps(std::span<std::uint32_t> numbers, const Aperture& aperture,
                           ThreadPool& pool);

}  // namespace softfocus
