#pragma once
// FLIP written down a second time, pixel by pixel and tap by tap in two dimensions, from
// the paper's equations: the oracle of dof/measure/flip.h. Slow.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace softfocus::flip_oracle {

using std::numbers::pi;
using Triple = std::array<double, 3>;

struct Picture {
  int width, height;
  std::vector<Triple> colours;  ///< linear, 0 to 1
  const Triple& at(int x, int y) const {
    const int cx = std::clamp(x, 0, width - 1);
    const int cy = std::clamp(y, 0, height - 1);
    return colours[static_cast<std::size_t>(cy * width + cx)];
  }
};

/// Tristimulus values over those of the white (0.950428545, 1, 1.088900371).
inline Triple relative_xyz(const Triple& c) {
  return {(0.4123866 * c[0] + 0.3575915 * c[1] + 0.1804505 * c[2]) / 0.9504286,
          0.2126368 * c[0] + 0.7151830 * c[1] + 0.0721802 * c[2],
          (0.0193306 * c[0] + 0.1191972 * c[1] + 0.9503726 * c[2]) / 1.0889004};
}

inline Triple linear_rgb(const Triple& relative) {
  const double x = relative[0] * 0.950428545;
  const double y = relative[1];
  const double z = relative[2] * 1.088900371;
  return {3.241003275 * x - 1.537398934 * y - 0.498615861 * z,
          -0.969224334 * x + 1.875930071 * y + 0.041554224 * z,
          0.055639423 * x - 0.204011202 * y + 1.057148933 * z};
}

inline Triple hunt_lab(const Triple& linear) {
  Triple f = relative_xyz(linear);
  for (double& t : f) {
    t = t > 216.0 / 24389.0 ? std::pow(t, 1.0 / 3.0) : (24389.0 / 27.0 * t + 16.0) / 116.0;
  }
  const double lightness = 116.0 * f[1] - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (f[0] - f[1]),
          0.01 * lightness * 200.0 * (f[1] - f[2])};
}

inline double distance(const Triple& a, const Triple& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

using Kernel = std::function<double(int, int)>;

/// Sum of `value` (of a pixel's relative XYZ) around a pixel, by weights; positive and
/// negative weights are each brought to a sum of 1 first.
template <class Value>
double filtered(const Picture& picture, int x, int y, int radius, const Kernel& kernel,
                const Value& value) {
  double positive = 0.0, negative = 0.0, up = 0.0, down = 0.0;
  for (int j = -radius; j <= radius; ++j) {
    for (int i = -radius; i <= radius; ++i) {
      const double weight = kernel(i, j);
      const double here = weight * value(relative_xyz(picture.at(x + i, y + j)));
      (weight > 0.0 ? positive : negative) += std::abs(weight);
      (weight > 0.0 ? up : down) += here;
    }
  }
  return up / positive + (negative > 0.0 ? down / negative : 0.0);
}

/// A pixel as the eye sees it: colour after the contrast sensitivity filters, and the magnitudes of
/// edges and points.
struct Seen {
  Triple lab;
  double edge, point;
};

inline Seen seen(const Picture& picture, int x, int y, double pixels_per_degree) {
  const int reach =
      static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * pi * pi)) * pixels_per_degree));
  const auto sensitivity = [&](double a1, double b1, double a2, double b2) -> Kernel {
    return [=](int i, int j) {
      const double d2 = (i * i + j * j) / (pixels_per_degree * pixels_per_degree);
      return a1 * std::sqrt(pi / b1) * std::exp(-pi * pi * d2 / b1) +
             a2 * std::sqrt(pi / b2) * std::exp(-pi * pi * d2 / b2);
    };
  };
  const auto luma = [](const Triple& r) { return 116.0 * r[1] - 16.0; };
  const auto red_green = [](const Triple& r) { return 500.0 * (r[0] - r[1]); };
  const auto blue_yellow = [](const Triple& r) { return 200.0 * (r[1] - r[2]); };
  const double cy = filtered(picture, x, y, reach, sensitivity(1.0, 0.0047, 0.0, 1.0), luma);
  const double cx = filtered(picture, x, y, reach, sensitivity(1.0, 0.0053, 0.0, 1.0), red_green);
  const double cz =
      filtered(picture, x, y, reach, sensitivity(34.1, 0.04, 13.5, 0.025), blue_yellow);
  const double relative_y = (cy + 16.0) / 116.0;
  Triple rgb = linear_rgb({relative_y + cx / 500.0, relative_y, relative_y - cz / 200.0});
  for (double& channel : rgb) channel = std::clamp(channel, 0.0, 1.0);

  const double sigma = 0.5 * 0.082 * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3.0 * sigma));
  const auto gauss = [=](int i, int j) {
    return std::exp(-(i * i + j * j) / (2.0 * sigma * sigma));
  };
  const auto y_only = [](const Triple& r) { return r[1]; };
  const auto feature = [&](const std::function<double(int)>& factor) {
    return std::hypot(
        filtered(
            picture, x, y, radius, [&](int i, int j) { return factor(i) * gauss(i, j); }, y_only),
        filtered(
            picture, x, y, radius, [&](int i, int j) { return factor(j) * gauss(i, j); }, y_only));
  };
  return {hunt_lab(rgb), feature([](int i) { return -static_cast<double>(i); }),
          feature([=](int i) { return i * i / (sigma * sigma) - 1.0; })};
}

inline double flip(const Picture& one, const Picture& other, int x, int y,
                   double pixels_per_degree) {
  const Seen a = seen(one, x, y, pixels_per_degree);
  const Seen b = seen(other, x, y, pixels_per_degree);
  const double largest =
      std::pow(distance(hunt_lab({0.0, 1.0, 0.0}), hunt_lab({0.0, 0.0, 1.0})), 0.7);
  const double raised = std::pow(distance(a.lab, b.lab), 0.7);
  const double colour = raised < 0.4 * largest
                            ? 0.95 / (0.4 * largest) * raised
                            : 0.95 + 0.05 * (raised - 0.4 * largest) / (0.6 * largest);
  const double feature =
      std::sqrt(std::max(std::abs(a.edge - b.edge), std::abs(a.point - b.point)) / std::sqrt(2.0));
  return std::pow(colour, 1.0 - feature);
}

}  // namespace softfocus::flip_oracle
