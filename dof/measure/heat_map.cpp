#include "dof/measure/heat_map.h"

#include <algorithm>
#include <cmath>

#include "raster/images/texel.h"

namespace softfocus {
namespace {

using Colour = std::array<double, 3>;

// In equal steps from 0 to 1. Our own, after the manner of the map that FLIP's authors use:
// about even steps of lightness.
constexpr std::array<Colour, 9> kHeatStops{{{0.00, 0.00, 0.00},
                                            {0.09, 0.06, 0.25},
                                            {0.27, 0.07, 0.43},
                                            {0.46, 0.13, 0.50},
                                            {0.66, 0.20, 0.48},
                                            {0.85, 0.29, 0.40},
                                            {0.96, 0.48, 0.36},
                                            {0.99, 0.72, 0.48},
                                            {0.99, 0.97, 0.75}}};

double to_linear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace

Colour heat_colour(double value) {
  const double place = value > 0.0 ? std::min(value, 1.0) * (kHeatStops.size() - 1) : 0.0;
  const auto stop = std::min(static_cast<std::size_t>(place), kHeatStops.size() - 2);
  const double t = place - static_cast<double>(stop);
  Colour colour{};
  for (std::size_t i = 0; i < 3; ++i) {
    colour[i] = kHeatStops[stop][i] + (kHeatStops[stop + 1][i] - kHeatStops[stop][i]) * t;
  }
  return colour;
}

Image heat_picture(const PixelMap& map) {
  Image picture = make_image(Format::rgba16f, map.width, map.height);
  for (int y = 0; y < map.height; ++y) {
    const auto values = row(map, y);
    for (int x = 0; x < map.width; ++x) {
      const Colour colour = heat_colour(values[static_cast<std::size_t>(x)]);
      const auto light = [&](std::size_t i) { return static_cast<float>(to_linear(colour[i])); };
      store_texel<Format::rgba16f>(picture, x, y, {light(0), light(1), light(2), 1.0f}, {});
    }
  }
  return picture;
}

}  // namespace softfocus
