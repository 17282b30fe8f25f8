#include "dof/methods/circular_separable.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

using Complex = std::complex<double>;

struct Gaussian {
  double a, b;
  Complex factor;
};
const std::vector<Gaussian> kOne = {{.862325, 1.624835, {.767583, -1.862321}}};
const std::vector<Gaussian> kTwo = {{.886528, 5.268909, {.411259, .548794}},
                                    {1.960518, 1.558213, {.513282, -4.56111}}};

// The header's equations in binary64, with the library's exponential.
double oracle(const DofInput& input, int x, int y, const std::vector<Gaussian>& gaussians,
              double edge) {
  const int width = input.scene.width, height = input.scene.height;
  const auto at = [&](int px, int py) {
    return split_texel(input, std::clamp(px, 0, width - 1), std::clamp(py, 0, height - 1));
  };
  const double own_radius = std::fabs(at(x, y).radius_px);
  if (own_radius <= 0.5) return at(x, y).g;
  Complex top, bottom;
  for (const Gaussian& gaussian : gaussians) {
    const auto kernel = [&](int d, double r) {
      const double step = edge / (std::floor(r * 16.0 + 0.5) / 16.0);
      const double cut = std::clamp(r * 1.2 / edge + 0.5 - std::abs(d), 0.0, 1.0);
      return d == 0 ? Complex{1.0}
                    : cut * std::exp(Complex{-gaussian.a, gaussian.b} * (step * d * step * d));
    };
    const auto share = [](double radius, double receiver) {
      return std::min(1.0, 2.0 * std::fabs(radius) / receiver);
    };
    const auto across = [&](int py) {
      const SplitTexel own = at(x, py);
      const double r = std::fabs(own.radius_px);
      if (r <= 0.5) return Complex{own.g};
      Complex sum, weights;
      for (int d = -20; d <= 20; ++d) {
        const SplitTexel p = at(x + d, py);
        sum += kernel(d, r) * (own.g + share(p.radius_px, r) * (p.g - own.g));
        weights += kernel(d, r);
      }
      return sum / weights;
    };
    const Complex own = across(y);
    Complex sum, weights;
    for (int d = -20; d <= 20; ++d) {
      const SplitTexel p = at(x, y + d);
      const Complex other = across(std::clamp(y + d, 0, height - 1));
      sum += kernel(d, own_radius) * (own + share(p.radius_px, own_radius) * (other - own));
      weights += kernel(d, own_radius);
    }
    top += gaussian.factor * weights * sum;
    bottom += gaussian.factor * weights * weights;
  }
  return std::max(0.0, top.real() / bottom.real());
}

}  // namespace

TEST_CASE("circular separable blur is what its equations say") {
  ThreadPool pool(2);
  const Image scene = random_scene_image(33, 29, 1);
  const DofInput input{scene, {.coc = {13.0f, 2.0f}, .max_coc_px = 9.0f}, {}};
  for (const int components : {1, 2}) {
    Image result = make_image(Format::rgba16f, 33, 29);
    (components == 1 ? circular_one : circular_two)(input, result, pool);
    double worst = 0.0;
    for (int y = 0; y < 29; ++y) {
      for (int x = 0; x < 33; ++x) {
        const double expected =
            oracle(input, x, y, components == 1 ? kOne : kTwo, components == 1 ? 1.085 : 1.11);
        worst = std::max(worst, std::fabs(load_texel(result, x, y).y - expected));
      }
    }
    INFO(components, " components");
    CHECK(worst < 0x1p-10);
  }
}

TEST_CASE("circular separable discs have their edge at the circle of confusion") {
  ThreadPool pool(2);
  for (const auto filter : {circular_one, circular_two}) {
    for (const float radius : {6.0f, 12.0f, 20.0f}) {
      Image scene = make_image(Format::rgba16f, 97, 97);
      for (int y = 0; y < 97; ++y) {
        for (int x = 0; x < 97; ++x) {
          const float light = x == 48 && y == 48 ? 1000.0f : 0.0f;
          store_texel(scene, x, y, {light, light, light, 4.0f}, {});
        }
      }
      Image result = make_image(Format::rgba16f, 97, 97);
      filter({scene, {.coc = {2.0f * radius, 2.0f}, .max_coc_px = 40.0f}, {}}, result, pool);
      // The place along an axis where the light falls to half of an even disc's.
      const double half = 500.0 / (3.14159265 * radius * radius);
      int x = 48;
      while (load_texel(result, x + 1, 48).x > half) ++x;
      const double inner = load_texel(result, x, 48).x, outer = load_texel(result, x + 1, 48).x;
      const double edge = x - 48 + (inner - half) / (inner - outer);
      INFO("radius ", radius);
      CHECK(std::fabs(edge - radius) < 0.6);
    }
  }
}
