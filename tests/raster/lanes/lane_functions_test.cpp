// Every function of vector lanes against its scalar form, on every vector unit that this
// CPU has.

#ifndef SOFTFOCUS_ISA

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "raster/numbers/fixed_point.h"
#include "tests/support/test_images.h"

#define SOFTFOCUS_KERNELS "tests/raster/lanes/lane_functions_test.cpp"
#include "raster/lanes/for_each_isa.inl"

using namespace softfocus;

namespace {

constexpr std::size_t kMost = kMostLanes;

std::span<const Isa> units() { return available_isas().subspan(1); }

std::size_t lanes(Isa isa) { return static_cast<std::size_t>(lanes_of(isa)); }

// Same bits, or both NaN: a NaN's bits are the processor's.
bool same(float a, float b) {
  return a != a ? b != b : std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}
const auto kEqual = [](auto a, auto b) { return a == b; };

// Every upper half of a float, each with several lower ones.
std::vector<float> floats_of_all_kinds() {
  std::vector<float> floats;
  for (std::uint32_t upper = 0; upper < 0x10000; ++upper) {
    for (const std::uint32_t lower : {0x0000u, 0x0001u, 0x7FFFu, 0x8000u, 0xD5A3u, 0xFFFFu}) {
      floats.push_back(std::bit_cast<float>(upper << 16 | lower));
    }
  }
  return floats;  // a multiple of 16
}

// All halves, what lies half-way to the next one, and the neighbours of both.
std::vector<float> floats_about_halves() {
  std::vector<float> floats;
  for (int half = 0; half < kHalfInfinity; ++half) {
    const float value = half_to_float(static_cast<std::uint16_t>(half));
    const float next =
        half == kHalfLargest ? 65536.0f : half_to_float(static_cast<std::uint16_t>(half + 1));
    for (const float about : {value, (value + next) / 2}) {
      for (const float magnitude :
           {std::nextafter(about, -1e30f), about, std::nextafter(about, 1e30f)}) {
        floats.push_back(magnitude);
        floats.push_back(-magnitude);
      }
    }
  }
  while (floats.size() % kMost != 0) floats.push_back(0.0f);
  return floats;
}

// Checks kernel(arguments, results) against scalar(argument), a vector at a time.
template <class Result, class Argument, class Kernel, class Scalar, class Equal>
void check_all(Isa isa, const std::vector<Argument>& arguments, Kernel kernel, Scalar scalar,
               Equal equal_results) {
  int wrong = 0;
  for (std::size_t i = 0; i < arguments.size(); i += lanes(isa)) {
    std::array<Result, kMost> results{};
    kernel(&arguments[i], results.data());
    for (std::size_t lane = 0; lane < lanes(isa); ++lane) {
      const Result expected = scalar(arguments[i + lane]);
      if (!equal_results(results[lane], expected)) ++wrong;
    }
  }
  INFO(std::string{isa_name(isa)});
  CHECK(wrong == 0);
}

// Any numbers, the unusual often.
std::vector<float> mixed_floats(std::size_t count, std::uint64_t seed) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr std::array kUnusual{0.0f,   -0.0f,   1.0f,      -1.0f,      kInfinity, -kInfinity,
                                1e-45f, -1e-40f, 0x1p-126f, 0x1.8p127f, kNan,      0.1f};
  Random random{seed};
  std::vector<float> floats;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t chance = random.next();
    floats.push_back(chance % 3 == 0
                         ? kUnusual[chance / 3 % kUnusual.size()]
                         : std::bit_cast<float>(static_cast<std::uint32_t>(chance >> 32)));
  }
  return floats;
}

}  // namespace

TEST_CASE("a vector unit's kernels are compiled for its number of lanes") {
  for (const Isa isa : units()) {
    CHECK(SOFTFOCUS_KERNEL(isa, kLanes) == lanes_of(isa));
    CHECK(lanes_of(isa) <= kMostLanes);
  }
}

TEST_CASE("lanes turn every half into the float that it is") {
  std::vector<std::uint32_t> halves;
  for (std::uint32_t half = 0; half < 0x10000; ++half) halves.push_back(half);
  for (const Isa isa : units()) {
    check_all<float>(
        isa, halves, SOFTFOCUS_KERNEL(isa, lanes_half_to_float),
        [](std::uint32_t half) { return half_to_float(static_cast<std::uint16_t>(half)); }, same);
  }
}

