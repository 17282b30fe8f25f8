#pragma once
// How find_hidden() (disc_hidden.h) searches: rows and columns of strips, in vectors.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dof/disc_layers/disc_hidden.h"
#include "dof/dof.h"
#include "raster/lanes/isa.h"

namespace softfocus {

inline constexpr int kStrip = kHiddenStrip;
// Strips side by side that a task sweeps up and down.
inline constexpr int kSweptStrips = 4;

inline constexpr std::size_t kHiddenWays = 4;
inline constexpr std::uint8_t kWayLeft = 1, kWayRight = 2, kWayAbove = 4, kWayBelow = 8;

// What is known of each strip of a row.
struct HiddenStrip {
  std::uint8_t near;    // any pixel is before the focus, by more than a pixel
  std::uint8_t hidden;  // any is hidden
  std::uint8_t ways;    // a bit for each way on which any pixel has a source
  std::uint8_t split;   // its radii are known
};

// What a vector of pixels has found in the second round.
struct HiddenTexels {
  int x, y;
  unsigned bits;  // of pixels x, x + 1, ...: whether they have found anything
  std::uint16_t texels[4 * kStrip];
};

struct HiddenSearch {
  DofSettings settings;
  int width, height;
  int strips;               // of a row
  float most;               // the longest way
  std::uint32_t first_far;  // the depth, a half, from which on nothing is near
  bool second;              // round: sources are hidden pixels, and `from` is the hidden picture
  ConstImageView from;      // where sources lie
  ConstImageView scene;
  HiddenStrip* known;  // row by row
  float* radii;        // row by row, of near strips and those beside them; ends repeat outwards
  // The distance to the source above and below, where HiddenStrip::ways says so; and of what is
  // hidden to its own source.
  std::uint16_t *above, *below, *own;
  std::ptrdiff_t stride;  // of all these

  HiddenStrip* known_row(int y) const { return known + std::ptrdiff_t{y} * strips; }
  float* radii_row(int y) const { return radii + y * stride; }
};

/// The depth, a half, from which on nothing lies more than a pixel before the focus. A radius never
/// falls as the depth grows: each of its three operations keeps the order, rounding included.
std::uint32_t first_far_half(const DofSettings& settings);

/// Finds a row's near strips, and their radii and those of strips beside them.
void split_row(const HiddenSearch& search, int y, Isa isa);

/// Finds the distances of strips `first` to `end` to sources above and below.
void sweep_columns(const HiddenSearch& search, int first, int end, Isa isa);

/// The distances of a row's pixels to sources left and right, in strips that are near. Returns
/// whether any pixel has a source, above and below too.
bool sweep_along(const HiddenSearch& search, int y, std::int32_t* left, std::int32_t* right,
                 Isa isa);

/// Hides what a row's pixels have found.
void hide_row(const HiddenSearch& search, int y, const std::int32_t* left,
              const std::int32_t* right, const ImageView& made, HiddenPicture& hidden, Isa isa);

/// Lists what a row's pixels have found.
void find_in_row(const HiddenSearch& search, int y, const std::int32_t* left,
                 const std::int32_t* right, std::vector<HiddenTexels>& list, Isa isa);

}  // namespace softfocus
