// The integer filter in lanes, on threads, against its scalar form, bit for bit.

#include <array>
#include <cstdlib>
#include <string>

#include "dof/fixed/weights.h"
#include "dof/fixed_pictures/arithmetic.h"
#include "dof/fixed_pictures/fixed_two_pass.h"
#include "dof/focus_map.h"
#include "tests/support/fixed_pictures.h"
#include "tests/support/sanitizers.h"

using namespace softfocus;
using namespace softfocus::fixed;

namespace {

struct PictureAndCodes {
  Image picture;
  std::vector<std::uint8_t> codes;
};

PictureAndCodes random_bytes(Random& random, int width, int height) {
  const Settings settings{static_cast<std::uint16_t>(width), static_cast<std::uint16_t>(height), 0,
                          SOFTFOCUS_FIXED_RGBA8, SOFTFOCUS_FIXED_DEPTH8};
  const PackedPicture packed = random_picture(random, settings);
  PictureAndCodes made{make_image(Format::rgba8, width, height), packed.depths};
  auto from = packed.colours.begin();
  for (int y = 0; y < height; ++y) {
    for (std::uint8_t& byte : row<std::uint8_t>(made.picture, y)) byte = *from++;
  }
  return made;
}

/// Any halves, or only such as lie at an end of something: ties, zeros, what is not finite.
PictureAndCodes random_halves(Random& random, int width, int height) {
  constexpr std::array<std::uint16_t, 14> kEnds{0x0000, 0x8000, 0x0001, 0x8001, 0x03FF,
                                                0x0400, 0x3C00, 0x3C01, 0xBC01, 0x7BFF,
                                                0xFBFF, 0x7C00, 0xFC00, 0x7E00};
  PictureAndCodes made = random_bytes(random, width, height);
  made.picture = make_image(Format::rgba16f, width, height);
  const std::uint32_t kind = any_below(random, 5);
  const std::uint32_t first = any_below(random, 13);
  for (int y = 0; y < height; ++y) {
    for (std::uint16_t& half : row<std::uint16_t>(made.picture, y)) {
      half = kind == 0   ? static_cast<std::uint16_t>(random.next())
             : kind == 1 ? kEnds[any_below(random, 14)]
             : kind == 2 ? kEnds[first + any_below(random, 2)]
             : kind == 3 ? softfocus::kHalfLargest
                         : static_cast<std::uint16_t>(0x3800 + any_below(random, 0x400));
    }
  }
  return made;
}

Image image_like(const Image& picture) {
  // The result's old contents must not show.
  Image result = make_image(picture.format, picture.width, picture.height);
  std::ranges::fill(result.bytes, std::byte{0x5A});
  return result;
}

Image in_lanes(const PictureAndCodes& input, const std::vector<Weights>& table, ThreadPool& pool) {
  Image result = image_like(input.picture);
  fixed_two_pass(input.picture, input.codes, fixed_table(table), result, pool);
  return result;
}

template <class Number>
bool same_rows(const Image& a, const Image& b) {
  for (int y = 0; y < a.height; ++y) {
    if (!std::ranges::equal(row<Number>(a, y), row<Number>(b, y))) return false;
  }
  return true;
}

bool same(const Image& a, const Image& b) {
  return a.format == Format::rgba8 ? same_rows<std::uint8_t>(a, b) : same_rows<std::uint16_t>(a, b);
}

}  // namespace

TEST_CASE("fixed point: every vector unit gives the scalar bits, whatever size and lens") {
  ThreadPool scalar(1, Isa::scalar);
  for (const auto& random_of : {random_bytes, random_halves}) {
    for (const Isa isa : available_isas()) {
      ThreadPool pool(2, isa);
      Random random{8};
      for (int i = 0; i < fewer(80); ++i) {
        const Lens lens = any_lens(random, i % 4 < 2 ? 64 : 10);
        const auto table = table8(lens, any_below(random, 3000000), any_below(random, 9000000));
        const int width = 1 + static_cast<int>(any_below(random, i % 8 == 0 ? 300 : 90));
        const int height = 1 + static_cast<int>(any_below(random, i % 8 == 1 ? 300 : 70));
        const PictureAndCodes input = random_of(random, width, height);
        INFO(std::string{isa_name(isa)}, ", picture ", i, ", ", width, "x", height);
        CHECK(same(in_lanes(input, table, pool), in_lanes(input, table, scalar)));
      }
    }
  }
}

