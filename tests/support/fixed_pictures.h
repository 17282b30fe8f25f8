#pragma once
// Random pictures and lenses for the fixed-point filter, and the filter run on them.

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "dof/fixed/fixed.h"
#include "tests/support/fixed_oracle.h"
#include "tests/support/test_images.h"

namespace softfocus::fixed {

inline std::uint32_t any_below(Random& random, std::uint32_t end) {
  return static_cast<std::uint32_t>(random.next() % end);
}

/// Any lens that the interface admits, of circles up to some radius in pixels.
inline Lens any_lens(Random& random, std::uint32_t radius_px) {
  constexpr std::uint32_t kPixel = SOFTFOCUS_FIXED_ONE_PIXEL;
  Lens lens{any_below(random, 40 * kPixel), 1 + any_below(random, 4000000),
            1 + any_below(random, radius_px * kPixel), kPixel};
  if (any_below(random, 3) == 0) lens.leak = 4096 + any_below(random, 200000);
  if (any_below(random, 9) == 0) lens.leak = 0;
  if (any_below(random, 9) == 0) lens.radius_at_infinity = 0xFFFFFFFF;
  return lens;
}

inline std::vector<Weights> table8(const Lens& lens, std::uint32_t near_um, std::uint32_t far_um) {
  std::vector<Weights> table(256);
  REQUIRE(softfocus_fixed_table8(&lens, near_um, far_um, table.data()) == 0);
  return table;
}

/// A picture's bytes as a program for a board has them, without gaps.
struct PackedPicture {
  Settings settings;
  std::vector<std::uint8_t> colours;
  std::vector<std::uint8_t> depths;
};

inline std::size_t pixel_bytes(const Settings& settings) {
  return settings.colour == SOFTFOCUS_FIXED_RGBA16F ? 8
         : settings.colour == SOFTFOCUS_FIXED_RGBA8 ? 4
                                                    : 2;
}

inline PackedPicture random_picture(Random& random, const Settings& settings) {
  PackedPicture picture{settings, {}, {}};
  const std::size_t pixels = std::size_t{settings.width} * settings.height;
  const std::uint32_t kind = any_below(random, 4);  // noise, extremes only, white, black
  for (std::size_t i = 0; i < pixels * pixel_bytes(settings); ++i) {
    const auto any = static_cast<std::uint8_t>(random.next());
    const auto end = static_cast<std::uint8_t>(any % 2 == 0 ? 0 : 255);
    picture.colours.push_back(kind == 0   ? any
                              : kind == 1 ? end
                              : kind == 2 ? std::uint8_t{255}
                                          : std::uint8_t{0});
  }
  const std::uint32_t depth_kind = any_below(random, 3);  // noise, two depths, steps
  const std::size_t bytes = settings.depth == SOFTFOCUS_FIXED_DEPTH8 ? 1 : 2;
  for (std::size_t i = 0; i < pixels * bytes; ++i) {
    const auto any = static_cast<std::uint8_t>(random.next());
    picture.depths.push_back(depth_kind == 0   ? any
                             : depth_kind == 1 ? static_cast<std::uint8_t>(any % 2 == 0 ? 3 : 250)
                                               : static_cast<std::uint8_t>(i / 50));
  }
  return picture;
}

/// The result of rows given one by one. Guards lie behind the memory.
inline std::vector<std::uint8_t> filtered_rows(const PackedPicture& picture,
                                               const std::vector<Weights>& table) {
  const Settings& settings = picture.settings;
  const std::size_t bytes = memory_bytes(settings);
  CHECK(bytes == softfocus_fixed_memory(&settings));
  std::vector<std::uint32_t> memory(bytes / 4 + 16, 0xABABABABu);
  Stream stream;
  const auto begin = settings.colour == SOFTFOCUS_FIXED_RGBA16F ? softfocus_fixed_begin_half
                                                                : softfocus_fixed_begin;
  REQUIRE(begin(&stream, &settings, table.data(), memory.data(), bytes) == 0);
  const std::size_t row_bytes = settings.width * pixel_bytes(settings);
  const std::size_t depth_bytes =
      settings.width * (settings.depth == SOFTFOCUS_FIXED_DEPTH8 ? std::size_t{1} : std::size_t{2});
  std::vector<std::uint8_t> out(row_bytes * (settings.height + std::size_t{1}));
  std::size_t rows = 0;
  for (std::uint32_t y = 0; y < settings.height; ++y) {
    const int given = softfocus_fixed_put_row(&stream, y, picture.colours.data() + y * row_bytes,
                                              picture.depths.data() + y * depth_bytes,
                                              out.data() + rows * row_bytes);
    REQUIRE(given == (y >= settings.reach ? 1 : 0));
    rows += static_cast<std::size_t>(given);
  }
  while (softfocus_fixed_finish_row(&stream, out.data() + rows * row_bytes) == 1) ++rows;
  CHECK(rows == settings.height);
  for (std::size_t i = bytes / 4 + 1; i < memory.size(); ++i) CHECK(memory[i] == 0xABABABABu);
  out.resize(row_bytes * settings.height);
  return out;
}

}  // namespace softfocus::fixed
