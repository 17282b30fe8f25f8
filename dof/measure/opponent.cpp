#include "dof/measure/opponent.h"

#include <array>
#include <cmath>

namespace softfocus {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

// BT.709 primaries and D65 to tristimulus values, as exact quotients of the chromaticities
// (0.64, 0.33), (0.30, 0.60), (0.15, 0.06) and (0.3127, 0.3290).
constexpr Matrix kToXyz{{{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                         {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                         {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}}};

/// Each row divided by its sum, which is the white's value.
constexpr Matrix relative_to_white(Matrix matrix) {
  for (auto& line : matrix) {
    const double white = line[0] + line[1] + line[2];
    for (double& value : line) value /= white;
  }
  return matrix;
}

constexpr Matrix inverse(const Matrix& m) {
  Matrix result{};
  double determinant = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      // Indices taken in a circle give the cofactor's sign.
      const std::size_t r1 = (i + 1) % 3, r2 = (i + 2) % 3, c1 = (j + 1) % 3, c2 = (j + 2) % 3;
      result[j][i] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
      if (i == 0) determinant += m[0][j] * result[j][0];
    }
  }
  for (auto& line : result) {
    for (double& value : line) value /= determinant;
  }
  return result;
}

constexpr Matrix kToRelative = relative_to_white(kToXyz);
constexpr Matrix kFromRelative = inverse(kToRelative);

constexpr double along(const std::array<double, 3>& line, double a, double b, double c) {
  return line[0] * a + line[1] * b + line[2] * c;
}

/// CIE 15: the cube root, and below (6/29)^3 the straight line that goes on from it.
double lightness_curve(double value) {
  constexpr double kDelta = 6.0 / 29.0;
  return value > kDelta * kDelta * kDelta ? std::cbrt(value)
                                          : value / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
}

}  // namespace

OpponentColour to_opponent(const LinearColour& colour) {
  const auto [r, g, b] = colour;
  const double x = along(kToRelative[0], r, g, b);
  const double y = along(kToRelative[1], r, g, b);
  const double z = along(kToRelative[2], r, g, b);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

LinearColour to_linear(const OpponentColour& colour) {
  const double y = (colour.y + 16.0) / 116.0;
  const double x = y + colour.cx / 500.0;
  const double z = y - colour.cz / 200.0;
  return {along(kFromRelative[0], x, y, z), along(kFromRelative[1], x, y, z),
          along(kFromRelative[2], x, y, z)};
}

HuntLab to_hunt_lab(const LinearColour& colour) {
  const auto [r, g, b] = colour;
  const double x = lightness_curve(along(kToRelative[0], r, g, b));
  const double y = lightness_curve(along(kToRelative[1], r, g, b));
  const double z = lightness_curve(along(kToRelative[2], r, g, b));
  const double l = 116.0 * y - 16.0;
  return {l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)};
}

double hyab(const HuntLab& one, const HuntLab& other) {
  const double a = one.a - other.a;
  const double b = one.b - other.b;
  return std::fabs(one.l - other.l) + std::sqrt(a * a + b * b);
}

}  // namespace softfocus
