#include "raster/passes/over.h"

#include <doctest/doctest.h>

#include <array>
#include <vector>

#include "raster/lanes/isa.h"
#include "tests/support/random.h"

using namespace softfocus;

namespace {

using Row = std::vector<std::uint16_t>;

Row row_of(std::array<float, 4> texel, int width) {
  Row halves;
  for (int x = 0; x < width; ++x) {
    for (const float value : texel) {
      halves.push_back(float_to_half(value, HalfRounding::nearest_even));
    }
  }
  return halves;
}

Row random_row(int width, std::uint64_t seed) {
  test::Random random{seed};
  Row halves;
  for (int i = 0; i < 4 * width; ++i) {
    halves.push_back(static_cast<std::uint16_t>(random.whole(0, 65535)));
  }
  return halves;
}

}  // namespace

TEST_CASE("over: colour plus what the opacity lets through, and the picture's own alpha") {
  const Row colour = row_of({0.25f, 0.5f, 0.125f, 9.0f}, 1);
  const Row opacity = row_of({0.25f, 0.5f, 1.0f, 9.0f}, 1);
  Row below = row_of({1.0f, 1.0f, 1.0f, 7.0f}, 1);
  lay_over({colour.data(), opacity.data(), 1}, HalfRounding::nearest_even, below.data(),
           Isa::scalar);
  CHECK(below == row_of({1.0f, 1.0f, 0.125f, 7.0f}, 1));
}

TEST_CASE("over: nothing laid over a picture leaves its bits, whatever they are") {
  const Row nothing(4 * 1000, 0);
  Row below = random_row(1000, 3);
  const Row before = below;
  for (const Isa isa : available_isas()) {
    lay_over({nothing.data(), nothing.data(), 1000}, HalfRounding::nearest_even, below.data(), isa);
    CHECK(below == before);
  }
}

TEST_CASE("over: an opacity outside 0 to 1 is cut, and NaN hides nothing") {
  const Row colour = row_of({0.5f, 0.5f, 0.5f, 0.0f}, 1);
  const Row opacity = row_of({-1.0f, 2.0f, 0.0f, 0.0f}, 1);
  Row of_nan = opacity;
  of_nan[2] = 0x7E00;
  Row below = row_of({0.25f, 0.25f, 0.25f, 1.0f}, 1);
  lay_over({colour.data(), of_nan.data(), 1}, HalfRounding::nearest_even, below.data(),
           Isa::scalar);
  CHECK(below == row_of({0.75f, 0.5f, 0.75f, 1.0f}, 1));
}

TEST_CASE("over: the same bits on every vector unit, for any halves, width and rounding") {
  for (const HalfRounding rounding :
       {HalfRounding::nearest_even, HalfRounding::toward_zero, HalfRounding::swiftshader}) {
    for (const int width : {1, 3, 4, 15, 16, 17, 64, 333}) {
      const Row colour = random_row(width, 5), opacity = random_row(width, 6);
      Row expected = random_row(width, 7);
      const Row below = expected;
      lay_over({colour.data(), opacity.data(), width}, rounding, expected.data(), Isa::scalar);
      take_depths(opacity.data(), width, expected.data(), Isa::scalar);
      for (const Isa isa : available_isas()) {
        Row laid = below;
        lay_over({colour.data(), opacity.data(), width}, rounding, laid.data(), isa);
        take_depths(opacity.data(), width, laid.data(), isa);
        INFO(isa_name(isa), ", ", width);
        CHECK(laid == expected);
      }
    }
  }
}

TEST_CASE("over: the depth is that of the layer from an opacity of 1/2 on") {
  Row below = row_of({0.0f, 0.0f, 0.0f, 5.0f}, 2);
  Row opacity = row_of({0.5f, 0.0f, 0.0f, 2.0f}, 2);
  opacity[4] = float_to_half(0.4995f, HalfRounding::nearest_even);
  take_depths(opacity.data(), 2, below.data(), Isa::scalar);
  CHECK(half_to_float(below[3]) == 2.0f);
  CHECK(half_to_float(below[7]) == 5.0f);
}
