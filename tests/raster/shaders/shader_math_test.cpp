#include "raster/shaders/shader_math.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "raster/numbers/hash.h"
#include "tests/support/random.h"

// The oracle is the C library in binary64. The bounds are those of docs/specification.md, found
// over all floats by the test case that is skipped.

using namespace softfocus;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::bit_cast<float>(0x7FC00000u);
constexpr float kPi = 0x1.921fb6p+1f;

struct Function {
  ShaderFunction function;
  const char* name;
  double (*oracle)(double);
  double bound_ulps;
};
const std::array kFunctions{
    Function{ShaderFunction::sine, "sin", std::sin, 2.09},
    Function{ShaderFunction::cosine, "cos", std::cos, 2.09},
    Function{ShaderFunction::tangent, "tan", std::tan, 2.79},
    Function{ShaderFunction::arcsine, "asin", std::asin, 2.41},
    Function{ShaderFunction::arccosine, "acos", std::acos, 1.16},
    Function{ShaderFunction::arctangent, "atan", std::atan, 2.35},
    Function{ShaderFunction::hyperbolic_sine, "sinh", std::sinh, 1.62},
    Function{ShaderFunction::hyperbolic_cosine, "cosh", std::cosh, 1.43},
    Function{ShaderFunction::hyperbolic_tangent, "tanh", std::tanh, 1.34},
    Function{ShaderFunction::inverse_hyperbolic_sine, "asinh", std::asinh, 0.51},
    Function{ShaderFunction::inverse_hyperbolic_cosine, "acosh",
             // musl's has values below -1.
             [](double x) { return x < 1.0 ? std::nan("") : std::acosh(x); }, 0.51},
    Function{ShaderFunction::inverse_hyperbolic_tangent, "atanh", std::atanh, 0.51},
    Function{ShaderFunction::exponential, "exp", std::exp, 1.0},
    Function{ShaderFunction::logarithm, "log", std::log, 0.95},
    Function{ShaderFunction::binary_exponential, "exp2", std::exp2, 1.08},
    Function{ShaderFunction::binary_logarithm, "log2", std::log2, 1.33},
    Function{ShaderFunction::inverse_square_root, "inversesqrt",
             [](double x) { return 1.0 / std::sqrt(x); }, 1.5},
};

std::vector<float> values_of(ShaderFunction function, const std::vector<float>& a,
                             const std::vector<float>& b = {}, Isa isa = widest_isa()) {
  std::vector<float> values(a.size());
  evaluate(function, a.data(), b.empty() ? nullptr : b.data(), static_cast<int>(a.size()),
           values.data(), isa);
  return values;
}
float value_of(ShaderFunction function, float a, float b = 0.0f) {
  return values_of(function, {a}, {b})[0];
}

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

// |value - exact| in units of the last place that a float near the exact value has. Infinity is
// right from 2^128 on.
double error_ulps(float value, double exact) {
  if (std::isnan(exact)) return same_bits(value, kNan) ? 0.0 : 1e9;
  if (std::isnan(value)) return 1e9;
  const double limited = std::clamp(exact, -0x1p128, 0x1p128);
  const double measured = std::clamp(static_cast<double>(value), -0x1p128, 0x1p128);
  const int exponent = limited == 0.0 ? -126 : std::clamp(std::ilogb(limited), -126, 127);
  return std::ldexp(std::fabs(measured - limited), 23 - exponent);
}

struct Worst {
  double error = 0.0;
  float at = 0.0f;
};

// Of the floats with every `stride`th bit pattern from `first` on.
Worst worst_of(const Function& f, std::uint64_t first, std::uint64_t stride) {
  constexpr std::size_t kBatch = 4096;
  Worst worst;
  std::vector<float> values;
  for (std::uint64_t bits = first; bits < std::uint64_t{1} << 32;) {
    values.clear();
    for (; values.size() < kBatch && bits < std::uint64_t{1} << 32; bits += stride) {
      values.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    }
    const std::vector<float> results = values_of(f.function, values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double error = error_ulps(results[i], f.oracle(static_cast<double>(values[i])));
      if (error > worst.error) worst = {error, values[i]};
    }
  }
  return worst;
}

