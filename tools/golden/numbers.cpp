#include <bit>
#include <cmath>
#include <limits>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/fixed_point.h"
#include "raster/numbers/half.h"
#include "raster/numbers/hash.h"
#include "raster/numbers/lerp.h"
#include "raster/numbers/random_bits.h"
#include "raster/numbers/srgb.h"
#include "tools/golden/hashes.h"

namespace softfocus {
namespace {

constexpr int kFloats = 1 << 16;
constexpr int kAngles = 1 << 12;

void add_to_hash(Hash& hash, double value) {
  // Which NaN an operation gives differs between processors.
  if (value != value) value = std::numeric_limits<double>::quiet_NaN();
  softfocus::add_to_hash(hash, std::bit_cast<std::uint64_t>(value));
}

// Any bits: every exponent, infinities and NaN too.
float any_float(RandomSequence& random) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(next_bits(random) >> 32));
}

// A number that a half can nearly hold; half of them lie at or beside a midpoint between two
// halves.
float float_near_halves(RandomSequence& random) {
  const std::uint64_t bits = next_bits(random);
  const auto half = static_cast<std::uint16_t>(bits & 0xFBFFu);
  const auto start = std::bit_cast<std::uint32_t>(half_to_float(half));
  const auto rest = static_cast<std::uint32_t>(bits >> 32 & 0x1FFFu);
  const std::uint32_t beside_midpoint = 0xFFFu + rest % 3;
  return std::bit_cast<float>(start + ((bits >> 60 & 1u) != 0 ? rest : beside_midpoint));
}

std::uint64_t hash_of_decoding() {
  Hash hash;
  for (std::uint32_t half = 0; half <= 0xFFFFu; ++half) {
    add_to_hash(hash,
                std::bit_cast<std::uint32_t>(half_to_float(static_cast<std::uint16_t>(half))));
  }
  return hash.value;
}

std::uint64_t hash_of_encoding(HalfRounding rounding) {
  Hash hash;
  RandomSequence random{1};
  for (int i = 0; i < kFloats; ++i) {
    add_to_hash(hash, float_to_half(any_float(random), rounding));
    add_to_hash(hash, float_to_half(float_near_halves(random), rounding));
  }
  return hash.value;
}

// Every code, every threshold between codes, and floats in and around 0 to 1.
template <class Decode, class Encode>
std::uint64_t hash_of_8_bits(const Decode& decode, const Encode& encode) {
  Hash hash;
  for (int code = 0; code <= 255; ++code) {
    const float value = decode(static_cast<std::uint8_t>(code));
    softfocus::add_to_hash(hash, value);
    for (const float side : {0.0f, 2.0f}) add_to_hash(hash, encode(std::nextafter(value, side)));
  }
  RandomSequence random{2};
  for (int i = 0; i < kFloats; ++i) {
    add_to_hash(hash, encode(static_cast<float>(next_between(random, -0.1, 1.1))));
    add_to_hash(hash, encode(any_float(random)));
  }
  return hash.value;
}

std::uint64_t hash_of_unorm8(UnormRounding rounding) {
  return hash_of_8_bits(unorm8_to_linear,
                        [&](float value) { return linear_to_unorm8(value, rounding); });
}

std::uint64_t hash_of_snapping() {
  Hash hash;
  RandomSequence random{3};
  for (int i = 0; i < kFloats; ++i) {
    // Ties too: multiples of 1/512 pixel.
    const auto ties = static_cast<float>(next_bits(random) % (1u << 21)) / 512.0f - 1024.0f;
    const auto anywhere = static_cast<float>(next_between(random, -0x1p22, 0x1p22));
    for (const float coordinate : {ties, anywhere}) {
      add_to_hash(hash, static_cast<std::uint32_t>(snap_to_subpixel(coordinate)));
      softfocus::add_to_hash(hash, subpixel_to_window(snap_to_subpixel(ties)));
    }
  }
  return hash.value;
}

