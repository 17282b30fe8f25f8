#pragma once
// The shape of the lens's opening, and so of every point that is out of focus.

#include <string_view>

namespace softfocus {

inline constexpr int kMostApertureBlades = 64;
inline constexpr float kMostApertureStretch = 16.0f;

/// The method that has other apertures than round ones (scatter/aperture_scatter.h).
inline constexpr std::string_view kApertureMethod = "scatter-aperture";

/// Within the circle of confusion, which it touches. Things nearer than the focus show it upside
/// down.
struct Aperture {
  int blades = 0;             ///< corners of a regular polygon, 3 to kMostApertureBlades; 0: round
  float turn_degrees = 0.0f;  ///< counter-clockwise; without it a corner is up
  /// Height over width, 1/16 to 16: above 1 the width shrinks (an anamorphic lens), below 1 the
  /// height.
  float stretch = 1.0f;
  bool operator==(const Aperture&) const = default;
};

/// What is wrong with it, as a sentence, or nullptr.
const char* aperture_error(const Aperture& aperture);

}  // namespace softfocus