// Where methods change, where results leave the range, and the neighbours of these.
std::vector<float> edges() {
  std::vector<float> all;
  for (const float edge :
       {0.0f,        0x1p-149f, 0x1p-126f,   0x1p-13f, 0.41421356f, 0.5f,          0.625f,
        0.70710678f, 1.0f,      1.41421356f, kPi / 2,  2.4142135f,  kPi,           9.0f,
        88.72284f,   89.4160f,  103.97f,     126.0f,   128.0f,      149.0f,        151.0f,
        6432.0f,     0x1p22f,   0x1p24f,     0x1p30f,  0x1p126f,    3.4028235e38f, kInfinity}) {
    const auto bits = std::bit_cast<std::uint32_t>(edge);
    for (std::uint32_t i = 0; i < 33; ++i) {
      if (bits + i < 16) continue;
      const float magnitude = std::bit_cast<float>(bits + i - 16);
      all.push_back(magnitude);
      all.push_back(-magnitude);
    }
  }
  return all;
}

// Floats of all kinds, most of them of a size that shaders have.
std::vector<float> many_values(std::uint64_t seed) {
  std::vector<float> all = edges();
  test::Random random{seed};
  while (all.size() < 40'000) {
    all.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random.next() >> 32)));
    all.push_back(random.between(-2.0f, 2.0f));
    all.push_back(random.between(-100.0f, 100.0f));
    all.push_back(random.between(-1e5f, 1e5f));
  }
  return all;
}

// Each function of one value on `a`, each of two on `a` and `b`.
template <class Do>
void for_each_function(const Do& run) {
  for (int i = 0; i < kShaderFunctions; ++i) run(static_cast<ShaderFunction>(i));
}

struct Special {
  ShaderFunction function;
  float a, expected;
};
struct SpecialPair {
  float a, b, expected;
};

}  // namespace

TEST_CASE("each shader function is within its bound of the exact value") {
  for (const Function& f : kFunctions) {
    CAPTURE(f.name);
    const Worst worst = worst_of(f, 77, 4'001);
    CAPTURE(worst.at);
    CHECK(worst.error <= f.bound_ulps);
    const std::vector<float> a = edges();
    const std::vector<float> results = values_of(f.function, a);
    for (std::size_t i = 0; i < a.size(); ++i) {
      CAPTURE(a[i]);
      const double error = error_ulps(results[i], f.oracle(static_cast<double>(a[i])));
      if (error > f.bound_ulps) CHECK(error <= f.bound_ulps);
    }
  }
}

// Some minutes each: softfocus_tests --no-skip --test-case="*over all floats*"
TEST_CASE("each shader function is within its bound over all floats" * doctest::skip()) {
  for (const Function& f : kFunctions) {
    const Worst worst = worst_of(f, 0, 1);
    MESSAGE(f.name << ": " << worst.error << " ULP at " << worst.at);
    CHECK(worst.error <= f.bound_ulps);
  }
}

TEST_CASE("pow is within 1.2 ULP, whatever the size of its result") {
  test::Random random{81};
  std::vector<float> a;
  std::vector<float> b;
  for (int i = 0; i < 100'000; ++i) {
    const float base = i % 2 == 0
                           ? std::ldexp(random.between(1.0f, 2.0f), random.whole(-140, 127))
                           : 1.0f + std::ldexp(random.between(-1.0f, 1.0f), random.whole(-23, -1));
    const double exponent = random.between(-150.0, 129.0) / std::log2(static_cast<double>(base));
    a.push_back(base);
    b.push_back(std::isfinite(exponent) ? static_cast<float>(exponent) : 1.0f);
  }
  const std::vector<float> results = values_of(ShaderFunction::power, a, b);
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double exact = std::pow(static_cast<double>(a[i]), static_cast<double>(b[i]));
    worst = std::max(worst, error_ulps(results[i], exact));
  }
  CHECK(worst <= 1.2);
}