TEST_CASE("lanes turn halves that lie side by side into floats") {
  std::vector<std::uint16_t> halves(0x10000);
  for (std::size_t i = 0; i < halves.size(); ++i) halves[i] = static_cast<std::uint16_t>(i);
  for (const Isa isa : units()) {
    const auto count = static_cast<std::size_t>(lanes(isa));
    std::array<float, kMost> floats{};
    for (std::size_t i = 0; i < halves.size(); i += count) {
      SOFTFOCUS_KERNEL(isa, lanes_load_halves)(&halves[i], floats.data());
      for (std::size_t lane = 0; lane < count; ++lane) {
        REQUIRE(same(floats[lane], half_to_float(halves[i + lane])));
      }
    }
  }
}

TEST_CASE("lanes round floats of all kinds to the scalar form's half") {
  for (const std::vector<float>& floats : {floats_of_all_kinds(), floats_about_halves()}) {
    for (const Isa isa : units()) {
      check_all<std::uint32_t>(
          isa, floats, SOFTFOCUS_KERNEL(isa, lanes_to_half_nearest),
          [](float value) { return float_to_half(value, HalfRounding::nearest_even); }, kEqual);
      check_all<std::uint32_t>(
          isa, floats, SOFTFOCUS_KERNEL(isa, lanes_to_half_toward_zero),
          [](float value) { return float_to_half(value, HalfRounding::toward_zero); }, kEqual);
      check_all<std::uint32_t>(
          isa, floats, SOFTFOCUS_KERNEL(isa, lanes_to_half_swiftshader),
          [](float value) { return float_to_half(value, HalfRounding::swiftshader); }, kEqual);
    }
  }
}

TEST_CASE("lanes round to whole numbers, take roots and magnitudes as the scalar functions do") {
  for (const std::vector<float>& floats : {floats_of_all_kinds(), floats_about_halves()}) {
    for (const Isa isa : units()) {
      check_all<float>(
          isa, floats, SOFTFOCUS_KERNEL(isa, lanes_floor), [](float v) { return std::floor(v); },
          same);
      check_all<float>(
          isa, floats, SOFTFOCUS_KERNEL(isa, lanes_nearest),
          [](float v) { return std::nearbyint(v); }, same);
      check_all<float>(
          isa, floats, SOFTFOCUS_KERNEL(isa, lanes_square_root),
          [](float v) { return std::sqrt(v); }, same);
      check_all<float>(
          isa, floats, SOFTFOCUS_KERNEL(isa, lanes_absolute), [](float v) { return std::fabs(v); },
          same);
      check_all<std::int32_t>(
          isa, floats, SOFTFOCUS_KERNEL(isa, lanes_truncate_to_int),
          [](float v) { return truncate_to_int(v); }, kEqual);
      check_all<std::int32_t>(
          isa, floats, SOFTFOCUS_KERNEL(isa, lanes_round_to_int),
          [](float v) { return round_to_int(v); }, kEqual);
    }
  }
}

TEST_CASE("lanes choose, compare and fuse as the scalar expressions do") {
  const std::vector<float> a = mixed_floats(48000, 1), b = mixed_floats(48000, 2),
                           c = mixed_floats(48000, 3);
  for (const Isa isa : units()) {
    int wrong = 0;
    for (std::size_t i = 0; i < a.size(); i += lanes(isa)) {
      std::array<float, kMost> less{}, more{}, chosen{}, fused{}, same_in_all{};
      SOFTFOCUS_KERNEL(isa, lanes_smaller)(&a[i], &b[i], less.data());
      SOFTFOCUS_KERNEL(isa, lanes_larger)(&a[i], &b[i], more.data());
      SOFTFOCUS_KERNEL(isa, lanes_select_less)(&a[i], &b[i], chosen.data());
      SOFTFOCUS_KERNEL(isa, lanes_fused_multiply_add)(&a[i], &b[i], &c[i], fused.data());
      SOFTFOCUS_KERNEL(isa, lanes_splat)(&a[i], same_in_all.data());
      for (std::size_t lane = 0; lane < lanes(isa); ++lane) {
        const float x = a[i + lane], y = b[i + lane], z = c[i + lane];
        const bool right = same(less[lane], x < y ? x : y) && same(more[lane], x > y ? x : y) &&
                           same(chosen[lane], x < y ? x : y * 2.0f) &&
                           same(fused[lane], std::fma(x, y, z)) && same(same_in_all[lane], a[i]);
        if (!right) ++wrong;
      }
    }
    INFO(std::string{isa_name(isa)});
    CHECK(wrong == 0);
  }
}

