// How far bloom's pyramid is from a convolution, and how much it flickers: the figures of
// docs/effects/bloom.md.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "raster/effects/bloom.h"
#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

/// One channel in binary64.
struct GreyPlane {
  int size;  ///< of both sides
  std::vector<double> values;
  explicit GreyPlane(int side) : size(side), values(static_cast<std::size_t>(side * side)) {}
  double& at(int x, int y) { return values[static_cast<std::size_t>(y * size + x)]; }
  double clamped(int x, int y) const {
    const int i = std::clamp(x, 0, size - 1), j = std::clamp(y, 0, size - 1);
    return values[static_cast<std::size_t>(j * size + i)];
  }
};

/// Five means of 4x4 pixels, the middle one counting half.
GreyPlane halved_plane(const GreyPlane& from) {
  GreyPlane half{(from.size + 1) / 2};
  for (int y = 0; y < half.size; ++y) {
    for (int x = 0; x < half.size; ++x) {
      const auto mean = [&](int left, int top) {
        double sum = 0.0;
        for (int j = 0; j < 4; ++j) {
          for (int i = 0; i < 4; ++i) sum += from.clamped(left + i, top + j);
        }
        return sum / 16.0;
      };
      const int left = 2 * x - 2, top = 2 * y - 2;
      half.at(x, y) =
          0.5 * mean(left + 1, top + 1) + 0.125 * (mean(left, top) + mean(left + 2, top) +
                                                   mean(left, top + 2) + mean(left + 2, top + 2));
    }
  }
  return half;
}

/// A tent, 1 2 1 in each direction, of bilinear samples.
GreyPlane doubled_plane(const GreyPlane& from, int size) {
  GreyPlane wide{size};
  const auto weight = [](double distance) {
    // The tent of samples one pixel apart, convolved with the sample's own tent.
    double sum = 0.0;
    for (int i = -1; i <= 1; ++i) {
      sum += (2 - std::abs(i)) / 4.0 * std::max(0.0, 1.0 - std::abs(distance - i));
    }
    return sum;
  };
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double u = (x + 0.5) / 2 - 0.5, v = (y + 0.5) / 2 - 0.5;
      for (int j = -2; j <= 3; ++j) {
        for (int i = -2; i <= 3; ++i) {
          const int column = static_cast<int>(std::floor(u)) + i;
          const int line = static_cast<int>(std::floor(v)) + j;
          wide.at(x, y) += weight(u - column) * weight(v - line) * from.clamped(column, line);
        }
      }
    }
  }
  return wide;
}

GreyPlane scattered_plane(const GreyPlane& light, int levels, double spread) {
  std::vector<GreyPlane> planes{light};
  for (int i = 0; i < levels; ++i) planes.push_back(halved_plane(planes.back()));
  for (std::size_t i = planes.size() - 1; i-- > 0;) {
    const GreyPlane wide = doubled_plane(planes[i + 1], planes[i].size);
    const double share = i == 0 ? 1.0 : spread;
    for (std::size_t k = 0; k < wide.values.size(); ++k) {
      planes[i].values[k] += share * (wide.values[k] - planes[i].values[k]);
    }
  }
  return planes[0];
}

/// The sum of the pyramid's kernels: what becomes of a point, in the mean of all its places among
/// the pixels of the widest level.
GreyPlane sum_of_kernels(int levels, double spread) {
  const int period = 1 << levels, reach = 8 * period, size = 2 * reach + period;
  GreyPlane kernel{2 * reach + 1};
  for (int phase_y = 0; phase_y < period; ++phase_y) {
    for (int phase_x = 0; phase_x < period; ++phase_x) {
      GreyPlane point{size};
      point.at(reach + phase_x, reach + phase_y) = 1.0;
      const GreyPlane seen = scattered_plane(point, levels, spread);
      for (int y = 0; y < kernel.size; ++y) {
        for (int x = 0; x < kernel.size; ++x) {
          kernel.at(x, y) += seen.clamped(x + phase_x, y + phase_y) / (period * period);
        }
      }
    }
  }
  return kernel;
}

constexpr int kSize = 128;

/// Lamps of one to nine pixels away from the edges.
Image lamps() {
  Image picture = make_image(Format::rgba16f, kSize, kSize);
  RandomSequence random{20};
  for (int i = 0; i < 12; ++i) {
    const int x = 40 + static_cast<int>(next_between(random, 0.0, 48.0));
    const int y = 40 + static_cast<int>(next_between(random, 0.0, 48.0));
    const int side = 1 + i % 3;
    const auto light = static_cast<float>(next_between(random, 4.0, 100.0));
    for (int k = 0; k < side * side; ++k) {
      store_texel(picture, x + k % side, y + k / side, glm::vec4{light, light, light, 1.0f}, {});
    }
  }
  return picture;
}

