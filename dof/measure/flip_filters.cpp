#include "dof/measure/flip_filters.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace softfocus {
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

}  // namespace softfocus
