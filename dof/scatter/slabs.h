#pragma once
// The slabs of depth that scatter-sorted and scatter-aperture lay over each other (scatter.h).

#include <algorithm>
#include <array>
#include <cmath>

namespace softfocus {

/// The radii at which slabs begin on either side of the one in focus.
inline constexpr std::array kSlabBegins{0.5f,  1.5f,  3.0f,   6.0f,   12.0f, 24.0f,
                                        48.0f, 96.0f, 192.0f, 384.0f, 768.0f};
inline constexpr int kSlabs = 2 * static_cast<int>(kSlabBegins.size()) + 1;

/// The slab's number, the nearest first.
inline int slab_of(float radius_px) {
  const float magnitude = std::fabs(radius_px);
  int steps = 0;
  for (const float begin : kSlabBegins) steps += magnitude > begin ? 1 : 0;
  const int focus = static_cast<int>(kSlabBegins.size());
  return radius_px < 0.0f ? focus - steps : focus + steps;
}

/// The colour of slabs that are added one by one, the nearest first.
struct Over {
  double transmitted = 1.0;
  double previous = 0.0;  ///< a' of the slab before
  double r = 0.0, g = 0.0, b = 0.0, opacity = 0.0;
};

/// Adds a slab's red, green, blue and weight, in some unit of light: 1 / `units`.
inline void add_slab(Over& over, const std::array<double, 4>& light, double units) {
  const double weight = light[3];
  const double opacity = std::min(weight * units, 1.0);
  const double room = 1.0 - over.previous;
  const double alone = opacity < room ? opacity / room : 1.0;
  const double share = over.transmitted * alone;
  const double scale = share / weight;
  over.r += light[0] * scale;
  over.g += light[1] * scale;
  over.b += light[2] * scale;
  over.opacity += share;
  over.transmitted *= 1.0 - alone;
  over.previous = alone;
}

struct SlabColour {
  float r, g, b;
};
inline SlabColour resolve(const Over& over) {
  return {static_cast<float>(over.r / over.opacity), static_cast<float>(over.g / over.opacity),
          static_cast<float>(over.b / over.opacity)};
}

}  // namespace softfocus