TEST_CASE("lanes tell which, whether any and whether all") {
  for (const Isa isa : units()) {
    const auto count = static_cast<unsigned>(lanes(isa));
    const unsigned all = (1u << count) - 1;
    for (unsigned bits = 0; bits <= all; ++bits) {
      std::array<std::int32_t, kMost> values{}, kept{};
      std::vector<std::int32_t> expected;
      for (unsigned lane = 0; lane < count; ++lane) {
        const bool set = (bits >> lane & 1u) != 0;
        values[lane] = set ? static_cast<int>(lane) + 5 : -static_cast<int>(lane);
        if (set) expected.push_back(values[lane]);
      }
      REQUIRE(SOFTFOCUS_KERNEL(isa, lanes_positive_bits)(values.data()) == bits);
      // Lane 0 is 5 or 0.
      REQUIRE(SOFTFOCUS_KERNEL(isa, lanes_sign_bits)(values.data()) == (all & ~1u & ~bits));
      REQUIRE(SOFTFOCUS_KERNEL(isa, lanes_any_positive)(values.data()) == (bits != 0));
      REQUIRE(SOFTFOCUS_KERNEL(isa, lanes_all_positive)(values.data()) == (bits == all));
      const int left = SOFTFOCUS_KERNEL(isa, lanes_compress_positive)(values.data(), kept.data());
      REQUIRE(std::vector<std::int32_t>(kept.begin(), kept.begin() + left) == expected);
    }
    for (unsigned first = 0; first <= count; ++first) {
      CHECK(SOFTFOCUS_KERNEL(isa, lanes_first)(static_cast<int>(first)) == (1u << first) - 1);
    }
  }
}

TEST_CASE("lanes gather where the mask says, and leave 0 elsewhere") {
  std::array<std::int32_t, 100> numbers{};
  std::array<float, 100> floats{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = static_cast<int>(i * i) + 1;
    floats[i] = static_cast<float>(i) + 0.5f;
  }
  Random random{4};
  for (const Isa isa : units()) {
    for (int round = 0; round < 1000; ++round) {
      std::array<std::int32_t, kMost> index{}, got{};
      std::array<float, kMost> got_floats{};
      for (std::int32_t& i : index) i = static_cast<int>(random.next() % 150) - 50;
      SOFTFOCUS_KERNEL(isa, lanes_gather_ints)(numbers.data(), index.data(), got.data());
      SOFTFOCUS_KERNEL(isa, lanes_gather_floats)(floats.data(), index.data(), got_floats.data());
      for (std::size_t lane = 0; lane < lanes(isa); ++lane) {
        const auto at = static_cast<std::size_t>(std::max(index[lane], 0));
        REQUIRE(got[lane] == (index[lane] < 0 ? 0 : numbers[at % 100]));
        REQUIRE(got_floats[lane] == (index[lane] < 0 ? 0.0f : floats[at % 100]));
      }
    }
  }
}

TEST_CASE("lanes and vectors change places in a transposition") {
  for (const Isa isa : units()) {
    const std::size_t n = lanes(isa);
    std::array<float, kMost * kMost> rows{}, columns{};
    for (std::size_t i = 0; i < n * n; ++i) rows[i] = static_cast<float>(i);
    SOFTFOCUS_KERNEL(isa, lanes_transpose)(rows.data(), columns.data());
    for (std::size_t i = 0; i < n * n; ++i) CHECK(columns[i] == rows[i % n * n + i / n]);
  }
}

