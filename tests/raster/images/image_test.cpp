#include "raster/images/image.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string_view>

#include "raster/images/texel.h"
#include "raster/numbers/hash.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

constexpr std::array kFormats{Format::r8,   Format::rgba8,   Format::srgb8, Format::rgba16f,
                              Format::r32f, Format::rgba32f, Format::rg16f};

std::uint64_t fnv_of(std::string_view text) {
  Hash hash;
  for (const char c : text) add_to_hash(hash, static_cast<std::uint8_t>(c));
  return hash.value;
}

Image random_image(Format format, int width, int height, std::uint64_t seed) {
  Image image = make_image(format, width, height);
  test::Random random{seed};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      store_texel(image, x, y,
                  {random.between(0.0f, 1.0f), random.between(0.0f, 1.0f),
                   random.between(0.0f, 1.0f), random.between(0.0f, 1.0f)},
                  {});
    }
  }
  return image;
}

// Writes into the bytes that lie between the end of a row and the next one.
void dirty_padding(Image& image) {
  const std::size_t used = static_cast<std::size_t>(image.width) * bytes_per_texel(image.format);
  for (std::size_t i = 0; i < image.bytes.size(); ++i) {
    if (i % image.stride_bytes >= used) image.bytes[i] = std::byte{0xAB};
  }
}

}  // namespace

TEST_CASE("rows begin on 64-byte boundaries in every format and width") {
  int wrong = 0;
  for (const Format format : kFormats) {
    for (const int width : {1, 3, 4, 7, 8, 15, 16, 17, 63, 64, 65, 1000}) {
      const Image image = make_image(format, width, 3);
      wrong += image.stride_bytes % 64 != 0;
      wrong += image.stride_bytes < static_cast<std::size_t>(width) * bytes_per_texel(format);
      wrong += image.bytes.size() != 3 * image.stride_bytes;
      wrong += std::bit_cast<std::uintptr_t>(image.bytes.data()) % 64 != 0;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a row is no longer than its texels need, rounded up to 64 bytes") {
  CHECK(make_image(Format::r8, 64, 1).stride_bytes == 64);
  CHECK(make_image(Format::r8, 65, 1).stride_bytes == 128);
  CHECK(make_image(Format::rgba16f, 8, 1).stride_bytes == 64);
  CHECK(make_image(Format::rgba32f, 5, 1).stride_bytes == 128);
}

TEST_CASE("a new image is all zeros, padding too") {
  for (const Format format : kFormats) {
    const Image image = make_image(format, 13, 5);
    CHECK(std::all_of(image.bytes.begin(), image.bytes.end(),
                      [](std::byte b) { return b == std::byte{0}; }));
  }
}

TEST_CASE("images of the largest width or height can be made") {
  CHECK(make_image(Format::rgba32f, kMaxImageSize, 1).stride_bytes == 16u * 16384u);
  CHECK(make_image(Format::r8, 1, kMaxImageSize).bytes.size() == 64u * 16384u);
}

TEST_CASE("a row spans width times channels values") {
  Image grey = make_image(Format::r8, 9, 2);
  Image colour = make_image(Format::rgba16f, 9, 2);
  CHECK(row<std::uint8_t>(grey, 1).size() == 9);
  CHECK(row<std::uint16_t>(colour, 1).size() == 36);
}

TEST_CASE("texel sizes are channels times channel size") {
  for (const Format format : kFormats) {
    const std::size_t channel = format == Format::r32f || format == Format::rgba32f    ? 4
                                : format == Format::rgba16f || format == Format::rg16f ? 2
                                                                                       : 1;
    CHECK(bytes_per_texel(format) == channel * static_cast<std::size_t>(channel_count(format)));
  }
}

TEST_CASE("the hash is FNV-1a: published values") {
  CHECK(fnv_of("") == 0xCBF29CE484222325u);
  CHECK(fnv_of("a") == 0xAF63DC4C8601EC8Cu);
  CHECK(fnv_of("foobar") == 0x85944171F73967E8u);
}

TEST_CASE("wider values enter the hash in little-endian byte order") {
  Hash whole;
  add_to_hash(whole, std::uint32_t{0x64636261});
  CHECK(whole.value == fnv_of("abcd"));
  Hash real;
  add_to_hash(real, std::bit_cast<float>(0x64636261u));
  CHECK(real.value == fnv_of("abcd"));
}

TEST_CASE("an image's hash is that of its format, size and rows") {
  Image image = make_image(Format::r8, 3, 2);
  for (int y = 0; y < 2; ++y) {
    for (std::size_t x = 0; x < 3; ++x) {
      row<std::uint8_t>(image, y)[x] = static_cast<std::uint8_t>('a' + 3 * y + static_cast<int>(x));
    }
  }
  CHECK(hash_image(image) == fnv_of(std::string_view{"\0\3\0\0\0\2\0\0\0abcdef", 15}));
}

TEST_CASE("the hash does not see the padding") {
  for (const Format format : kFormats) {
    Image image = random_image(format, 21, 5, 1);
    const std::uint64_t clean = hash_image(image);
    dirty_padding(image);
    CHECK(hash_image(image) == clean);
  }
}

TEST_CASE("the hash sees every bit of every texel") {
  for (const Format format : kFormats) {
    Image image = random_image(format, 5, 3, 2);
    const std::uint64_t before = hash_image(image);
    int unseen = 0;
    for (std::size_t i = 0; i < image.bytes.size(); ++i) {
      if (i % image.stride_bytes >= 5 * bytes_per_texel(format)) continue;
      for (int bit = 0; bit < 8; ++bit) {
        const std::byte flip{static_cast<unsigned char>(1 << bit)};
        image.bytes[i] ^= flip;
        unseen += hash_image(image) == before;
        image.bytes[i] ^= flip;
      }
    }
    CHECK(unseen == 0);
  }
}

TEST_CASE("the hash tells formats and shapes of the same bytes apart") {
  CHECK(hash_image(make_image(Format::rgba8, 4, 4)) != hash_image(make_image(Format::srgb8, 4, 4)));
  CHECK(hash_image(make_image(Format::r32f, 2, 8)) != hash_image(make_image(Format::r32f, 8, 2)));
}

TEST_CASE("images are equal only with the same format, size and bits") {
  const Image image = random_image(Format::rgba16f, 9, 4, 3);
  CHECK(equal(image, random_image(Format::rgba16f, 9, 4, 3)));
  CHECK_FALSE(equal(image, random_image(Format::rgba16f, 9, 4, 4)));
  CHECK_FALSE(equal(image, random_image(Format::rgba16f, 4, 9, 3)));
  CHECK_FALSE(equal(make_image(Format::rgba8, 2, 2), make_image(Format::srgb8, 2, 2)));
  Image zero = make_image(Format::r32f, 1, 1);
  Image negative_zero = zero;
  row<float>(negative_zero, 0)[0] = -0.0f;
  CHECK_FALSE(equal(zero, negative_zero));
}
