// The integer filter row by row against the oracle in wide integers, bit for bit, and what it
// refuses.

#include <cstring>

#include "dof/fixed/weights.h"
#include "tests/support/fixed_pictures.h"

using namespace softfocus;
using namespace softfocus::fixed;

namespace {

using Channels = Picture3<std::int64_t>;

template <class Number>
Number number_at(const std::vector<std::uint8_t>& bytes, std::size_t index) {
  Number number;
  std::memcpy(&number, bytes.data() + index * sizeof number, sizeof number);
  return number;
}

std::size_t pixels_of(const PackedPicture& picture) {
  return std::size_t{picture.settings.width} * picture.settings.height;
}

std::vector<Weights> weights_of(const PackedPicture& picture, const std::vector<Weights>& table) {
  std::vector<Weights> weights;
  for (std::size_t i = 0; i < pixels_of(picture); ++i) {
    const std::size_t code = picture.settings.depth == SOFTFOCUS_FIXED_DEPTH8 ? picture.depths[i]
                             : picture.settings.depth == SOFTFOCUS_FIXED_DEPTH16
                                 ? number_at<std::uint16_t>(picture.depths, i)
                                 : number_at<std::uint16_t>(picture.colours, 4 * i + 3);
    weights.push_back(table[code]);
  }
  return weights;
}

template <class PixelAt>
Channels channels(const Settings& settings, const PixelAt& pixel_at) {
  Channels picture{settings.width, settings.height, {}};
  for (std::size_t i = 0; i < std::size_t{settings.width} * settings.height; ++i) {
    picture.pixels.push_back(pixel_at(i));
  }
  return picture;
}

using Pixel3 = std::array<std::int64_t, 3>;

// 8-bit values of a colour of 5 or 6 bits, and back, by the definition.
std::int64_t to_byte(std::int64_t value, std::int64_t most) {
  return most == 31 ? value * 8 + value / 4 : value * 4 + value / 16;
}
std::int64_t from_byte(std::int64_t byte, std::int64_t most) {
  return floor_divide(2 * byte * most + 255, 2 * 255);
}

Pixel3 unpack565(std::uint16_t word) {
  return {to_byte(word >> 11, 31), to_byte(word >> 5 & 63, 63), to_byte(word & 31, 31)};
}
std::uint16_t pack565(const Pixel3& bytes) {
  return static_cast<std::uint16_t>(from_byte(bytes[0], 31) << 11 | from_byte(bytes[1], 63) << 5 |
                                    from_byte(bytes[2], 31));
}

std::vector<std::uint8_t> expected8(const PackedPicture& picture,
                                    const std::vector<Weights>& table) {
  const bool packed = picture.settings.colour == SOFTFOCUS_FIXED_RGB565;
  const Channels bytes = channels(picture.settings, [&](std::size_t i) {
    if (packed) return unpack565(number_at<std::uint16_t>(picture.colours, i));
    return Pixel3{picture.colours[4 * i], picture.colours[4 * i + 1], picture.colours[4 * i + 2]};
  });
  const Channels filtered = wide_filter8(bytes, weights_of(picture, table));
  std::vector<std::uint8_t> expected = picture.colours;
  for (std::size_t i = 0; i < filtered.pixels.size(); ++i) {
    const Pixel3& pixel = filtered.pixels[i];
    if (packed) {
      const std::uint16_t word = pack565(pixel);
      std::memcpy(expected.data() + 2 * i, &word, sizeof word);
    } else {
      for (std::size_t c = 0; c < 3; ++c) {
        expected[4 * i + c] = static_cast<std::uint8_t>(pixel[c]);
      }
    }
  }
  return expected;
}

std::vector<std::uint8_t> expected16(const PackedPicture& picture,
                                     const std::vector<Weights>& table) {
  const std::vector<Weights> weights = weights_of(picture, table);
  const Channels halves = channels(picture.settings, [&](std::size_t i) {
    return Pixel3{half_units(number_at<std::uint16_t>(picture.colours, 4 * i)),
                  half_units(number_at<std::uint16_t>(picture.colours, 4 * i + 1)),
                  half_units(number_at<std::uint16_t>(picture.colours, 4 * i + 2))};
  });
  const Channels filtered = wide_filter16(halves, weights);
  std::vector<std::uint8_t> expected = picture.colours;
  for (std::size_t i = 0; i < filtered.pixels.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto half = static_cast<std::uint16_t>(filtered.pixels[i][c]);
      std::memcpy(expected.data() + 8 * i + 2 * c, &half, sizeof half);
    }
  }
  return expected;
}