TEST_CASE("lanes take pixels of halves apart and put them together") {
  Random random{5};
  for (const Isa isa : units()) {
    const std::size_t n = lanes(isa);
    std::array<std::uint16_t, 4 * kMost> texels{}, back{};
    for (std::uint16_t& half : texels) half = static_cast<std::uint16_t>(random.next());
    std::array<std::uint32_t, 4 * kMost> channels{};
    SOFTFOCUS_KERNEL(isa, lanes_load_texels)(texels.data(), channels.data());
    SOFTFOCUS_KERNEL(isa, lanes_store_texels)(channels.data(), back.data());
    for (std::size_t i = 0; i < 4 * n; ++i) {
      CHECK(channels[i % 4 * n + i / 4] == texels[i]);
      CHECK(back[i] == texels[i]);
    }
  }
}

TEST_CASE("lanes: pairs of signed 16-bit numbers are multiplied and added in 32 bits") {
  std::vector<std::int32_t> a, b;
  std::uint32_t state = 1;
  for (int i = 0; i < 4096; ++i) {
    for (std::vector<std::int32_t>* list : {&a, &b}) {
      state = state * 1664525u + 1013904223u;
      // -2^15 in all four gives 2^31, which no lane holds.
      const std::uint32_t low = state >> 8 & 7u;
      const std::uint32_t word = low == 0 ? 0x7FFF7FFFu : low == 1 ? 0x80018001u : state;
      list->push_back(static_cast<std::int32_t>(word));
    }
  }
  for (const Isa isa : units()) {
    int wrong = 0;
    for (std::size_t i = 0; i < a.size(); i += lanes(isa)) {
      std::array<std::int32_t, kMost> results{};
      SOFTFOCUS_KERNEL(isa, lanes_multiply_add_pairs)(&a[i], &b[i], results.data());
      for (std::size_t lane = 0; lane < lanes(isa); ++lane) {
        const std::int32_t x = a[i + lane], y = b[i + lane];
        const std::int64_t expected =
            std::int64_t{static_cast<std::int16_t>(x)} * static_cast<std::int16_t>(y) +
            std::int64_t{x >> 16} * (y >> 16);
        if (expected < 0x80000000 && results[lane] != expected) ++wrong;
      }
    }
    INFO(std::string{isa_name(isa)});
    CHECK(wrong == 0);
  }
}

TEST_CASE("lanes: a rough reciprocal is wrong by less than 2^-11") {
  std::vector<float> weights;
  for (int i = 1; i <= 1 << 21; i += i < 4096 ? 1 : 97) weights.push_back(static_cast<float>(i));
  while (weights.size() % kMost != 0) weights.push_back(1.0f);
  for (const Isa isa : units()) {
    double most = 0;
    for (std::size_t i = 0; i < weights.size(); i += lanes(isa)) {
      std::array<float, kMost> results{};
      SOFTFOCUS_KERNEL(isa, lanes_rough_reciprocal)(&weights[i], results.data());
      for (std::size_t lane = 0; lane < lanes(isa); ++lane) {
        const double product = static_cast<double>(results[lane]) * weights[i + lane];
        most = std::max(most, std::fabs(product - 1.0));
      }
    }
    INFO(std::string{isa_name(isa)});
    CHECK(most < 0x1p-11);
  }
}

TEST_CASE("lanes: pairs of numbers are gathered from a table of pairs") {
  std::vector<std::int32_t> table(2 * 65536);
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<std::int32_t>(i * 40503u);
  std::array<std::int32_t, kMost> index{};
  for (std::size_t i = 0; i < kMost; ++i) index[i] = static_cast<std::int32_t>(i * i * 291 % 65536);
  index[3] = 65535;
  for (const Isa isa : units()) {
    std::array<std::int32_t, kMost> first{}, second{};
    SOFTFOCUS_KERNEL(isa, lanes_gather_pairs)
    (table.data(), index.data(), first.data(), second.data());
    INFO(std::string{isa_name(isa)});
    for (std::size_t lane = 0; lane < lanes(isa); ++lane) {
      const auto at = 2 * static_cast<std::size_t>(index[lane]);
      CHECK(first[lane] == table[at]);
      CHECK(second[lane] == table[at + 1]);
    }
  }
}

#else  // once a vector unit