TEST_CASE("pow of small whole numbers is exact if the result is a float") {
  for (int base = 0; base <= 64; ++base) {
    for (int exponent = 0; exponent <= 6; ++exponent) {
      const double exact = std::pow(base, exponent);
      const auto rounded = static_cast<float>(exact);
      if (static_cast<double>(rounded) != exact) continue;
      const float value =
          value_of(ShaderFunction::power, static_cast<float>(base), static_cast<float>(exponent));
      CAPTURE(base);
      CAPTURE(exponent);
      if (value != rounded) CHECK(value == rounded);
    }
  }
}

TEST_CASE("atan of two values is within 2.3 ULP") {
  test::Random random{82};
  std::vector<float> a;
  std::vector<float> b;
  for (int i = 0; i < 100'000; ++i) {
    if (i % 3 == 0) {
      a.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random.next() >> 32)));
      b.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random.next() >> 32)));
    } else if (i % 3 == 1) {
      a.push_back(random.between(-2.0f, 2.0f));
      b.push_back(random.between(-2.0f, 2.0f));
    } else {
      a.push_back(static_cast<float>(random.whole(-40, 40)) * 0x1p-149f);
      b.push_back(static_cast<float>(random.whole(1, 40)) * 0x1p-149f);
    }
  }
  const std::vector<float> results = values_of(ShaderFunction::arctangent_of_two, a, b);
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double exact = std::atan2(static_cast<double>(a[i]), static_cast<double>(b[i]));
    worst = std::max(worst, error_ulps(results[i], exact));
  }
  CHECK(worst <= 2.3);
}

TEST_CASE("log2 is exact at powers of two, and exp2 at whole numbers") {
  int wrong = 0;
  for (int n = -149; n <= 127; ++n) {
    const float power = std::ldexp(1.0f, n);
    wrong += value_of(ShaderFunction::binary_logarithm, power) != static_cast<float>(n);
    wrong += value_of(ShaderFunction::binary_exponential, static_cast<float>(n)) != power;
  }
  CHECK(wrong == 0);
}

TEST_CASE("sine, cosine and the hyperbolic tangent never leave -1 to 1") {
  const std::vector<float> a = many_values(83);
  int beyond = 0;
  for (const ShaderFunction function :
       {ShaderFunction::sine, ShaderFunction::cosine, ShaderFunction::hyperbolic_tangent}) {
    for (const float value : values_of(function, a)) beyond += std::fabs(value) > 1.0f;
  }
  CHECK(beyond == 0);
}

