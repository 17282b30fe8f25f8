#include "dof/measure/flip.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

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

namespace {

using std::numbers::pi;

struct Sensitivity {
  double a;
  double b;
};
constexpr Sensitivity kAchromatic{1.0, 0.0047};
constexpr Sensitivity kRedGreen{1.0, 0.0053};
constexpr Sensitivity kBlueYellowWide{34.1, 0.04};
constexpr Sensitivity kBlueYellowNarrow{13.5, 0.025};

// In degrees: the distance between the peak and the trough of an edge detector, twice its
// standard deviation.
constexpr double kDetectorWidth = 0.082;

/// exp(-pi^2 d^2 / b) is a Gaussian of this standard deviation, in degrees.
double deviation(const Sensitivity& of) { return std::sqrt(of.b / (2.0 * pi * pi)); }

/// Sum over a square of the term before anything is normalised.
double volume(const Sensitivity& of, int radius, double pixels_per_degree) {
  double sum = 0.0;
  for (int x = -radius; x <= radius; ++x) {
    const double d = x / pixels_per_degree;
    sum += std::exp(-pi * pi * d * d / of.b);
  }
  return of.a * std::sqrt(pi / of.b) * sum * sum;
}

void normalise_signs(FilterTaps& taps) {
  double positive = 0.0;
  double negative = 0.0;
  for (const double weight : taps.weights) (weight > 0.0 ? positive : negative) += weight;
  for (double& weight : taps.weights) weight /= weight > 0.0 ? positive : -negative;
}

}  // namespace

FlipFilters flip_filters(double pixels_per_degree) {
  assert(pixels_per_degree > 0.0);
  FlipFilters filters;
  // The widest filter sets the reach of all four.
  const int reach =
      static_cast<int>(std::ceil(3.0 * deviation(kBlueYellowWide) * pixels_per_degree));
  const auto seen_by = [&](const Sensitivity& of) {
    return gaussian_taps(deviation(of) * pixels_per_degree, reach);
  };
  filters.achromatic = seen_by(kAchromatic);
  filters.red_green = seen_by(kRedGreen);
  filters.blue_yellow_wide = seen_by(kBlueYellowWide);
  filters.blue_yellow_narrow = seen_by(kBlueYellowNarrow);
  const double wide = volume(kBlueYellowWide, reach, pixels_per_degree);
  filters.wide_share = wide / (wide + volume(kBlueYellowNarrow, reach, pixels_per_degree));

  const double sigma = 0.5 * kDetectorWidth * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  filters.smooth = gaussian_taps(sigma, radius);
  for (int x = -radius; x <= radius; ++x) {
    const double g = filters.smooth.weights[static_cast<std::size_t>(x + radius)];
    filters.edge.weights.push_back(-x * g);
    filters.point.weights.push_back((x * x / (sigma * sigma) - 1.0) * g);
  }
  normalise_signs(filters.edge);
  normalise_signs(filters.point);
  filters.margin = std::max(reach, radius);
  return filters;
}

namespace {

constexpr double kShownAs = 0.85;
constexpr double kLeastMedian = 0x1p-14;

std::vector<double> luminances(const Image& image) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    const auto texels = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < texels.size(); i += 4) {
      values.push_back(
          luminance(half_light(texels[i]), half_light(texels[i + 1]), half_light(texels[i + 2])));
    }
  }
  return values;
}

/// The middle value; of an even number the mean of the two.
double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const double upper = *middle;
  return values.size() % 2 == 1 ? upper : 0.5 * (upper + *std::max_element(values.begin(), middle));
}

}  // namespace

ExposureRange exposure_range(const Image& reference) {
  assert(reference.format == Format::rgba16f);
  std::vector<double> values = luminances(reference);
  const double largest = *std::max_element(values.begin(), values.end());
  if (largest == 0.0) return {};
  const double bright = filmic_inverse(kShownAs);
  ExposureRange range;
  range.first_stops = std::log2(bright / largest);
  range.last_stops = std::log2(bright / std::max(median(values), kLeastMedian));
  // A picture darker than the least median.
  range.last_stops = std::max(range.first_stops, range.last_stops);
  range.count = std::max(2, static_cast<int>(std::ceil(range.last_stops - range.first_stops)));
  return range;
}

PixelMap hdr_flip_map(const Image& reference, const Image& test, ThreadPool& pool,
                      double pixels_per_degree) {
  const ExposureRange range = exposure_range(reference);
  const double step = (range.last_stops - range.first_stops) / std::max(range.count - 1, 1);
  PixelMap largest = make_pixel_map(reference.width, reference.height);
  for (int i = 0; i < range.count; ++i) {
    const PixelMap map = flip_map(reference, test, filmic_tone(range.first_stops + i * step), pool,
                                  pixels_per_degree);
    for (std::size_t k = 0; k < largest.values.size(); ++k) {
      largest.values[k] = std::max(largest.values[k], map.values[k]);
    }
  }
  return largest;
}

}  // namespace softfocus
