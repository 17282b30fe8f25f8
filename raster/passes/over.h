#pragma once
// Transparent pictures laid over one another (Porter and Duff 1984), row by row.

#include <cstdint>

#include "raster/lanes/isa.h"
#include "raster/numbers/half.h"

namespace softfocus {

/// A row of something transparent, RGBA16F: in `colour` its colour times its opacity, in `opacity`
/// how much of red, green and blue behind it it hides. What is below 0, or NaN, hides nothing, what
/// is above 1 everything.
struct OverRow {
  const std::uint16_t* colour;
  const std::uint16_t* opacity;
  int width;
};

/// Lays a row over `below`, RGBA16F: red, green and blue become
///
///   colour + (1 - opacity) below
///
/// in binary32, each operation rounded, and then to halves. Where colour and opacity are 0 `below`
/// keeps its bits. Its alpha stays.
void lay_over(const OverRow& row, HalfRounding rounding, std::uint16_t* below, Isa isa);

/// Puts the alpha of `opacity` into that of `below` where red, as opacity, is 1/2 or more: the
/// depth of what one sees most of.
void take_depths(const std::uint16_t* opacity, int width, std::uint16_t* below, Isa isa);

}  // namespace softfocus