/// Red of what bloom scatters: with a strength of 1 the picture is the scattered light, less its
/// dark part.
Image scattered_by(const BloomSettings& settings, const Image& picture) {
  ThreadPool pool{1};
  Image result = make_image(Format::rgba16f, picture.width, picture.height);
  bloom(settings, picture, result, {}, pool);
  return result;
}

/// A lamp at (x, y), of one width of pixels across: the part of each pixel that it covers, or the
/// whole pixel if it covers the middle.
Image lamp_at(double x, double y, bool smooth) {
  constexpr double kRadius = 0.8;
  constexpr int kSamples = 16;
  Image picture = make_image(Format::rgba16f, kSize, kSize);
  for (int j = 60; j < 70; ++j) {
    for (int i = 60; i < 70; ++i) {
      double covered = 0.0;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const int column = k % kSamples, row = k / kSamples;
        const double u = i + (smooth ? (column + 0.5) / kSamples : 0.5) - x;
        const double v = j + (smooth ? (row + 0.5) / kSamples : 0.5) - y;
        covered += u * u + v * v < kRadius * kRadius ? 1.0 / (kSamples * kSamples) : 0.0;
      }
      const auto light = static_cast<float>(50.0 * covered);
      store_texel(picture, i, j, glm::vec4{light, light, light, 1.0f}, {});
    }
  }
  return picture;
}

/// Flicker of the light that a moving lamp scatters farther than 4 pixels.
struct Flicker {
  double range;  ///< most - least
  double mean;
};

Flicker flicker(bool smooth, bool is_steady) {
  constexpr int kSteps = 32;
  double least = 1e9, most = 0.0, mean = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    const double x = 64.0 + 2.0 * step / kSteps, y = 64.0 + 0.7 * step / kSteps;
    const Image result = scattered_by(
        {.threshold = 0.0f, .knee = 0.0f, .strength = 1.0f, .levels = 4, .is_steady = is_steady},
        lamp_at(x, y, smooth));
    double sum = 0.0;
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) {
        if (std::hypot(i + 0.5 - x, j + 0.5 - y) < 4.0) continue;
        sum += static_cast<double>(load_texel(result, i, j).x);
      }
    }
    least = std::min(least, sum);
    most = std::max(most, sum);
    mean += sum / kSteps;
  }
  return {most - least, mean};
}

}  // namespace

TEST_CASE("bloom is near a convolution with the sum of its kernels" * doctest::test_suite("long")) {
  const Image picture = lamps();
  for (const int levels : {1, 2, 3, 4}) {
    CAPTURE(levels);
    const GreyPlane kernel = sum_of_kernels(levels, 0.6);
    double whole = 0.0;
    for (const double weight : kernel.values) whole += weight;
    CHECK(whole == doctest::Approx(1.0));
    GreyPlane truth{kSize};
    const int reach = kernel.size / 2;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const auto light = static_cast<double>(load_texel(picture, x, y).x);
        if (light == 0.0) continue;
        for (int j = std::max(y - reach, 0); j <= std::min(y + reach, kSize - 1); ++j) {
          for (int i = std::max(x - reach, 0); i <= std::min(x + reach, kSize - 1); ++i) {
            truth.at(i, j) += light * kernel.clamped(i - x + reach, j - y + reach);
          }
        }
      }
    }
    const Image result = scattered_by(
        {.threshold = 0.0f, .knee = 0.0f, .strength = 1.0f, .levels = levels}, picture);
    double squares = 0.0, of_truth = 0.0, sum = 0.0, sum_of_truth = 0.0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const auto found = static_cast<double>(load_texel(result, x, y).x);
        squares += std::pow(found - truth.at(x, y), 2);
        of_truth += truth.at(x, y) * truth.at(x, y);
        sum += found;
        sum_of_truth += truth.at(x, y);
      }
    }
    const double error = std::sqrt(squares / of_truth);
    CHECK(error < 0.025);
    CHECK(error > 0.0);
    CHECK(sum / sum_of_truth == doctest::Approx(1.0).epsilon(0.003));
  }
}

TEST_CASE("a lamp that moves by parts of a pixel flickers little in bloom if it is smooth") {
  const Flicker smooth = flicker(true, false), hard = flicker(false, false);
  CHECK(smooth.range < 0.07 * smooth.mean);
  CHECK(hard.range > smooth.mean);  // it goes from one pixel to three
}

TEST_CASE("a steady bloom flickers less, and by more of what light is left") {
  for (const bool smooth : {true, false}) {
    const Flicker usual = flicker(smooth, false), steady = flicker(smooth, true);
    CAPTURE(usual.range);
    CAPTURE(usual.mean);
    CAPTURE(steady.range);
    CAPTURE(steady.mean);
    CHECK(steady.mean < 0.2 * usual.mean);
    CHECK(steady.range < usual.range);
    CHECK(steady.range / steady.mean > usual.range / usual.mean);
  }
}