// Products that end in a tie and a third number far below decide the rounding: a sum in
// a longer format, rounded again, gets them wrong.
std::uint64_t hash_of_multiply_add(Contraction contraction) {
  Hash hash;
  RandomSequence random{4};
  const auto add = [&](float a, float b, float c) {
    add_to_hash(hash, static_cast<double>(multiply_add(a, b, c, contraction)));
  };
  for (int i = 0; i < kFloats; ++i) {
    const std::uint64_t bits = next_bits(random);
    const float a = 1.0f + static_cast<float>(bits & 0xFFFu) * 0x1p-12f;
    const float b = 1.0f + static_cast<float>(bits >> 12 & 0xFFFu) * 0x1p-12f;
    const float tiny = std::ldexp(1.0f, -30 - static_cast<int>(bits >> 32 & 63u));
    add(a, b, (bits >> 63 & 1u) != 0 ? tiny : -tiny);
    add(a * 0x1p-70f, b * 0x1p-70f, tiny * 0x1p-60f);  // subnormal results
    const float x = any_float(random);                 // one by one, for the order of the calls
    const float y = any_float(random);
    const float z = any_float(random);
    add(x, y, z);
    add(a, -b, a * b);
  }
  return hash.value;
}

template <class Function>
std::uint64_t hash_over(double low, double high, const Function& function) {
  Hash hash;
  RandomSequence random{5};
  for (int i = 0; i <= kAngles; ++i) {
    add_to_hash(hash, function(low + (high - low) * i / kAngles));
    add_to_hash(hash, function(next_between(random, low, high)));
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double special : {0.0, -0.0, 1e300, -1e300, 0x1p-1074, kInfinity, -kInfinity,
                               std::numeric_limits<double>::quiet_NaN()}) {
    add_to_hash(hash, function(special));
  }
  return hash.value;
}

std::uint64_t hash_of_pow() {
  Hash hash;
  RandomSequence random{6};
  for (int i = 0; i < kAngles; ++i) {
    const double x = next_between(random, 0.0, 4.0);
    add_to_hash(hash, exact_math::pow(x, next_between(random, -8.0, 8.0)));
    add_to_hash(hash, exact_math::pow(x, 2.4));
  }
  for (const double x : {0.0, 1.0, std::numeric_limits<double>::infinity()}) {
    for (const double y : {-1.0, 0.0, 1.0}) add_to_hash(hash, exact_math::pow(x, y));
  }
  return hash.value;
}

}  // namespace

std::vector<NamedHash> number_hashes() {
  return {
      {"number half decoded", hash_of_decoding()},
      {"number half to nearest even", hash_of_encoding(HalfRounding::nearest_even)},
      {"number half toward zero", hash_of_encoding(HalfRounding::toward_zero)},
      {"number half as SwiftShader", hash_of_encoding(HalfRounding::swiftshader)},
      {"number unorm8 half up", hash_of_unorm8(UnormRounding::half_up)},
      {"number unorm8 to nearest even", hash_of_unorm8(UnormRounding::nearest_even)},
      {"number srgb8", hash_of_8_bits(srgb8_to_linear, linear_to_srgb8)},
      {"number snapped to subpixels", hash_of_snapping()},
      {"number multiply-add fused", hash_of_multiply_add(Contraction::fused)},
      {"number multiply-add unfused", hash_of_multiply_add(Contraction::unfused)},
      {"number sin", hash_over(-1080.0, 1080.0, exact_math::sin_degrees)},
      {"number cos", hash_over(-1080.0, 1080.0, exact_math::cos_degrees)},
      {"number tan", hash_over(-1080.0, 1080.0, exact_math::tan_degrees)},
      {"number exp2", hash_over(-1100.0, 1100.0, exact_math::exp2)},
      {"number log2", hash_over(0.0, 1000.0, exact_math::log2)},
      {"number pow", hash_of_pow()},
  };
}

}  // namespace softfocus