Settings any_settings(Random& random, const Lens& lens, softfocus_fixed_colour colour,
                      softfocus_fixed_depth depth) {
  const std::uint32_t spare = any_below(random, 3) == 0 ? any_below(random, 5) : 0;
  const std::uint32_t reach =
      std::min<std::uint32_t>(reach_of(lens.largest_radius) + spare, SOFTFOCUS_FIXED_LARGEST_REACH);
  return {static_cast<std::uint16_t>(1 + any_below(random, 40)),
          static_cast<std::uint16_t>(1 + any_below(random, 30)), static_cast<std::uint8_t>(reach),
          static_cast<std::uint8_t>(colour), static_cast<std::uint8_t>(depth)};
}

constexpr Settings kSettings{8, 4, 3, SOFTFOCUS_FIXED_RGBA8, SOFTFOCUS_FIXED_DEPTH8};
constexpr Lens kLens{10u << 16, 1000000, 4u << 16, 65536};

/// A stream that has begun, and all that it needs.
struct Begun {
  std::vector<Weights> table = table8(kLens, 500000, 4000000);
  std::vector<std::uint32_t> memory = std::vector<std::uint32_t>(memory_bytes(kSettings) / 4);
  Stream stream{};
  std::array<std::uint8_t, 32> colours{}, out{};
  std::array<std::uint8_t, 8> depths{};

  Begun() {
    REQUIRE(softfocus_fixed_begin(&stream, &kSettings, table.data(), memory.data(),
                                  memory_bytes(kSettings)) == 0);
    out.fill(77);
  }
  int put(std::uint32_t y) {
    return softfocus_fixed_put_row(&stream, y, colours.data(), depths.data(), out.data());
  }
};

int begin(const Settings& settings, const std::vector<Weights>& table, std::size_t spare = 0) {
  std::vector<std::uint32_t> memory(1u << 16);
  Stream stream{};
  stream.rows_in = 7;
  const std::size_t needed = softfocus_fixed_memory(&settings);
  const int error =
      softfocus_fixed_begin(&stream, &settings, table.data(), memory.data(), needed - spare);
  // Refused means untouched.
  if (error != 0) CHECK(stream.rows_in == 7);
  return error;
}

}  // namespace

TEST_CASE("fixed point: rows of 8-bit colour have the bits of the oracle") {
  Random random{1};
  for (int i = 0; i < 240; ++i) {
    const Lens lens = any_lens(random, i % 4 == 0 ? 64 : 10);
    const auto table = table8(lens, any_below(random, 3000000), any_below(random, 9000000));
    const auto colour = i % 2 == 0 ? SOFTFOCUS_FIXED_RGBA8 : SOFTFOCUS_FIXED_RGB565;
    const PackedPicture picture =
        random_picture(random, any_settings(random, lens, colour, SOFTFOCUS_FIXED_DEPTH8));
    CAPTURE(i);
    CHECK(filtered_rows(picture, table) == expected8(picture, table));
  }
}

TEST_CASE("fixed point: RGB565 in the other order of bytes is the same picture") {
  Random random{3};
  const auto swap_bytes = [](std::vector<std::uint8_t>& bytes) {
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) std::swap(bytes[i], bytes[i + 1]);
  };
  for (int i = 0; i < 60; ++i) {
    const Lens lens = any_lens(random, 10);
    const auto table = table8(lens, any_below(random, 3000000), any_below(random, 9000000));
    PackedPicture picture = random_picture(
        random, any_settings(random, lens, SOFTFOCUS_FIXED_RGB565, SOFTFOCUS_FIXED_DEPTH8));
    std::vector<std::uint8_t> expected = filtered_rows(picture, table);
    swap_bytes(expected);
    swap_bytes(picture.colours);
    picture.settings.colour = SOFTFOCUS_FIXED_RGB565_SWAPPED;
    CAPTURE(i);
    CHECK(filtered_rows(picture, table) == expected);
  }
}