TEST_CASE("fixed point: lines have room for every reach, also in strips beside others") {
  ThreadPool scalar(1, Isa::scalar);
  Random random{12};
  for (const auto& random_of : {random_bytes, random_halves}) {
    // One strip lies between two others, side by side or one above the other.
    for (const int width : {70, 1090}) {
      const int height = width == 70 ? 400 : 30;
      const PictureAndCodes input = random_of(random, width, height);
      for (const std::uint32_t radius_px : {1u, 2u, 16u, 17u, 18u, 33u, 34u, 49u, 64u}) {
        if (kHasSanitizers && radius_px % 16 != 1 && radius_px != 64) continue;
        const Lens lens{200u << 16, 1000000, radius_px << 16, 65536};
        const auto table = table8(lens, 300000, 5000000);
        const Image expected = in_lanes(input, table, scalar);
        for (const Isa isa : available_isas()) {
          ThreadPool pool(3, isa);
          INFO(std::string{isa_name(isa)}, ", radius ", radius_px, ", ", width, "x", height);
          CHECK(same(in_lanes(input, table, pool), expected));
        }
      }
    }
  }
}

TEST_CASE("fixed point: the largest sums do not overflow") {
  // Every pixel reaches the one in the middle, and weighs the most that it can there.
  constexpr int kWidth = 200, kMiddle = 100;
  std::vector<Weights> table;
  for (std::uint32_t reach = 0; reach < 256; ++reach) {
    const std::uint64_t radius = std::uint64_t{std::min(reach, 63u) + 1} << 16;
    table.push_back(make_weights(radius, SOFTFOCUS_FIXED_ONE_PIXEL, reach % 2 != 0));
  }
  PictureAndCodes bytes{make_image(Format::rgba8, kWidth, 1), {}};
  std::ranges::fill(row<std::uint8_t>(bytes.picture, 0), std::uint8_t{255});
  Picture3<std::int64_t> channels{kWidth, 1, {}};
  std::vector<Weights> weights;
  for (int x = 0; x < kWidth; ++x) {
    bytes.codes.push_back(static_cast<std::uint8_t>(std::min(std::abs(x - kMiddle), 63)));
    weights.push_back(table[bytes.codes.back()]);
    channels.pixels.push_back({255, 255, 255});
  }
  const Picture3<std::int64_t> exact = wide_filter8(channels, weights);
  std::uint64_t sum = 0;
  for (int x = 0; x < kWidth; ++x) {
    if (weights[static_cast<std::size_t>(x)].reach >= std::abs(x - kMiddle)) {
      sum += weights[static_cast<std::size_t>(x)].edge;
    }
  }
  CHECK(sum > 1150000);  // of 1,200,701
  for (const std::uint16_t half : {std::uint16_t{0x7BFF}, std::uint16_t{0xFBFF}}) {
    PictureAndCodes halves{make_image(Format::rgba16f, kWidth, 1), bytes.codes};
    std::ranges::fill(row<std::uint16_t>(halves.picture, 0), half);
    for (const Isa isa : available_isas()) {
      ThreadPool pool(1, isa);
      INFO(std::string{isa_name(isa)}, ", half ", half);
      CHECK(same(in_lanes(halves, table, pool), halves.picture));
      const Image filtered = in_lanes(bytes, table, pool);
      for (int x = 0; x < kWidth; ++x) {
        const auto at = static_cast<std::size_t>(4 * x);
        CHECK(row<std::uint8_t>(filtered, 0)[at] == exact.pixels[static_cast<std::size_t>(x)][0]);
      }
    }
  }
}

TEST_CASE("fixed point: pictures that are written past the caches are whole") {
  // Larger than what write_past_caches() leaves to them. Nothing is blurred: it comes out as
  // it is.
  const Lens lens{0, 1000000, 1u << 16, 65536};
  const FixedTable table = fixed_table(table8(lens, 300000, 5000000));
  Image halves = make_image(Format::rgba16f, 1501, 1501);
  Image bytes = make_image(Format::rgba8, 2049, 2049);
  REQUIRE(write_past_caches(halves));
  REQUIRE(write_past_caches(bytes));
  Random random{13};
  for (int y = 0; y < halves.height; ++y) {
    for (std::uint16_t& half : row<std::uint16_t>(halves, y)) {
      half = static_cast<std::uint16_t>(random.next() & 0x3BFF);
    }
  }
  for (int y = 0; y < bytes.height; ++y) {
    for (std::uint8_t& byte : row<std::uint8_t>(bytes, y)) {
      byte = static_cast<std::uint8_t>(random.next());
    }
  }
  for (const Image* picture : {&halves, &bytes}) {
    const std::vector<std::uint8_t> codes(static_cast<std::size_t>(picture->width) *
                                          static_cast<std::size_t>(picture->height));
    for (const Isa isa : available_isas()) {
      if (isa == Isa::scalar) continue;
      ThreadPool pool(2, isa);
      Image result = image_like(*picture);
      fixed_two_pass(*picture, codes, table, result, pool);
      CAPTURE(std::string{isa_name(isa)});
      CHECK(same(result, *picture));
    }
  }
}

