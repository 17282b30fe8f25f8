// The fixed-point filter in vector lanes and on threads against the rows, bit for bit.

#include "dof/arithmetic.h"
#include "dof/fixed_rows.h"
#include "dof/fixed_two_pass.h"
#include "tests/fixed_pictures.h"

using namespace softfocus;
using namespace softfocus::fixed;

namespace {

struct BytesAndCodes {
  Image picture;
  std::vector<std::uint8_t> codes;
};

BytesAndCodes random_bytes(Random& random, int width, int height) {
  const Settings settings{static_cast<std::uint16_t>(width), static_cast<std::uint16_t>(height), 0,
                          SOFTFOCUS_FIXED_RGBA8, SOFTFOCUS_FIXED_DEPTH8};
  const PackedPicture packed = random_picture(random, settings);
  BytesAndCodes made{make_image(Format::rgba8, width, height), packed.depths};
  auto from = packed.colours.begin();
  for (int y = 0; y < height; ++y) {
    for (std::uint8_t& byte : row<std::uint8_t>(made.picture, y)) byte = *from++;
  }
  return made;
}

Image in_lanes(const BytesAndCodes& input, const std::vector<Weights>& table, ThreadPool& pool) {
  // What was there before must not show.
  Image result = make_image(Format::rgba8, input.picture.width, input.picture.height);
  std::ranges::fill(result.bytes, std::byte{0x5A});
  fixed_two_pass(input.picture, input.codes, fixed_table(table), result, pool);
  return result;
}

bool same(const Image& a, const Image& b) {
  for (int y = 0; y < a.height; ++y) {
    if (!std::ranges::equal(row<std::uint8_t>(a, y), row<std::uint8_t>(b, y))) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("fixed point: every vector unit gives the bits of the rows, at every size and lens") {
  ThreadPool plain(1, Isa::scalar);
  for (const Isa isa : available_isas()) {
    ThreadPool pool(2, isa);
    Random random{8};
    for (int i = 0; i < 80; ++i) {
      const Lens lens = any_lens(random, i % 4 == 0 ? 64 : 10);
      const auto table = table8(lens, any_below(random, 3000000), any_below(random, 9000000));
      const int width = 1 + static_cast<int>(any_below(random, i % 8 == 0 ? 300 : 90));
      const int height = 1 + static_cast<int>(any_below(random, i % 8 == 1 ? 300 : 70));
      const BytesAndCodes input = random_bytes(random, width, height);
      INFO(std::string{isa_name(isa)}, ", picture ", i, ", ", width, "x", height);
      CHECK(same(in_lanes(input, table, pool), in_lanes(input, table, plain)));
    }
  }
}

TEST_CASE("fixed point: the bits do not depend on the number of threads") {
  Random random{9};
  const Lens lens{30u << 16, 1000000, 16u << 16, 65536};
  const auto table = table8(lens, 300000, 5000000);
  const BytesAndCodes input = random_bytes(random, 530, 700);
  ThreadPool one(1);
  const Image expected = in_lanes(input, table, one);
  for (const int threads : {2, 3, 8}) {
    for (const Isa isa : {Isa::scalar, widest_isa()}) {
      ThreadPool pool(threads, isa);
      CAPTURE(threads);
      CHECK(same(in_lanes(input, table, pool), expected));
    }
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