TEST_CASE("fixed point: codes of 16 bits and of halves have the bits of the oracle") {
  Random random{2};
  for (int i = 0; i < 10; ++i) {
    const Lens lens = any_lens(random, 12);
    std::vector<Weights> table(65536);
    REQUIRE((i % 2 == 0 ? softfocus_fixed_table16(&lens, 300000, 5000000, table.data())
                        : softfocus_fixed_table_half(&lens, table.data())) == 0);
    const PackedPicture picture = random_picture(
        random, any_settings(random, lens, SOFTFOCUS_FIXED_RGBA8, SOFTFOCUS_FIXED_DEPTH16));
    CAPTURE(i);
    CHECK(filtered_rows(picture, table) == expected8(picture, table));
  }
}

TEST_CASE("fixed point: rows of halves have the bits of the oracle") {
  Random random{3};
  for (int i = 0; i < 45; ++i) {
    const Lens lens = any_lens(random, i % 4 == 0 ? 64 : 9);
    const auto depth = static_cast<softfocus_fixed_depth>(i % 3);
    std::vector<Weights> table = table8(lens, 400000, 6000000);
    if (depth != SOFTFOCUS_FIXED_DEPTH8) {
      table.resize(65536);
      REQUIRE(softfocus_fixed_table_half(&lens, table.data()) == 0);
    }
    PackedPicture picture =
        random_picture(random, any_settings(random, lens, SOFTFOCUS_FIXED_RGBA16F, depth));
    if (i % 5 == 0) {  // the largest halves everywhere, of both signs
      for (std::size_t k = 0; k < pixels_of(picture) * 4; ++k) {
        if (k % 4 == 3) continue;
        const std::uint16_t half = random.next() % 2 == 0 ? 0x7BFF : (i % 2 == 0 ? 0xFBFF : 0x7C00);
        std::memcpy(picture.colours.data() + 2 * k, &half, sizeof half);
      }
    }
    CAPTURE(i);
    CHECK(filtered_rows(picture, table) == expected16(picture, table));
  }
}

TEST_CASE("fixed point: a constant picture stays constant") {
  Random random{4};
  for (int i = 0; i < 60; ++i) {
    const Lens lens = any_lens(random, i % 2 == 0 ? 64 : 6);
    const auto table = table8(lens, any_below(random, 3000000), any_below(random, 9000000));
    PackedPicture picture = random_picture(
        random, any_settings(random, lens, SOFTFOCUS_FIXED_RGBA8, SOFTFOCUS_FIXED_DEPTH8));
    const auto value = static_cast<std::uint8_t>(random.next());
    std::ranges::fill(picture.colours, value);
    CAPTURE(i);
    CHECK(filtered_rows(picture, table) == picture.colours);
  }
}

TEST_CASE("fixed point: a row may be written over the row that went in") {
  Random random{5};
  const auto table = table8(kLens, 500000, 4000000);
  PackedPicture picture = random_picture(random, {20, 12, 3, SOFTFOCUS_FIXED_RGBA8, 0});
  const auto expected = filtered_rows(picture, table);
  std::vector<std::uint32_t> memory(memory_bytes(picture.settings) / 4);
  Stream stream;
  REQUIRE(softfocus_fixed_begin(&stream, &picture.settings, table.data(), memory.data(),
                                memory.size() * 4) == 0);
  std::vector<std::uint8_t> all;
  std::vector<std::uint8_t> row(80);
  for (std::uint32_t y = 0; y < 12; ++y) {
    std::copy_n(picture.colours.begin() + y * 80, 80, row.begin());
    if (softfocus_fixed_put_row(&stream, y, row.data(), picture.depths.data() + y * 20,
                                row.data()) == 1) {
      all.insert(all.end(), row.begin(), row.end());
    }
  }
  while (softfocus_fixed_finish_row(&stream, row.data()) == 1) {
    all.insert(all.end(), row.begin(), row.end());
  }
  CHECK(all == expected);
}