TEST_CASE("fixed point: the bits do not depend on the number of threads" *
          doctest::test_suite("threads long")) {
  Random random{9};
  const Lens lens{200u << 16, 1000000, 64u << 16, 65536};
  const auto table = table8(lens, 300000, 5000000);
  ThreadPool one(1);
  for (const auto& random_of : {random_bytes, random_halves}) {
    const PictureAndCodes input = random_of(random, 530, 300);
    const Image expected = in_lanes(input, table, one);
    for (const int threads : {3, 8}) {
      for (const Isa isa : {Isa::scalar, widest_isa()}) {
        ThreadPool pool(threads, isa);
        CAPTURE(threads);
        CHECK(same(in_lanes(input, table, pool), expected));
      }
    }
  }
}

TEST_CASE("fixed point: codes of 16 bits and codes in alpha give the scalar bits") {
  ThreadPool scalar(1, Isa::scalar);
  Random random{10};
  for (int i = 0; i < 12; ++i) {
    const FixedTable table = fixed_table(half_table(any_lens(random, i % 4 == 0 ? 64 : 10)));
    for (const auto& random_of : {random_bytes, random_halves}) {
      const PictureAndCodes input = random_of(random, 40 + 3 * i, 50 - 4 * i);
      const Image& picture = input.picture;
      std::vector<std::uint16_t> codes;
      for (const std::uint8_t code : input.codes) {
        codes.push_back(static_cast<std::uint16_t>(0x3A00 + 8 * code));
      }
      const auto filtered = [&](ThreadPool& pool, bool in_alpha) {
        Image result = image_like(picture);
        if (in_alpha) {
          fixed_two_pass(picture, table, result, pool);
        } else {
          fixed_two_pass(picture, codes, table, result, pool);
        }
        return result;
      };
      for (const Isa isa : available_isas()) {
        ThreadPool pool(2, isa);
        INFO(std::string{isa_name(isa)}, ", picture ", i);
        CHECK(same(filtered(pool, false), filtered(scalar, false)));
        if (picture.format == Format::rgba16f) {
          CHECK(same(filtered(pool, true), filtered(scalar, true)));
        }
      }
    }
  }
}

TEST_CASE("fixed point: a mean of the largest halves is the largest half") {
  // Rounding a part of a neighbour beyond makes the quotient larger by 1 / weight.
  constexpr Weights kSharp{1u << 19, 1u << 19, 32768, 0, 0};
  constexpr Weights kReceiver{2073, 1866, 32600, 15, 0};
  constexpr Weights kNeighbour{2048, 1, 32768, 15, 1};
  std::vector<Weights> table(256, kSharp);
  table[1] = kReceiver;
  table[2] = kNeighbour;
  PictureAndCodes input{make_image(Format::rgba16f, 80, 1), std::vector<std::uint8_t>(80)};
  std::ranges::fill(row<std::uint16_t>(input.picture, 0), softfocus::kHalfLargest);
  input.codes[30] = 1;
  input.codes[45] = 2;
  for (const Isa isa : available_isas()) {
    ThreadPool pool(1, isa);
    CAPTURE(std::string{isa_name(isa)});
    CHECK(same(in_lanes(input, table, pool), input.picture));
  }
}

TEST_CASE("fixed point: depths as halves give the scalar bits") {
  const Image scene = random_scene_image(100, 60, 5);
  const DofSettings settings{.coc = {12.0f, 2.0f}, .max_coc_px = 7.3f, .leak = 1.0f};
  ThreadPool scalar(1, Isa::scalar);
  for (const Arithmetic arithmetic : {Arithmetic::fixed, Arithmetic::fixed_8}) {
    Image expected = make_image(Format::rgba16f, 100, 60);
    two_pass_in(arithmetic, {scene, settings, {}}, expected, scalar);
    for (const Isa isa : available_isas()) {
      ThreadPool pool(2, isa);
      Image actual = make_image(Format::rgba16f, 100, 60);
      two_pass_in(arithmetic, {scene, settings, {}}, actual, pool);
      CHECK(equal(actual, expected));
    }
  }
}
