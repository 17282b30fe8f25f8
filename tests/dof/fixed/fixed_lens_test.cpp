// Tables of the integer filter: against the lens in binary64, and at every limit.

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "dof/fixed/quotient.h"
#include "dof/fixed/wide.h"
#include "dof/lens.h"
#include "raster/numbers/half.h"
#include "tests/support/fixed_pictures.h"

using namespace softfocus;
using namespace softfocus::fixed;
using softfocus::fixed::Camera;  // not a scene's

namespace {

constexpr Lens kLens{12u << 16, 1500000, 9u << 16 | 0x8000, 65536};
constexpr double kOneWeight = 1 << 19;

/// The weights before they are rounded.
struct ExactWeights {
  double whole, edge, leak;
  int reach;
};

ExactWeights exact_weights(double radius, double leak) {
  const double cut = std::fmax(radius, 1.0);
  const int reach = radius > 0 ? static_cast<int>(std::ceil(radius)) - 1 : 0;
  const double whole = kOneWeight / (cut * cut);
  return {whole, reach > 0 ? whole * (radius - reach) : whole,
          32768.0 * std::fmin(leak * radius, 1.0), reach};
}

double exact_radius(const Lens& lens, double depth_um) {
  const double away = std::fabs(depth_um - lens.focus_um) / depth_um;
  return std::fmin(lens.radius_at_infinity * away, lens.largest_radius) / 65536.0;
}

}  // namespace

TEST_CASE("fixed point: every code's weights are the lens's to within a rounding") {
  const auto table = table8(kLens, 200000, 7000000);
  for (int code = 0; code < 256; ++code) {
    const double depth = 200000.0 + std::floor(6800000.0 * code / 255.0);
    const ExactWeights exact = exact_weights(exact_radius(kLens, depth), 1.0);
    const Weights& weights = table[static_cast<std::size_t>(code)];
    CAPTURE(code);
    CHECK(weights.beyond == (depth > kLens.focus_um ? 1 : 0));
    CHECK(weights.reach == exact.reach);
    // The radius is rounded to 2^-16, the weights to 2^-19.
    CHECK(std::fabs(weights.whole - exact.whole) < 0.5 + 2 * exact.whole * 0x1p-17);
    CHECK(std::fabs(weights.edge - exact.edge) < 1.0 + 3 * exact.whole * 0x1p-17);
    CHECK(std::fabs(weights.leak - exact.leak) < 0.76);
  }
}

TEST_CASE("fixed point: a half's weights are those of its depth, zero and NaN the largest") {
  std::vector<Weights> table(65536);
  REQUIRE(softfocus_fixed_table_half(&kLens, table.data()) == 0);
  const ExactWeights largest = exact_weights(9.5, 1.0);
  for (std::uint32_t half = 0; half < 65536; half += 7) {
    const Weights& weights = table[half];
    const double depth = half_to_float(static_cast<std::uint16_t>(half)) * 1e6;
    CAPTURE(half);
    if (depth > 0 && std::isfinite(depth)) {
      const ExactWeights exact = exact_weights(exact_radius(kLens, depth), 1.0);
      CHECK(weights.beyond == (depth > kLens.focus_um ? 1 : 0));
      CHECK(std::fabs(weights.whole - exact.whole) < 0.5 + 2 * exact.whole * 0x1p-17);
    } else if (!(depth < 0)) {
      CHECK(weights.whole == doctest::Approx(largest.whole).epsilon(1e-3));
      CHECK(weights.reach == 9);
    }
  }
  CHECK(table[0x7C00].beyond == 1);
  CHECK(table[0x7E00].beyond == 0);
  CHECK(table[0x0000].reach == 9);
  CHECK(table[0x8000].reach == 9);
  CHECK(table[0xFC00].reach == 9);
}

TEST_CASE("fixed point: every table that can be made keeps within the bounds of the sums") {
  // The largest sum of weights that make_weights() can give is that of circles of radius
  // d + 1 at every distance d.
  std::uint64_t sum = 1u << 19;
  for (std::uint64_t d = 1; d <= 63; ++d) {
    const Weights weights = make_weights((d + 1) << 16, 65536, true);
    CHECK(weights.edge == weights.whole);
    sum += 2 * (std::uint64_t{weights.edge} + 1);
  }
  CHECK(sum <= 1200701);
  CHECK(sum * 1023 + sum / 2 < 1u << 31);
  CHECK(sum < 1u << 21);
  Random random{6};
  for (int i = 0; i < 4000; ++i) {
    const std::uint64_t radius = random.next() % (kLargestRadius + 1);
    const Weights weights = make_weights(radius, 4096 + any_below(random, 100000), i % 2 == 0);
    CAPTURE(radius);
    CHECK(within_bounds(weights, 63));
    CHECK(std::uint64_t{weights.edge} * (weights.reach + 1u) * (weights.reach + 1u) <=
          (1u << 19) + (weights.reach + 1u) * (weights.reach + 1u));
  }
}

