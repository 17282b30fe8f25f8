#pragma once
// Curves that a picture's light goes through before it is measured: clamped or a film's, and
// perhaps encoded for a screen. A half has 65,536 values, so every curve is a table.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace softfocus {

/// For each half, by its bits, a value of 0 to 1. Infinity counts as the largest half;
/// NaN and what is below 0 count as 0.
using ToneTable = std::vector<double>;

/// The light of a half, 0 to 65504, as a table's curve gets it.
double half_light(std::uint16_t half);

inline double toned(const ToneTable& table, std::uint16_t half) { return table[half]; }

/// Light clamped to 1, as a PNG of this program keeps it.
ToneTable clamped_tone();

/// Light times 2^`exposure_stops` through Narkowicz's fit of the ACES film curve (2016),
/// with the exposure of 0.6 that the fit has built in taken out again, as HDR-FLIP has it
/// (Andersson, Nilsson, Shirley, Akenine-Moller 2021):
///
///   x' = 0.6 x;  (x' (2.51 x' + 0.03)) / (x' (2.43 x' + 0.59) + 0.14), clamped to 0..1
ToneTable filmic_tone(double exposure_stops = 0.0);

/// The light, not clamped, that filmic_tone(0) takes to `value`, 0 < value < 1: the
/// positive root of the quadratic.
double filmic_inverse(double value);

/// The table followed by the sRGB curve (IEC 61966-2-1), on which equal steps look about equal.
ToneTable srgb_encoded(ToneTable table);

/// Luminance of linear light and, on encoded values, the luma that stands for it (BT.709).
inline double luminance(double red, double green, double blue) {
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

}  // namespace softfocus
