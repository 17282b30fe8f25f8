#include "tools/stress/cases/stress_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dof/measure/flicker.h"
#include "dof/measure/flip.h"
#include "dof/measure/point_image.h"
#include "raster/images/texel.h"

namespace softfocus {

double disc_left_of(double x) {
  if (x <= -1.0) return 0.0;
  if (x >= 1.0) return 1.0;
  return 0.5 + (x * std::sqrt(1.0 - x * x) + std::asin(x)) / std::numbers::pi;
}

double light_at(const Image& picture, int x, int y) {
  const glm::vec4 texel = load_texel<Format::rgba16f>(picture, x, y);
  return luminance(texel.x, texel.y, texel.z);
}

std::vector<double> column_means(const Image& picture, PixelRange rows) {
  std::vector<double> means(static_cast<std::size_t>(picture.width));
  for (int y = rows.begin; y < rows.end; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      means[static_cast<std::size_t>(x)] += light_at(picture, x, y);
    }
  }
  for (double& mean : means) mean /= rows.end - rows.begin;
  return means;
}

double rms_difference(std::span<const double> a, std::span<const double> b, PixelRange range) {
  double sum = 0.0;
  for (int i = range.begin; i < range.end; ++i) {
    const double difference = a[static_cast<std::size_t>(i)] - b[static_cast<std::size_t>(i)];
    sum += difference * difference;
  }
  return std::sqrt(sum / (range.end - range.begin));
}

double largest_difference(std::span<const double> a, std::span<const double> b, PixelRange range) {
  double largest = 0.0;
  for (int i = range.begin; i < range.end; ++i) {
    const double difference =
        std::fabs(a[static_cast<std::size_t>(i)] - b[static_cast<std::size_t>(i)]);
    if (std::isnan(difference)) return difference;
    largest = std::max(largest, difference);
  }
  return largest;
}

std::vector<double> wave_amplitudes(const Image& picture, double period_px, PixelRange columns) {
  const double per_pixel = 2.0 * std::numbers::pi / period_px;
  std::vector<double> amplitudes;
  for (int y = 0; y < picture.height; ++y) {
    double sum = 0.0;
    for (int x = columns.begin; x < columns.end; ++x) {
      sum += light_at(picture, x, y) * std::cos(per_pixel * (x + 0.5));
    }
    amplitudes.push_back(2.0 * sum / (columns.end - columns.begin));
  }
  return amplitudes;
}

double unevenness(const Image& picture, double centre_x_px, double centre_y_px, double radius_px) {
  std::vector<double> inside;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (disc_coverage(x, y, centre_x_px, centre_y_px, radius_px) < 1.0) continue;
      inside.push_back(light_at(picture, x, y));
    }
  }
  constexpr std::size_t kFewest = 5;
  if (inside.size() < kFewest) return 0.0;
  double sum = 0.0, squares = 0.0;
  for (const double light : inside) sum += light;
  const double mean = sum / static_cast<double>(inside.size());
  for (const double light : inside) squares += (light - mean) * (light - mean);
  return std::sqrt(squares / static_cast<double>(inside.size())) / mean;
}

int spoilt_pixels(const Image& picture) {
  int spoilt = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      spoilt += std::isfinite(light_at(picture, x, y)) ? 0 : 1;
    }
  }
  return spoilt;
}

double answer_flip(const Image& truth, const Image& result, ThreadPool& pool) {
  // FLIP takes NaN for black.
  if (spoilt_pixels(result) > 0) return std::numeric_limits<double>::infinity();
  return mean_flip(truth, result, pool);
}

double answer_hdr_flip(const Image& truth, const Image& result, ThreadPool& pool) {
  if (spoilt_pixels(result) > 0) return std::numeric_limits<double>::infinity();
  return mean(hdr_flip_map(truth, result, pool));
}

double false_change(std::span<const Image> truth, std::span<const Image> result) {
  for (const Image& picture : result) {
    if (spoilt_pixels(picture) > 0) return std::numeric_limits<double>::infinity();
  }
  const ToneTable tone = srgb_encoded(clamped_tone());
  // A still picture's false change is all of the true one.
  const double change = flicker({truth[0], truth[0], truth[0], truth[1]}, tone);
  return flicker({result[0], result[1], truth[0], truth[1]}, tone) / change;
}

double disc_light(int x, int y, double centre_x_px, double centre_y_px, double radius_px) {
  return disc_coverage(x, y, centre_x_px, centre_y_px, radius_px) /
         (std::numbers::pi * radius_px * radius_px);
}

double square_light(int x, int y, int left, int top, int side, double radius_px) {
  double light = 0.0;
  for (int v = top; v < top + side; ++v) {
    for (int u = left; u < left + side; ++u) {
      light += disc_light(x, y, u + 0.5, v + 0.5, radius_px);
    }
  }
  return light;
}

}  // namespace softfocus
