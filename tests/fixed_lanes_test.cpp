// The fixed-point filter in vector lanes and on threads against the rows, bit for bit.

#include <array>
#include <string>

#include "dof/arithmetic.h"
#include "dof/fixed_rows.h"
#include "dof/fixed_two_pass.h"
#include "tests/fixed_pictures.h"

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
             : kind == 3 ? kHalfLargest
                         : static_cast<std::uint16_t>(0x3800 + any_below(random, 0x400));
    }
  }
  return made;
}

Image image_like(const Image& picture) {
  // What was there before must not show.
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

TEST_CASE("fixed point: every vector unit gives the bits of the rows, at every size and lens") {
  ThreadPool plain(1, Isa::scalar);
  for (const auto& random_of : {random_bytes, random_halves}) {
    for (const Isa isa : available_isas()) {
      ThreadPool pool(2, isa);
      Random random{8};
      for (int i = 0; i < 80; ++i) {
        const Lens lens = any_lens(random, i % 4 == 0 ? 64 : 10);
        const auto table = table8(lens, any_below(random, 3000000), any_below(random, 9000000));
        const int width = 1 + static_cast<int>(any_below(random, i % 8 == 0 ? 300 : 90));
        const int height = 1 + static_cast<int>(any_below(random, i % 8 == 1 ? 300 : 70));
        const PictureAndCodes input = random_of(random, width, height);
        INFO(std::string{isa_name(isa)}, ", picture ", i, ", ", width, "x", height);
        CHECK(same(in_lanes(input, table, pool), in_lanes(input, table, plain)));
      }
    }
  }
}

TEST_CASE("fixed point: the bits do not depend on the number of threads") {
  Random random{9};
  const Lens lens{30u << 16, 1000000, 16u << 16, 65536};
  const auto table = table8(lens, 300000, 5000000);
  ThreadPool one(1);
  for (const auto& random_of : {random_bytes, random_halves}) {
    const PictureAndCodes input = random_of(random, 530, 300);
    const Image expected = in_lanes(input, table, one);
    for (const int threads : {2, 3, 8}) {
      for (const Isa isa : {Isa::scalar, widest_isa()}) {
        ThreadPool pool(threads, isa);
        CAPTURE(threads);
        CHECK(same(in_lanes(input, table, pool), expected));
      }
    }
  }
}

TEST_CASE("fixed point: codes of 16 bits and in alpha give the bits of the rows") {
  ThreadPool plain(1, Isa::scalar);
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
        CHECK(same(filtered(pool, false), filtered(plain, false)));
        if (picture.format == Format::rgba16f) {
          CHECK(same(filtered(pool, true), filtered(plain, true)));
        }
      }
    }
  }
}

TEST_CASE("fixed point: a mean of the largest halves is not past them") {
  // What is rounded in taking part of a neighbour beyond makes the quotient larger by 1 / weight.
  constexpr Weights kSharp{1u << 19, 1u << 19, 32768, 0, 0};
  constexpr Weights kReceiver{2073, 1866, 32600, 15, 0};
  constexpr Weights kNeighbour{2048, 1, 32768, 15, 1};
  std::vector<Weights> table(256, kSharp);
  table[1] = kReceiver;
  table[2] = kNeighbour;
  PictureAndCodes input{make_image(Format::rgba16f, 80, 1), std::vector<std::uint8_t>(80)};
  std::ranges::fill(row<std::uint16_t>(input.picture, 0), kHalfLargest);
  input.codes[30] = 1;
  input.codes[45] = 2;
  for (const Isa isa : available_isas()) {
    ThreadPool pool(1, isa);
    CAPTURE(std::string{isa_name(isa)});
    CHECK(same(in_lanes(input, table, pool), input.picture));
  }
}

TEST_CASE("fixed point: depths as halves in lanes give the bits of the rows") {
  const Image scene = random_scene_image(100, 60, 5);
  const DofSettings settings{.coc = {12.0f, 2.0f}, .max_coc_px = 7.3f, .leak = 1.0f};
  ThreadPool plain(1, Isa::scalar);
  for (const Arithmetic arithmetic : {Arithmetic::fixed, Arithmetic::fixed_8}) {
    Image expected = make_image(Format::rgba16f, 100, 60);
    two_pass_in(arithmetic, {scene, settings, {}}, expected, plain);
    for (const Isa isa : available_isas()) {
      ThreadPool pool(2, isa);
      Image actual = make_image(Format::rgba16f, 100, 60);
      two_pass_in(arithmetic, {scene, settings, {}}, actual, pool);
      CHECK(equal(actual, expected));
    }
  }
}
