#pragma once
// Counts what differs between a driver's pictures and the emulation's.

#include <cstdint>
#include <optional>
#include <string>

#include "raster/images/image.h"

namespace softfocus {

struct FirstDifference {
  int x = 0;
  int y = 0;
  int channel = 0;
  std::string driver;  ///< both values as text: number and bits
  std::string emulated;
  std::string where;  ///< which of a case's pictures: "level 2", "batch 17"
};

struct Tally {
  std::uint64_t values = 0;
  std::uint64_t differing = 0;
  /// Largest distance in steps of the format: half-ULPs, ULPs or 8-bit levels. A number
  /// and a NaN are as far apart as two numbers can be.
  std::uint32_t max_ulp = 0;
  std::optional<FirstDifference> first;
  /// The first two pictures that differ.
  Image driver;
  Image emulated;
};

/// Adds two pictures of one size and format, value by value. Values are equal when
/// their bits are; any NaN equals any other, and no zero equals one of another sign.
void add_pictures(Tally& tally, const Image& driver, const Image& emulated,
                  const std::string& where = {});

/// The driver's picture, the emulation's, and a map of what differs, side by side, as
/// RGBA16F to look at. The pictures are scaled by their largest finite magnitude if that
/// is past 1. In the map black is equal; halves are coloured as by difference_picture,
/// other formats white.
Image side_by_side(const Tally& tally);

}  // namespace softfocus