TEST_CASE("fixed point: a stream with wrong settings, table or memory does not begin") {
  const auto table = table8(kLens, 500000, 4000000);
  CHECK(begin(kSettings, table) == 0);
  CHECK(begin(kSettings, table, 1) == SOFTFOCUS_FIXED_BAD_MEMORY);
  const auto with = [](auto change) {
    Settings settings = kSettings;
    change(settings);
    return settings;
  };
  for (const Settings& settings :
       {with([](Settings& s) { s.width = 0; }), with([](Settings& s) { s.height = 0; }),
        with([](Settings& s) { s.width = 16385; }), with([](Settings& s) { s.height = 16385; }),
        with([](Settings& s) { s.reach = 64; })}) {
    CHECK(begin(settings, table) == SOFTFOCUS_FIXED_BAD_SIZE);
    CHECK(softfocus_fixed_memory(&settings) == 0);
  }
  CHECK(begin(with([](Settings& s) { s.colour = 4; }), table) == SOFTFOCUS_FIXED_BAD_FORMAT);
  CHECK(begin(with([](Settings& s) { s.depth = 3; }), table) == SOFTFOCUS_FIXED_BAD_FORMAT);
  CHECK(begin(with([](Settings& s) { s.depth = SOFTFOCUS_FIXED_DEPTH_IN_ALPHA; }), table) ==
        SOFTFOCUS_FIXED_BAD_FORMAT);
  CHECK(begin(with([](Settings& s) { s.colour = SOFTFOCUS_FIXED_RGBA16F; }), table) ==
        SOFTFOCUS_FIXED_BAD_FORMAT);
  CHECK(begin(with([](Settings& s) { s.reach = 2; }), table) == SOFTFOCUS_FIXED_BAD_TABLE);
  auto forged = table;
  forged[200].whole = 1u << 20;
  CHECK(begin(kSettings, forged) == SOFTFOCUS_FIXED_BAD_TABLE);
  forged = table;
  forged[9].edge = forged[9].whole + 1;
  CHECK(begin(kSettings, forged) == SOFTFOCUS_FIXED_BAD_TABLE);
  std::vector<std::uint32_t> memory(1u << 12);
  Stream stream;
  CHECK(softfocus_fixed_begin(&stream, &kSettings, table.data(),
                              reinterpret_cast<std::uint8_t*>(memory.data()) + 1,
                              memory_bytes(kSettings)) == SOFTFOCUS_FIXED_BAD_MEMORY);
  CHECK(softfocus_fixed_begin(&stream, &kSettings, table.data(), nullptr, 1u << 14) ==
        SOFTFOCUS_FIXED_BAD_MEMORY);
  CHECK(softfocus_fixed_begin(nullptr, &kSettings, table.data(), memory.data(), 1u << 14) ==
        SOFTFOCUS_FIXED_BAD_ARGUMENT);
  CHECK(softfocus_fixed_begin(&stream, nullptr, table.data(), memory.data(), 1u << 14) ==
        SOFTFOCUS_FIXED_BAD_ARGUMENT);
  CHECK(softfocus_fixed_begin(&stream, &kSettings, nullptr, memory.data(), 1u << 14) ==
        SOFTFOCUS_FIXED_BAD_ARGUMENT);
  CHECK(softfocus_fixed_begin_half(&stream, &kSettings, table.data(), memory.data(), 1u << 14) ==
        SOFTFOCUS_FIXED_BAD_FORMAT);
}

TEST_CASE("fixed point: a row out of turn writes nothing") {
  Begun begun;
  const auto memory = begun.memory;
  CHECK(begun.put(1) == SOFTFOCUS_FIXED_BAD_ROW);
  CHECK(softfocus_fixed_finish_row(&begun.stream, begun.out.data()) == SOFTFOCUS_FIXED_BAD_ROW);
  CHECK(softfocus_fixed_put_row(&begun.stream, 0, nullptr, begun.depths.data(), begun.out.data()) ==
        SOFTFOCUS_FIXED_BAD_ARGUMENT);
  CHECK(softfocus_fixed_put_row(&begun.stream, 0, begun.colours.data(), nullptr,
                                begun.out.data()) == SOFTFOCUS_FIXED_BAD_ARGUMENT);
  CHECK(softfocus_fixed_put_row(&begun.stream, 0, begun.colours.data(), begun.depths.data(),
                                nullptr) == SOFTFOCUS_FIXED_BAD_ARGUMENT);
  CHECK(begun.memory == memory);
  CHECK(std::ranges::all_of(begun.out, [](int byte) { return byte == 77; }));
  for (std::uint32_t y = 0; y < 3; ++y) CHECK(begun.put(y) == 0);
  CHECK(begun.put(2) == SOFTFOCUS_FIXED_BAD_ROW);
  CHECK(begun.put(3) == 1);
  CHECK(begun.put(4) == SOFTFOCUS_FIXED_BAD_ROW);
  for (int i = 0; i < 3; ++i) {
    CHECK(softfocus_fixed_finish_row(&begun.stream, begun.out.data()) == 1);
  }
  CHECK(softfocus_fixed_finish_row(&begun.stream, begun.out.data()) == 0);
}
