#include "dof/circular/circular.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <vector>

#include "dof/half_resolution/half_fields.h"
#include "raster/images/texel.h"
#include "tests/dof/half_resolution/merge_oracle.h"
#include "tests/support/test_images.h"

using namespace softfocus;
using test::cell_value;

namespace {

using Complex = std::complex<double>;

struct Gaussian {
  double a, b;
  Complex factor;
};
const std::vector<Gaussian> kOne = {{.862325, 1.624835, {.767583, -1.862321}}};
const std::vector<Gaussian> kTwo = {{.886528, 5.268909, {.411259, .548794}},
                                    {1.960518, 1.558213, {.513282, -4.56111}}};

// The header's equations in binary64, with the library's exponential. The near field has no shares
// and two values: premultiplied green, and opacity.
struct Oracle {
  const HalfFields& fields;
  const std::vector<Gaussian>& gaussians;
  double edge;
  bool near;

  double size(int x, int y) const { return cell_value(fields, near ? kNearSize : kFarSize, x, y); }
  double share(int x, int y, double receiver) const {
    if (near) return 1.0;
    return std::min(1.0, 2.0 * size(x, y) * cell_value(fields, kFarWeight, x, y) / receiver);
  }
  Complex kernel(const Gaussian& gaussian, int d, double r) const {
    const double step = edge / (std::floor(r * 16.0 + 0.5) / 16.0);
    const double cut = std::clamp(r * 1.2 / edge + 0.5 - std::abs(d), 0.0, 1.0);
    return d == 0 ? Complex{1.0}
                  : cut * std::exp(Complex{-gaussian.a, gaussian.b} * (step * d * step * d));
  }
  Complex across(const Gaussian& gaussian, int plane, int x, int y) const {
    const double r = size(x, y), own = cell_value(fields, plane, x, y);
    if (r <= 0.5) return own;
    Complex sum, weights;
    for (int d = -12; d <= 12; ++d) {
      const Complex k = kernel(gaussian, d, r);
      sum += k * (own + share(x + d, y, r) * (cell_value(fields, plane, x + d, y) - own));
      weights += k;
    }
    return sum / weights;
  }
  double blurred(int plane, int x, int y) const {
    const double r = size(x, y);
    if (r <= 0.5) return cell_value(fields, plane, x, y);
    Complex top, bottom;
    for (const Gaussian& gaussian : gaussians) {
      const Complex own = across(gaussian, plane, x, y);
      Complex sum, weights;
      for (int d = -12; d <= 12; ++d) {
        const Complex k = kernel(gaussian, d, r);
        const int row = std::clamp(y + d, 0, fields.cells.height - 1);
        sum += k * (own + share(x, row, r) * (across(gaussian, plane, x, row) - own));
        weights += k;
      }
      top += gaussian.factor * weights * sum;
      bottom += gaussian.factor * weights * weights;
    }
    return std::max(0.0, top.real() / bottom.real());
  }
};

}  // namespace

TEST_CASE("circular separable blur is what its equations say") {
  ThreadPool pool(2);
  const Image scene = random_scene_image(31, 28, 1);  // a single tile
  const DofInput input{scene, {.coc = {13.0f, 2.0f}, .max_coc_px = 13.0f}, {}};
  const HalfFields fields = make_half_fields(input, pool);
  REQUIRE(fields.highlights.reach < 0);
  for (const int components : {1, 2}) {
    Image result = make_image(Format::rgba16f, 31, 28);
    (components == 1 ? circular_one : circular_two)(input, result, pool);
    const std::vector<Gaussian>& gaussians = components == 1 ? kOne : kTwo;
    const double edge = components == 1 ? 1.085 : 1.11;
    const Oracle far{fields, gaussians, edge, false}, near{fields, gaussians, edge, true};
    const double worst = test::merge_error(input, fields, result, [&](int x, int y) {
      const double opacity = near.blurred(kNearOpacity, x, y);
      const double cut = std::min(opacity, 1.0);
      const double colour = near.blurred(kNearColour + 1, x, y);
      return test::BlurredCell{far.blurred(kFarColour + 1, x, y),
                               opacity > 0.0 ? colour * (cut / opacity) : 0.0, cut};
    });
    INFO(components, " components");
    CHECK(worst < 0x1p-10);
  }
}

TEST_CASE("circular separable discs have their edge at the circle of confusion") {
  ThreadPool pool(2);
  constexpr int kSize = 161, kMiddle = 80;
  for (const auto filter : {circular_one, circular_two}) {
    for (const float radius : {16.0f, 24.0f, 40.0f}) {
      Image scene = make_image(Format::rgba16f, kSize, kSize);
      for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
          // Wide enough to be no highlight, but for its corners.
          const int apart = std::max(std::abs(x - kMiddle), std::abs(y - kMiddle));
          const float light = apart <= 5 ? 10.0f : 0.0f;
          store_texel(scene, x, y, {light, light, light, 4.0f}, {});
        }
      }
      Image result = make_image(Format::rgba16f, kSize, kSize);
      filter({scene, {.coc = {2.0f * radius, 2.0f}, .max_coc_px = 64.0f}, {}}, result, pool);
      // The place along an axis where the light falls to half of an even disc's.
      const double half = 121 * 5.0 / (3.14159265 * radius * radius);
      int x = kMiddle;
      while (load_texel(result, x + 1, kMiddle).x > half) ++x;
      const double inner = load_texel(result, x, kMiddle).x;
      const double outer = load_texel(result, x + 1, kMiddle).x;
      const double edge = x - kMiddle + (inner - half) / (inner - outer);
      INFO("radius ", radius);
      CHECK(std::fabs(edge - radius) < 1.5);
    }
  }
}
