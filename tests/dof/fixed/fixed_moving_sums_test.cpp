#include <doctest/doctest.h>

#include <vector>

#include "dof/fixed/fixed.h"
#include "tests/support/fixed_oracle.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

/// Lenses whose circles, leaks and sides differ; depths are between 0.5 and 8.5 m.
struct LensCase {
  const char* name;
  fixed::Lens lens;
};

constexpr std::uint32_t kPixel = SOFTFOCUS_FIXED_ONE_PIXEL;

const LensCase kLenses[] = {
    {"most of it blurred", {9 * kPixel, 2000000, 8 * kPixel, kPixel}},
    {"circles of the largest size", {200 * kPixel, 2000000, 64 * kPixel, kPixel}},
    {"nearly sharp", {kPixel * 3 / 2, 2000000, 8 * kPixel, kPixel}},
    {"all sharp", {0, 2000000, 8 * kPixel, kPixel}},
    {"largest radius 1", {9 * kPixel, 2000000, kPixel, kPixel}},
    {"largest radius 0", {9 * kPixel, 2000000, 0, kPixel}},
    {"no leaking", {9 * kPixel, 2000000, 8 * kPixel, 0}},
    {"leaking little, to wide circles", {9 * kPixel, 2000000, 8 * kPixel, kPixel / 16}},
    {"everything beyond the focus", {9 * kPixel, 100000, 8 * kPixel, kPixel / 8}},
    {"everything before the focus", {9 * kPixel, 20000000, 8 * kPixel, kPixel}},
};

struct CodedPicture {
  int width, height;
  std::vector<std::uint8_t> rgba;
  std::vector<std::uint16_t> codes;  ///< below 256
};

/// Patches of one depth, noise, and colours at the ends of their range.
CodedPicture random_picture(int width, int height, std::uint64_t seed) {
  CodedPicture picture{width, height, {}, {}};
  Random random{seed};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::uint64_t chance = random.next();
      for (int i = 0; i < 4; ++i) {
        const auto byte = static_cast<std::uint8_t>(chance >> (8 * i));
        picture.rgba.push_back((chance >> 40 & 3) == 0 ? (byte < 128 ? 0 : 255) : byte);
      }
      const int patch = (x / 9 + 3 * (y / 7)) % 8;
      picture.codes.push_back(patch == 0 ? static_cast<std::uint16_t>(chance >> 48 & 255)
                                         : static_cast<std::uint16_t>(patch * patch * 4));
    }
  }
  return picture;
}

std::vector<fixed::Weights> table_of(const fixed::Lens& lens) {
  std::vector<fixed::Weights> table(256);
  REQUIRE(softfocus_fixed_table8(&lens, 500000, 8500000, table.data()) == 0);
  return table;
}

std::vector<std::uint8_t> filter_by_taps(const CodedPicture& picture,
                                         const std::vector<fixed::Weights>& table) {
  fixed::Picture3<std::int64_t> in{picture.width, picture.height, {}};
  std::vector<fixed::Weights> weights;
  for (std::size_t i = 0; i < picture.codes.size(); ++i) {
    in.pixels.push_back({picture.rgba[4 * i], picture.rgba[4 * i + 1], picture.rgba[4 * i + 2]});
    weights.push_back(table[picture.codes[i]]);
  }
  const fixed::Picture3<std::int64_t> out = fixed::wide_filter8(in, weights);
  std::vector<std::uint8_t> rgba;
  for (std::size_t i = 0; i < picture.codes.size(); ++i) {
    for (const std::int64_t channel : out.pixels[i]) {
      rgba.push_back(static_cast<std::uint8_t>(channel));
    }
    rgba.push_back(picture.rgba[4 * i + 3]);
  }
  return rgba;
}

/// `wide_codes`: codes of 16 bits, from a table whose other entries are copies.
std::vector<std::uint8_t> filter_as_stream(const CodedPicture& picture,
                                           std::vector<fixed::Weights> table, std::uint8_t reach,
                                           bool wide_codes) {
  if (wide_codes) table.resize(65536, table[0]);
  const fixed::Settings settings = {
      static_cast<std::uint16_t>(picture.width), static_cast<std::uint16_t>(picture.height), reach,
      SOFTFOCUS_FIXED_RGBA8,
      static_cast<std::uint8_t>(wide_codes ? SOFTFOCUS_FIXED_DEPTH16 : SOFTFOCUS_FIXED_DEPTH8)};
  std::vector<std::uint32_t> memory(fixed::memory_bytes(settings) / 4 + 1);
  fixed::Stream stream;
  REQUIRE(softfocus_fixed_begin(&stream, &settings, table.data(), memory.data(),
                                fixed::memory_bytes(settings)) == 0);
  const std::vector<std::uint8_t> small_codes(picture.codes.begin(), picture.codes.end());
  const auto width = static_cast<std::size_t>(picture.width);
  std::vector<std::uint8_t> row(4 * width);
  std::vector<std::uint8_t> out;
  for (std::size_t y = 0; y < static_cast<std::size_t>(picture.height); ++y) {
    const void* const codes = wide_codes ? static_cast<const void*>(&picture.codes[y * width])
                                         : static_cast<const void*>(&small_codes[y * width]);
    if (softfocus_fixed_put_row(&stream, static_cast<std::uint32_t>(y),
                                &picture.rgba[4 * y * width], codes, row.data()) == 1) {
      out.insert(out.end(), row.begin(), row.end());
    }
  }
  while (softfocus_fixed_finish_row(&stream, row.data()) == 1) {
    out.insert(out.end(), row.begin(), row.end());
  }
  return out;
}

}  // namespace

TEST_CASE("moving sums are the sums of all taps") {
  struct Size {
    int width, height;
  };
  for (const Size size : {Size{1, 1}, {2, 3}, {1, 40}, {40, 1}, {61, 5}, {5, 61}, {70, 45}}) {
    const CodedPicture picture = random_picture(size.width, size.height, 3);
    for (const LensCase& lens : kLenses) {
      const std::vector<fixed::Weights> table = table_of(lens.lens);
      const std::vector<std::uint8_t> expected = filter_by_taps(picture, table);
      const std::uint8_t reach = fixed::reach_of(lens.lens.largest_radius);
      INFO(lens.name, ", ", size.width, "x", size.height);
      CHECK(filter_as_stream(picture, table, reach, false) == expected);
      CHECK(filter_as_stream(picture, table, reach, true) == expected);
      CHECK(filter_as_stream(picture, table, SOFTFOCUS_FIXED_LARGEST_REACH, false) == expected);
    }
  }
}

TEST_CASE("a table with a pixel of weight 0 is refused") {
  std::vector<fixed::Weights> table = table_of(kLenses[3].lens);
  table[7].edge = 0;
  const fixed::Settings settings = {4, 4, 7, SOFTFOCUS_FIXED_RGBA8, SOFTFOCUS_FIXED_DEPTH8};
  std::vector<std::uint32_t> memory(fixed::memory_bytes(settings) / 4 + 1);
  fixed::Stream stream;
  CHECK(softfocus_fixed_begin(&stream, &settings, table.data(), memory.data(),
                              fixed::memory_bytes(settings)) == SOFTFOCUS_FIXED_BAD_TABLE);
}
