#include "dof/methods/post_process.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

double sat(double v) { return std::clamp(v, 0.0, 1.0); }
double mix(double a, double b, double share) { return a + share * (b - a); }

// A picture of quarter size whose edges repeat.
struct Quarter {
  int width, height;
  std::vector<double> values;

  double at(int x, int y) const {
    return values[static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width +
                                           std::clamp(x, 0, width - 1))];
  }
};

Quarter convolved(const Quarter& source, const std::vector<double>& weights) {
  const int reach = static_cast<int>(weights.size() / 2);
  Quarter result{source.width, source.height, {}};
  for (int y = 0; y < source.height; ++y) {
    for (int x = 0; x < source.width; ++x) {
      double sum = 0.0;
      for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          sum += weights[static_cast<std::size_t>(dx + reach)] *
                 weights[static_cast<std::size_t>(dy + reach)] * source.at(x + dx, y + dy);
        }
      }
      result.values.push_back(sum);
    }
  }
  return result;
}

// Interpolated bilinearly at the centre of a pixel of full size.
double enlarged(const Quarter& quarter, int px, int py) {
  const double x = (px + 0.5) / 4.0 - 0.5, y = (py + 0.5) / 4.0 - 0.5;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const auto row = [&](int qy) { return mix(quarter.at(x0, qy), quarter.at(x0 + 1, qy), x - x0); };
  return mix(row(y0), row(y0 + 1), y - y0);
}

}  // namespace

TEST_CASE("post-process is what its equations say") {
  ThreadPool pool(2);
  constexpr int kWidth = 45, kHeight = 38;
  const Image scene = random_scene_image(kWidth, kHeight, 1);
  for (const float max_coc : {4.0f, 12.0f, 24.0f}) {
    const DofInput input{scene, {.coc = {20.0f, 2.0f}, .max_coc_px = max_coc}, {}};
    const auto texel = [&](int x, int y) {
      return split_texel(input, std::clamp(x, 0, kWidth - 1), std::clamp(y, 0, kHeight - 1));
    };
    const auto green = [&](int x, int y) { return static_cast<double>(texel(x, y).g); };

    Quarter quarter{(kWidth + 3) / 4, (kHeight + 3) / 4, {}};
    Quarter near = quarter;
    for (int i = 0; i < quarter.width * quarter.height; ++i) {
      double sum = 0.0, largest = 0.0;
      for (int j = 0; j < 16; ++j) {
        const int x = 4 * (i % quarter.width) + j % 4, y = 4 * (i / quarter.width) + j / 4;
        sum += green(x, y) / 16.0;
        const double r = -static_cast<double>(texel(x, y).radius_px);
        if (r > 0.5) largest = std::max(largest, r);
      }
      quarter.values.push_back(sum);
      near.values.push_back(largest);
    }
    const double squares[] = {0.25, 4.0 * 24.0 / 17.0, 47.0,
                              std::max(static_cast<double>(max_coc * max_coc), 51.0)};
    const double variance = (squares[3] / 4.0 - 3.75) / 16.0;
    const int reach = static_cast<int>(std::ceil(3.0 * std::sqrt(variance)));
    std::vector<double> gaussian;
    double total = 0.0;
    for (int i = -reach; i <= reach; ++i) {
      gaussian.push_back(std::exp(-0.5 * i * i / variance));
      total += gaussian.back();
    }
    for (double& weight : gaussian) weight /= total;
    const Quarter large = convolved(quarter, gaussian);
    const Quarter blurred = convolved(near, gaussian);
    for (std::size_t i = 0; i < near.values.size(); ++i) {
      near.values[i] = 2.0 * std::max(blurred.values[i], near.values[i]) - near.values[i];
    }
    const Quarter medium = convolved(quarter, {0.25, 0.5, 0.25});
    near = convolved(near, {0.25, 0.5, 0.25});

    Image result = make_image(Format::rgba16f, kWidth, kHeight);
    post_process(input, result, pool);
    double worst = 0.0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        // A bilinear tap between four pixels is their mean.
        const auto tap = [&](int left, int top) {
          return (green(x + left, y + top) + green(x + left + 1, y + top) +
                  green(x + left, y + top + 1) + green(x + left + 1, y + top + 1)) /
                 4.0;
        };
        const double own = green(x, y);
        const double small =
            (own + 4.0 * (tap(0, -2) + tap(-2, -1) + tap(-1, 1) + tap(1, 0))) / 17.0;
        const double r =
            std::max({enlarged(near, x, y), static_cast<double>(texel(x, y).radius_px), 0.0});
        double expected = own;
        const double blurs[] = {small, enlarged(medium, x, y), enlarged(large, x, y)};
        for (int i = 0; i < 3; ++i) {
          expected =
              mix(expected, blurs[i], sat((r * r - squares[i]) / (squares[i + 1] - squares[i])));
        }
        worst =
            std::max(worst, std::fabs(static_cast<double>(load_texel(result, x, y).y) - expected));
      }
    }
    INFO("max_coc ", max_coc);
    CHECK(worst < 0x1p-11);
  }
}