void lanes_half_to_float(const std::uint32_t* a, float* to) { store(to, half_to_float(load(a))); }
void lanes_load_halves(const std::uint16_t* a, float* to) { store(to, load_halves(a)); }
void lanes_to_half_nearest(const float* a, std::uint32_t* to) {
  store(to, float_to_half<HalfRounding::nearest_even>(load(a)));
}
void lanes_to_half_toward_zero(const float* a, std::uint32_t* to) {
  store(to, float_to_half<HalfRounding::toward_zero>(load(a)));
}
void lanes_to_half_swiftshader(const float* a, std::uint32_t* to) {
  store(to, float_to_half<HalfRounding::swiftshader>(load(a)));
}

void lanes_floor(const float* a, float* to) { store(to, floor(load(a))); }
void lanes_nearest(const float* a, float* to) { store(to, nearest(load(a))); }
void lanes_square_root(const float* a, float* to) { store(to, square_root(load(a))); }
void lanes_absolute(const float* a, float* to) { store(to, absolute(load(a))); }
void lanes_splat(const float* a, float* to) { store(to, splat(*a)); }
void lanes_truncate_to_int(const float* a, std::int32_t* to) {
  store(to, truncate_to_int(load(a)));
}
void lanes_round_to_int(const float* a, std::int32_t* to) { store(to, round_to_int(load(a))); }

void lanes_smaller(const float* a, const float* b, float* to) {
  store(to, smaller(load(a), load(b)));
}
void lanes_larger(const float* a, const float* b, float* to) {
  store(to, larger(load(a), load(b)));
}
void lanes_select_less(const float* a, const float* b, float* to) {
  const Floats x = load(a), y = load(b);
  store(to, select(x < y, x, y * 2.0f));
}
void lanes_fused_multiply_add(const float* a, const float* b, const float* c, float* to) {
  store(to, fused_multiply_add(load(a), load(b), load(c)));
}

void lanes_multiply_add_pairs(const std::int32_t* a, const std::int32_t* b, std::int32_t* to) {
  store(to, multiply_add_pairs(load(a), load(b)));
}
void lanes_gather_pairs(const std::int32_t* base, const std::int32_t* index, std::int32_t* first,
                        std::int32_t* second) {
  const IntPairs pairs = gather_pairs(base, load(index));
  store(first, pairs.first);
  store(second, pairs.second);
}
void lanes_rough_reciprocal(const float* a, float* to) { store(to, rough_reciprocal(load(a))); }

unsigned lanes_positive_bits(const std::int32_t* a) { return lane_bits(load(a) > 0); }
unsigned lanes_sign_bits(const std::int32_t* a) { return sign_bits(load(a)); }
bool lanes_any_positive(const std::int32_t* a) { return any(load(a) > 0); }
bool lanes_all_positive(const std::int32_t* a) { return all(load(a) > 0); }
unsigned lanes_first(int count) { return lane_bits(first_lanes(count)); }

/// base[index] where the index is not negative.
void lanes_gather_ints(const std::int32_t* base, const std::int32_t* index, std::int32_t* to) {
  const Ints i = load(index);
  store(to, gather(base, i, i >= 0));
}
void lanes_gather_floats(const float* base, const std::int32_t* index, float* to) {
  const Ints i = load(index);
  store(to, gather(base, i, i >= 0));
}
int lanes_compress_positive(const std::int32_t* a, std::int32_t* to) {
  const Ints v = load(a);
  const Compression kept = compression(v > 0);
  store(to, compress(v, kept));
  const Floats floats = compress(to_floats(v), kept);
  return all(truncate(floats) == load(to)) ? __builtin_popcount(lane_bits(v > 0)) : -1;
}
void lanes_transpose(const float* rows, float* to) {
  Floats v[kLanes];
  for (int i = 0; i < kLanes; ++i) v[i] = load(rows + i * kLanes);
  transpose(v);
  for (int i = 0; i < kLanes; ++i) store(to + i * kLanes, v[i]);
}

/// The channels, one after the other.
void lanes_load_texels(const std::uint16_t* from, std::uint32_t* to) {
  const HalfTexels texels = load_half_texels(from);
  store(to, texels.r);
  store(to + kLanes, texels.g);
  store(to + 2 * kLanes, texels.b);
  store(to + 3 * kLanes, texels.a);
}
void lanes_store_texels(const std::uint32_t* from, std::uint16_t* to) {
  store_half_texels(
      to, {load(from), load(from + kLanes), load(from + 2 * kLanes), load(from + 3 * kLanes)});
}

#endif