TEST_CASE("odd functions are odd and even ones even, to the bit") {
  const std::vector<float> a = many_values(84);
  std::vector<float> negated = a;
  for (float& value : negated) value = -value;
  for (const ShaderFunction function :
       {ShaderFunction::sine, ShaderFunction::tangent, ShaderFunction::arcsine,
        ShaderFunction::arctangent, ShaderFunction::hyperbolic_sine,
        ShaderFunction::hyperbolic_tangent, ShaderFunction::inverse_hyperbolic_sine,
        ShaderFunction::inverse_hyperbolic_tangent, ShaderFunction::cosine,
        ShaderFunction::hyperbolic_cosine}) {
    CAPTURE(static_cast<int>(function));
    const bool even =
        function == ShaderFunction::cosine || function == ShaderFunction::hyperbolic_cosine;
    const std::vector<float> values = values_of(function, a);
    const std::vector<float> mirrored = values_of(function, negated);
    int wrong = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const bool keeps = even || std::isnan(values[i]);
      wrong += !same_bits(mirrored[i], keeps ? values[i] : -values[i]);
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("special values of the functions of one value") {
  using enum ShaderFunction;
  for (const Special& special : {
           Special{sine, -0.0f, -0.0f},
           {sine, 0.0f, 0.0f},
           {sine, -1e-40f, -1e-40f},
           {sine, kInfinity, kNan},
           {cosine, -0.0f, 1.0f},
           {cosine, 1e-40f, 1.0f},
           {cosine, -kInfinity, kNan},
           {tangent, -0.0f, -0.0f},
           {tangent, kInfinity, kNan},
           {arcsine, -0.0f, -0.0f},
           {arcsine, 1.0f, kPi / 2},
           {arcsine, -1.0f, -kPi / 2},
           {arcsine, 1.0000001f, kNan},
           {arccosine, 1.0f, 0.0f},
           {arccosine, -1.0f, kPi},
           {arccosine, 0.0f, kPi / 2},
           {arccosine, -1.0000001f, kNan},
           {arctangent, -0.0f, -0.0f},
           {arctangent, kInfinity, kPi / 2},
           {arctangent, -kInfinity, -kPi / 2},
           {hyperbolic_sine, -0.0f, -0.0f},
           {hyperbolic_sine, 90.0f, kInfinity},
           {hyperbolic_sine, -kInfinity, -kInfinity},
           {hyperbolic_cosine, 0.0f, 1.0f},
           {hyperbolic_cosine, -kInfinity, kInfinity},
           {hyperbolic_tangent, -0.0f, -0.0f},
           {hyperbolic_tangent, kInfinity, 1.0f},
           {hyperbolic_tangent, -10.0f, -1.0f},
           {inverse_hyperbolic_sine, -0.0f, -0.0f},
           {inverse_hyperbolic_sine, -kInfinity, -kInfinity},
           {inverse_hyperbolic_cosine, 1.0f, 0.0f},
           {inverse_hyperbolic_cosine, 0.9999999f, kNan},
           {inverse_hyperbolic_cosine, kInfinity, kInfinity},
           {inverse_hyperbolic_tangent, -0.0f, -0.0f},
           {inverse_hyperbolic_tangent, 1.0f, kInfinity},
           {inverse_hyperbolic_tangent, -1.0f, -kInfinity},
           {inverse_hyperbolic_tangent, 1.0000001f, kNan},
           {exponential, -0.0f, 1.0f},
           {exponential, 89.0f, kInfinity},
           {exponential, -104.0f, 0.0f},
           {exponential, -kInfinity, 0.0f},
           {logarithm, 1.0f, 0.0f},
           {logarithm, -0.0f, -kInfinity},
           {logarithm, -1e-40f, kNan},
           {logarithm, kInfinity, kInfinity},
           {binary_exponential, -149.0f, 0x1p-149f},
           {binary_exponential, -150.0f, 0.0f},
           {binary_exponential, 128.0f, kInfinity},
           {binary_exponential, -kInfinity, 0.0f},
           {binary_logarithm, 0.0f, -kInfinity},
           {binary_logarithm, -1.0f, kNan},
           {binary_logarithm, -kInfinity, kNan},
           {binary_logarithm, kInfinity, kInfinity},
           {inverse_square_root, 4.0f, 0.5f},
           {inverse_square_root, 0.0f, kInfinity},
           {inverse_square_root, -0.0f, -kInfinity},
           {inverse_square_root, kInfinity, 0.0f},
           {inverse_square_root, -1.0f, kNan},
       }) {
    CAPTURE(static_cast<int>(special.function));
    CAPTURE(special.a);
    const float value = value_of(special.function, special.a);
    CAPTURE(value);
    CHECK(same_bits(value, special.expected));
  }
}

TEST_CASE("NaN of any kind gives one NaN, in every function") {
  for_each_function([](ShaderFunction function) {
    CAPTURE(static_cast<int>(function));
    for (const std::uint32_t bits : {0x7FC00000u, 0xFFC00000u, 0x7F800001u, 0xFFFFFFFFu}) {
      const auto nan = std::bit_cast<float>(bits);
      CHECK(same_bits(value_of(function, nan, 0.0f), kNan));
      if (function == ShaderFunction::power || function == ShaderFunction::arctangent_of_two) {
        CHECK(same_bits(value_of(function, 1.0f, nan), kNan));
      }
    }
  });
}

TEST_CASE("special values of pow") {
  for (const SpecialPair& special : {
           SpecialPair{0.0f, 0.0f, 1.0f}, {2.0f, -0.0f, 1.0f},
           {kInfinity, 0.0f, 1.0f},       {1.0f, kInfinity, 1.0f},
           {1.0f, -kInfinity, 1.0f},      {0.0f, 0x1p-149f, 0.0f},
           {-0.0f, 3.0f, 0.0f},           {0.0f, -0x1p-149f, kInfinity},
           {-0.0f, -1.0f, kInfinity},     {kInfinity, 0x1p-149f, kInfinity},
           {kInfinity, -1.0f, 0.0f},      {0.5f, kInfinity, 0.0f},
           {0.5f, -kInfinity, kInfinity}, {2.0f, 3e38f, kInfinity},
           {2.0f, -3e38f, 0.0f},          {0x1.fffffep-1f, -kInfinity, kInfinity},
           {0x1p-149f, 1.0f, 0x1p-149f},  {0x1p-149f, -0.5f, 0x1.6a09e6p+74f},
           {2.0f, -149.0f, 0x1p-149f},    {-1.0f, 2.0f, kNan},
           {-1.0f, 0.0f, kNan},           {-kInfinity, 1.0f, kNan},
       }) {
    CAPTURE(special.a);
    CAPTURE(special.b);
    const float value = value_of(ShaderFunction::power, special.a, special.b);
    CAPTURE(value);
    CHECK(same_bits(value, special.expected));
  }
}

TEST_CASE("special values of atan of two values") {
  for (const SpecialPair& special : {
           SpecialPair{0.0f, 0.0f, 0.0f},
           {-0.0f, 0.0f, -0.0f},
           {0.0f, -0.0f, 0.0f},
           {0.0f, -1.0f, kPi},
           {-0.0f, -1.0f, -kPi},
           {1.0f, 0.0f, kPi / 2},
           {-1.0f, -0.0f, -kPi / 2},
           {1.0f, 1.0f, kPi / 4},
           {3e38f, -3e38f, 3 * (kPi / 4)},
           {0x1p-149f, 0x1p-149f, kPi / 4},
           {kInfinity, kInfinity, kPi / 4},
           {kInfinity, -kInfinity, 3 * (kPi / 4)},
           {-kInfinity, 1.0f, -kPi / 2},
           {1.0f, kInfinity, 0.0f},
           {-1.0f, kInfinity, -0.0f},
           {1.0f, -kInfinity, kPi},
       }) {
    CAPTURE(special.a);
    CAPTURE(special.b);
    const float value = value_of(ShaderFunction::arctangent_of_two, special.a, special.b);
    CAPTURE(value);
    CHECK(same_bits(value, special.expected));
  }
}

TEST_CASE("every vector unit gives the same bits, in every build") {
  const std::vector<float> a = many_values(85);
  std::vector<float> b = many_values(86);
  std::reverse(b.begin(), b.end());
  Hash hash;
  for_each_function([&](ShaderFunction function) {
    CAPTURE(static_cast<int>(function));
    const std::vector<float> widest = values_of(function, a, b);
    for (const Isa isa : available_isas()) {
      CAPTURE(isa_name(isa));
      const std::vector<float> values = values_of(function, a, b, isa);
      CHECK(std::equal(values.begin(), values.end(), widest.begin(), same_bits));
    }
    for (const float value : widest) add_to_hash(hash, value);
  });
  CHECK(hash.value == 11305591261494842567u);
}

TEST_CASE("a value does not depend on its neighbours, and none beyond the last is written") {
  const std::vector<float> a = many_values(87);
  for_each_function([&](ShaderFunction function) {
    CAPTURE(static_cast<int>(function));
    const std::vector<float> together = values_of(function, a, a);
    int wrong = 0;
    for (std::size_t i = 0; i < a.size(); i += 37) {
      std::array<float, 3> alone{7.0f, 7.0f, 7.0f};
      evaluate(function, &a[i], &a[i], 1, &alone[1], widest_isa());
      wrong += !same_bits(alone[1], together[i]) || alone[0] != 7.0f || alone[2] != 7.0f;
    }
    CHECK(wrong == 0);
  });
}
