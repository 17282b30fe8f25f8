#include "dof/measure/flip.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "dof/measure/flip_filters.h"
#include "dof/measure/opponent.h"

namespace softfocus {
namespace {

constexpr double kColourPower = 0.7;
constexpr double kFeaturePower = 0.5;
constexpr double kKnee = 0.4;         // of the largest colour difference ...
constexpr double kKneeHeight = 0.95;  // ... takes up this part of 0..1

/// A strip with its margins in opponent colours.
struct OpponentStrip {
  PixelMap y, cx, cz;
};

OpponentStrip opponent_strip(const Image& image, const ToneTable& tone, const RowStrip& strip) {
  OpponentStrip maps{strip_map(image.width, strip), strip_map(image.width, strip),
                     strip_map(image.width, strip)};
  for (int y = 0; y < maps.y.height; ++y) {
    const auto texels = row<std::uint16_t>(image, picture_row(strip, y, image.height));
    const auto to_y = between_margins(maps.y, strip, y);
    const auto to_cx = between_margins(maps.cx, strip, y);
    const auto to_cz = between_margins(maps.cz, strip, y);
    for (std::size_t x = 0; x < to_y.size(); ++x) {
      const OpponentColour colour =
          to_opponent({toned(tone, texels[4 * x]), toned(tone, texels[4 * x + 1]),
                       toned(tone, texels[4 * x + 2])});
      to_y[x] = colour.y;
      to_cx[x] = colour.cx;
      to_cz[x] = colour.cz;
    }
  }
  for (PixelMap* map : {&maps.y, &maps.cx, &maps.cz}) fill_margins(*map, strip);
  return maps;
}

PixelMap filtered(const PixelMap& map, const RowStrip& strip, const FilterTaps& taps) {
  return filtered_down(filtered_along(map, strip, taps), strip, taps);
}

/// Length of the vector of two derivatives.
PixelMap magnitude(const PixelMap& along, const PixelMap& down) {
  PixelMap result = make_pixel_map(along.width, along.height);
  for (std::size_t i = 0; i < result.values.size(); ++i) {
    const double x = along.values[i];
    const double y = down.values[i];
    result.values[i] = std::sqrt(x * x + y * y);
  }
  return result;
}

/// What the eye makes of a strip.
struct SeenStrip {
  PixelMap y, cx, cz_wide, cz_narrow;  ///< blurred
  PixelMap edges, points;
};

SeenStrip seen_strip(const Image& image, const ToneTable& tone, const RowStrip& strip,
                     const FlipFilters& filters) {
  OpponentStrip maps = opponent_strip(image, tone, strip);
  SeenStrip seen;
  seen.y = filtered(maps.y, strip, filters.achromatic);
  seen.cx = filtered(maps.cx, strip, filters.red_green);
  seen.cz_wide = filtered(maps.cz, strip, filters.blue_yellow_wide);
  seen.cz_narrow = filtered(maps.cz, strip, filters.blue_yellow_narrow);
  // Features are those of luminance in 0..1.
  for (double& y : maps.y.values) y = (y + 16.0) / 116.0;
  const PixelMap smooth = filtered_along(maps.y, strip, filters.smooth);
  const auto feature = [&](const FilterTaps& derivative) {
    return magnitude(
        filtered_down(filtered_along(maps.y, strip, derivative), strip, filters.smooth),
        filtered_down(smooth, strip, derivative));
  };
  seen.edges = feature(filters.edge);
  seen.points = feature(filters.point);
  return seen;
}

HuntLab seen_colour(const SeenStrip& seen, std::size_t i, double wide_share) {
  const double cz =
      wide_share * seen.cz_wide.values[i] + (1.0 - wide_share) * seen.cz_narrow.values[i];
  const LinearColour colour = to_linear({seen.y.values[i], seen.cx.values[i], cz});
  return to_hunt_lab({std::clamp(colour.red, 0.0, 1.0), std::clamp(colour.green, 0.0, 1.0),
                      std::clamp(colour.blue, 0.0, 1.0)});
}

/// Spreads a distance over 0..1. `largest` is the largest distance to the power of 0.7.
double colour_difference(double distance, double largest) {
  const double raised = std::pow(distance, kColourPower);
  const double knee = kKnee * largest;
  return raised < knee ? raised * kKneeHeight / knee
                       : kKneeHeight + (raised - knee) / (largest - knee) * (1.0 - kKneeHeight);
}

double feature_difference(const SeenStrip& one, const SeenStrip& other, std::size_t i) {
  const double edge = std::fabs(one.edges.values[i] - other.edges.values[i]);
  const double point = std::fabs(one.points.values[i] - other.points.values[i]);
  return std::pow(std::max(edge, point) / std::numbers::sqrt2, kFeaturePower);
}

}  // namespace

PixelMap flip_map(const Image& reference, const Image& test, const ToneTable& tone,
                  ThreadPool& pool, double pixels_per_degree) {
  assert(reference.format == Format::rgba16f && test.format == Format::rgba16f);
  assert(reference.width == test.width && reference.height == test.height);
  const FlipFilters filters = flip_filters(pixels_per_degree);
  const double largest =
      std::pow(hyab(to_hunt_lab({0.0, 1.0, 0.0}), to_hunt_lab({0.0, 0.0, 1.0})), kColourPower);
  PixelMap map = make_pixel_map(reference.width, reference.height);
  for_each_strip(reference.height, filters.margin, pool, [&](const RowStrip& strip) {
    const SeenStrip one = seen_strip(reference, tone, strip, filters);
    const SeenStrip other = seen_strip(test, tone, strip, filters);
    const auto start =
        static_cast<std::size_t>(strip.first_row) * static_cast<std::size_t>(reference.width);
    for (std::size_t i = 0; i < one.y.values.size(); ++i) {
      const double distance =
          hyab(seen_colour(one, i, filters.wide_share), seen_colour(other, i, filters.wide_share));
      map.values[start + i] =
          std::pow(colour_difference(distance, largest), 1.0 - feature_difference(one, other, i));
    }
  });
  return map;
}

double mean_flip(const Image& reference, const Image& test, ThreadPool& pool) {
  return mean(flip_map(reference, test, clamped_tone(), pool));
}

}  // namespace softfocus