TEST_CASE("fixed point: a lens at any limit makes a table, a lens past it is refused") {
  std::vector<Weights> table(256);
  constexpr std::uint32_t kMost = 0xFFFFFFFF;
  for (const std::uint32_t at_infinity : {0u, 1u, kMost}) {
    for (const std::uint32_t focus : {1u, kMost}) {
      for (const std::uint32_t largest : {0u, 1u, 64u << 16}) {
        for (const std::uint32_t leak : {0u, 4096u, kMost}) {
          for (const std::uint32_t near_um : {0u, 1u, kMost}) {
            const Lens lens{at_infinity, focus, largest, leak};
            REQUIRE(softfocus_fixed_table8(&lens, near_um, kMost - near_um, table.data()) == 0);
            for (const Weights& weights : table) CHECK(within_bounds(weights, reach_of(largest)));
          }
        }
      }
    }
  }
  table[0].reach = 99;
  for (const Lens& lens : {Lens{1, 0, 1, 0}, Lens{1, 1, (64u << 16) + 1, 0}, Lens{1, 1, 1, 4095}}) {
    CHECK(softfocus_fixed_table8(&lens, 0, 1, table.data()) == SOFTFOCUS_FIXED_BAD_LENS);
  }
  CHECK(softfocus_fixed_table8(nullptr, 0, 1, table.data()) == SOFTFOCUS_FIXED_BAD_ARGUMENT);
  CHECK(softfocus_fixed_table8(&kLens, 0, 1, nullptr) == SOFTFOCUS_FIXED_BAD_ARGUMENT);
  CHECK(softfocus_fixed_table16(&kLens, 0, 1, nullptr) == SOFTFOCUS_FIXED_BAD_ARGUMENT);
  CHECK(softfocus_fixed_table_half(nullptr, table.data()) == SOFTFOCUS_FIXED_BAD_ARGUMENT);
  CHECK(table[0].reach == 99);
}

TEST_CASE("fixed point: the horizon's circle of a camera is the lens's") {
  const ThinLens lens{.focal_length_mm = 50, .f_number = 2, .focus_m = 2};
  const double fov = 40;
  const auto film_um = static_cast<std::uint32_t>(film_height_mm(lens, fov) * 1000 + 0.5);
  const Camera camera{50000, 2 << 8, 2000000, film_um, 1024};
  std::uint32_t radius = 0;
  REQUIRE(softfocus_fixed_radius_at_infinity(&camera, &radius) == 0);
  CHECK(radius / 65536.0 ==
        doctest::Approx(static_cast<double>(pixel_coc(lens, fov, 1024, 1.0).radius_at_infinity_px))
            .epsilon(2e-5));
  radius = 77;
  const auto refused = [&](auto change) {
    Camera other = camera;
    change(other);
    return softfocus_fixed_radius_at_infinity(&other, &radius) == SOFTFOCUS_FIXED_BAD_LENS;
  };
  CHECK(refused([](Camera& c) { c.focal_length_um = 0; }));
  CHECK(refused([](Camera& c) { c.focal_length_um = (1u << 20) + 1; }));
  CHECK(refused([](Camera& c) { c.f_number = 0; }));
  CHECK(refused([](Camera& c) { c.f_number = 1u << 15; }));
  CHECK(refused([](Camera& c) { c.focus_um = c.focal_length_um; }));
  CHECK(refused([](Camera& c) { c.film_height_um = 0; }));
  CHECK(refused([](Camera& c) { c.film_height_um = (1u << 17) + 1; }));
  CHECK(refused([](Camera& c) { c.height_px = 0; }));
  CHECK(refused([](Camera& c) { c.height_px = 16385; }));
  CHECK(refused([](Camera& c) { c = {1u << 20, 1, (1u << 20) + 1, 1, 16384}; }));
  CHECK(radius == 77);
  const Camera widest{1u << 20, (1u << 15) - 1, 0xFFFFFFFF, 1u << 17, 16384};
  CHECK(softfocus_fixed_radius_at_infinity(&widest, &radius) == 0);
}

TEST_CASE("fixed point: the reciprocal's quotient is exact for every weight that sums can have") {
  Random random{7};
  int wrong = 0;
  for (std::uint32_t weight = 1; weight < 1u << 21; ++weight) {
    const Divisor divisor = make_divisor(weight);
    const auto check = [&](std::uint32_t result, std::uint32_t rest) {
      if (quotient(result * weight + rest, divisor) != result) ++wrong;
    };
    check(0, 0);
    check(1023, weight - 1);
    check(1023, 0);
    check(any_below(random, 1024), 0);
    check(any_below(random, 1024), weight - 1);
    check(any_below(random, 1024), any_below(random, weight));
  }
  CHECK(wrong == 0);
}

TEST_CASE("fixed point: wide products and quotients are those of long division by hand") {
  CHECK(multiply_divide(0xFFFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFF) ==
        0xFFFFFFFFFFFFFFFF);
  CHECK(multiply_divide(1, 1, 2) == 1);  // a tie goes up
  CHECK(multiply_divide(1, 1, 3) == 0);
  CHECK(multiply_divide(5, 7, 0) == UINT64_MAX);
  CHECK(divide({1, 0}, 1) == UINT64_MAX);
  CHECK(divide({1, 0}, 2) == 1ull << 63);
  CHECK(divide(multiply(0x123456789ABCDEF0, 0xFEDCBA9876543210), 0xFEDCBA9876543210) ==
        0x123456789ABCDEF0);
}
