#include "tools/pictures/image_file.h"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <string>

#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"
#include "tests/support/run_program.h"
#include "tools/cli/errors.h"

using namespace softfocus;

namespace {

/// Every half once, as 128 x 128 texels.
Image every_half() {
  Image image = make_image(Format::rgba16f, 128, 128);
  std::uint16_t next = 0;
  for (int y = 0; y < image.height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(image, y)) value = next++;
  }
  return image;
}

/// 3 x 2, no two values the same, all in 0..1 and exact in half.
Image small_picture() {
  Image image = make_image(Format::rgba16f, 3, 2);
  float next = 0.0f;
  for (int y = 0; y < image.height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(image, y)) {
      value = float_to_half(next, HalfRounding::nearest_even);
      next += 1.0f / 32.0f;
    }
  }
  return image;
}

std::string text_of(const Bytes& bytes, std::size_t first, std::size_t count) {
  return {reinterpret_cast<const char*>(bytes.data()) + first, count};
}

std::string error_of(const Bytes& bytes, FileFormat format) {
  try {
    decode(bytes, format);
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

/// A NumPy file with this dict and so many zero bytes behind it.
Bytes npy_with(std::string_view dict, std::size_t value_bytes) {
  Bytes bytes = bytes_of(std::string_view{"\x93NUMPY\x01\x00", 8});
  bytes.push_back(static_cast<std::byte>(dict.size()));
  bytes.push_back(std::byte{0});
  const Bytes header = bytes_of(dict);
  bytes.insert(bytes.end(), header.begin(), header.end());
  bytes.resize(bytes.size() + value_bytes);
  return bytes;
}

constexpr std::array kFormats{FileFormat::png, FileFormat::pfm, FileFormat::npy};

}  // namespace

TEST_CASE("an NPY file begins with magic, version, length and a padded dict") {
  const Bytes bytes = encode_npy(small_picture());
  CHECK(text_of(bytes, 0, 8) == std::string("\x93NUMPY\x01\x00", 8));
  CHECK(text_of(bytes, 8, 2) == std::string("\x76\x00", 2));  // 118 = 128 - 10
  const std::string dict = "{'descr': '<f2', 'fortran_order': False, 'shape': (2, 3, 4), }";
  CHECK(text_of(bytes, 10, dict.size()) == dict);
  CHECK(text_of(bytes, 10 + dict.size(), 128 - 10 - dict.size() - 1) ==
        std::string(128 - 10 - dict.size() - 1, ' '));
  CHECK(bytes[127] == std::byte{'\n'});
  CHECK(bytes.size() == 128 + 3 * 2 * 4 * 2);
}

TEST_CASE("an NPY file holds each half with its low byte first, the top row first") {
  const Bytes bytes = encode_npy(small_picture());
  // Value 1 is 1/32 = 0x2800, value 12 (the second row's first) 12/32 = 0x3600.
  CHECK(text_of(bytes, 128 + 2, 2) == std::string("\x00\x28", 2));
  CHECK(text_of(bytes, 128 + 24, 2) == std::string("\x00\x36", 2));
}

TEST_CASE("the values of an NPY file begin at a multiple of 64 for every width of the sizes") {
  for (const int width : {1, 9, 10, 99, 100, 999, 1000, 9999, 10000, 16384}) {
    const Bytes bytes = encode_npy(make_image(Format::rgba16f, width, 1));
    CHECK((bytes.size() - static_cast<std::size_t>(width) * 8) % 64 == 0);
  }
}

TEST_CASE("every half comes back from an NPY file with its bits") {
  const Image image = every_half();
  const Picture back = decode_npy(encode_npy(image));
  CHECK(back.has_alpha);
  CHECK(equal(back.image, image));
}

TEST_CASE("a PFM file begins with PF, the size and a negative scale") {
  const Bytes bytes = encode_pfm(small_picture());
  const std::string header = "PF\n3 2\n-1.0\n";
  CHECK(text_of(bytes, 0, header.size()) == header);
  CHECK(bytes.size() == header.size() + 3 * 2 * 3 * 4);
}

TEST_CASE("a PFM file holds its bottom row first, as little-endian floats") {
  const Bytes bytes = encode_pfm(small_picture());
  // The second row's first value is 12/32 = 0x3EC00000.
  CHECK(text_of(bytes, 12, 4) == std::string("\x00\x00\xC0\x3E", 4));
}

TEST_CASE("every half but a NaN comes back from a PFM file with its bits, without alpha") {
  const Image image = every_half();
  const Picture back = decode_pfm(encode_pfm(image));
  CHECK_FALSE(back.has_alpha);
  int wrong = 0;
  for (int y = 0; y < image.height; ++y) {
    const auto expected = row<std::uint16_t>(image, y);
    const auto found = row<std::uint16_t>(back.image, y);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const bool is_nan = (expected[i] & 0x7FFF) > kHalfInfinity;
      const bool is_right = i % 4 == 3 ? found[i] == 0
                            : is_nan   ? (found[i] & 0x7FFF) > kHalfInfinity
                                       : found[i] == expected[i];
      wrong += is_right ? 0 : 1;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("a PFM file with a positive scale is read as big-endian") {
  Bytes bytes = bytes_of("PF\n1 1\n1.0\n");
  for (const int byte : {0x3F, 0x80, 0, 0, 0x40, 0, 0, 0, 0xBF, 0, 0, 0}) {
    bytes.push_back(static_cast<std::byte>(byte));
  }
  const glm::vec4 texel = load_texel(decode_pfm(bytes).image, 0, 0);
  CHECK(texel == glm::vec4{1.0f, 2.0f, -0.5f, 0.0f});
}

TEST_CASE("a PNG holds the sRGB encoding of linear colour") {
  Image image = make_image(Format::rgba16f, 4, 1);
  store_texel(image, 0, 0, {0.0f, 0.5f, 1.0f, 7.0f}, {});
  store_texel(image, 1, 0, {-1.0f, 2.0f, 0.2159f, 7.0f}, {});
  const Picture back = decode_png(encode_png(image));
  // 0.5 encodes to 188 and 0.2159 to 128.
  const glm::vec4 first = load_texel(back.image, 0, 0);
  const glm::vec4 second = load_texel(back.image, 1, 0);
  const auto as_half = [](std::uint8_t encoded) {
    return half_to_float(float_to_half(srgb8_to_linear(encoded), HalfRounding::nearest_even));
  };
  CHECK(first == glm::vec4{0.0f, as_half(188), 1.0f, 0.0f});
  CHECK(second == glm::vec4{0.0f, 1.0f, as_half(128), 0.0f});
}

TEST_CASE("all 256 values of a PNG stay apart as halves and come back as themselves") {
  Image image = make_image(Format::rgba16f, 256, 1);
  for (int x = 0; x < 256; ++x) {
    const float linear = srgb8_to_linear(static_cast<std::uint8_t>(x));
    store_texel(image, x, 0, {linear, linear, linear, 1.0f}, {});
  }
  const Bytes png = encode_png(image);
  const Picture once = decode_png(png);
  CHECK(encode_png(once.image) == png);
  for (int x = 1; x < 256; ++x) {
    CHECK(load_texel(once.image, x - 1, 0).x < load_texel(once.image, x, 0).x);
  }
}

TEST_CASE("a PNG is filtered alike on any number of threads, at any width") {
  test::Random random{5};
  for (const int width : {1, 5, 16, 67}) {
    CAPTURE(width);
    Image image = make_image(Format::rgba16f, width, 70);
    for (int y = 0; y < image.height; ++y) {
      for (std::uint16_t& value : row<std::uint16_t>(image, y)) {
        value = float_to_half(random.between(-0.2f, 1.2f), HalfRounding::nearest_even);
      }
    }
    ThreadPool pool{3};
    const Bytes png = encode_png(image, {}, &pool);
    CHECK(png == encode_png(image));
    const Picture read = decode_png(png);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < width; ++x) {
        const glm::vec4 texel = load_texel<Format::rgba16f>(image, x, y);
        const glm::vec4 back = load_texel<Format::rgba16f>(read.image, x, y);
        for (int c = 0; c < 3; ++c) CHECK(linear_to_srgb8(back[c]) == linear_to_srgb8(texel[c]));
      }
    }
  }
}

TEST_CASE("every half has the 8-bit code of its value") {
  for (std::uint32_t bits = 0; bits < 65536; ++bits) {
    const auto half = static_cast<std::uint16_t>(bits);
    CHECK(srgb8_of_halves()[bits] == linear_to_srgb8(half_to_float(half)));
  }
}

TEST_CASE("a file cut short at any byte is refused, whatever its format") {
  for (const FileFormat format : kFormats) {
    const Bytes whole = encode(small_picture(), format);
    CHECK(error_of(whole, format).empty());
    for (std::size_t length = 0; length < whole.size(); ++length) {
      CAPTURE(length);
      const Bytes part{whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)};
      CHECK_FALSE(error_of(part, format).empty());
    }
  }
}

TEST_CASE("a file that goes on after its end is refused, whatever its format") {
  for (const FileFormat format : kFormats) {
    Bytes bytes = encode(small_picture(), format);
    bytes.push_back(std::byte{0});
    CHECK_FALSE(error_of(bytes, format).empty());
  }
}

TEST_CASE("any changed byte of a PNG is noticed") {
  const Bytes whole = encode_png(small_picture());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    CAPTURE(i);
    Bytes damaged = whole;
    damaged[i] ^= std::byte{0x20};
    CHECK_FALSE(error_of(damaged, FileFormat::png).empty());
  }
}

TEST_CASE("any changed byte of an NPY or PFM header is refused or gives a picture") {
  for (const FileFormat format : {FileFormat::npy, FileFormat::pfm}) {
    const Bytes whole = encode(small_picture(), format);
    for (std::size_t i = 0; i < std::min<std::size_t>(whole.size(), 128); ++i) {
      for (int value = 0; value < 256; ++value) {
        Bytes damaged = whole;
        damaged[i] = static_cast<std::byte>(value);
        CHECK_NOTHROW(error_of(damaged, format));  // nothing but a FileError
      }
    }
  }
}

TEST_CASE("an NPY file of binary32 is read, rounded to the nearest half") {
  Bytes bytes = npy_with("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 3), }\n", 0);
  for (const float value : {1.0f, 1.0f + 0x1p-11f + 0x1p-20f, -2.5f}) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::byte>(bits >> (8 * i) & 0xFF));
  }
  const Picture picture = decode_npy(bytes);
  CHECK_FALSE(picture.has_alpha);
  CHECK(load_texel(picture.image, 0, 0) == glm::vec4{1.0f, 1.0f + 0x1p-10f, -2.5f, 0.0f});
}

TEST_CASE("an NPY header is read in any order of its entries") {
  CHECK(error_of(npy_with("{'shape': (1,2,4), 'fortran_order':False,'descr':'<f2'}", 16),
                 FileFormat::npy) == "");
}

TEST_CASE("an NPY file of another type, order or shape is refused with what would be right") {
  const auto refused = [](std::string_view dict, std::string_view reason) {
    return error_of(npy_with(dict, 64), FileFormat::npy).find(reason) != std::string::npos;
  };
  CHECK(refused("{'descr': '>f2', 'fortran_order': False, 'shape': (2, 4, 4)}", "'<f2', '<f4'"));
  CHECK(refused("{'descr': '<i4', 'fortran_order': False, 'shape': (1, 4, 4)}", "'<f2', '<f4'"));
  CHECK(refused("{'descr': '<f2', 'fortran_order': False, 'shape': (2, 4, 5)}", "shape"));
  CHECK(refused("{'descr': '<f2', 'fortran_order': False, 'shape': (32,)}", "shape"));
  CHECK(refused("{'descr': '<f2', 'fortran_order': False, 'shape': (2, 4, 2, 2)}", "shape"));
  CHECK(refused("{'descr': '<f2', 'fortran_order': False, 'shape': (0, 1, 4)}", "shape"));
  CHECK(refused("{'descr': '<f2', 'fortran_order': False, 'shape': (99999999999, 1, 4)}", "shape"));
  CHECK(refused("{'descr': '<f2', 'shape': (2, 4, 4)}", "header"));
  CHECK(refused("{'descr': '<f2', 'fortran_order': Maybe, 'shape': (2, 4, 4)}", "header"));
  CHECK(refused("{", "header"));
  CHECK(refused("", "header"));
}

TEST_CASE("a PFM file with an absurd header is refused") {
  for (const std::string_view header :
       {"Pf\n1 1\n-1.0\n", "PF\n0 1\n-1.0\n", "PF\n-1 1\n-1.0\n", "PF\n100000 100000\n-1.0\n",
        "PF\n1 1\n0\n", "PF\n1 1\nnan\n", "PF\n1 1\ninf\n", "PF\none 1\n-1.0\n", "PF\n1\n",
        "PF\n99999999999999 1\n-1.0\n"}) {
    CAPTURE(header);
    Bytes bytes = bytes_of(header);
    bytes.resize(bytes.size() + 12);
    CHECK_FALSE(error_of(bytes, FileFormat::pfm).empty());
  }
}

TEST_CASE("a name asks for a format by its extension, in any case") {
  CHECK(format_by_extension("a/b.png") == FileFormat::png);
  CHECK(format_by_extension("B.PFM") == FileFormat::pfm);
  CHECK(format_by_extension("c.d.npy") == FileFormat::npy);
  CHECK_FALSE(format_by_extension("png"));
  CHECK(format_by_extension("a.EXR") == FileFormat::exr);
  CHECK(format_by_extension("a.hdr") == FileFormat::hdr);
  CHECK_FALSE(format_by_extension("a.jpg"));
  CHECK_FALSE(format_by_extension("a."));
  CHECK_FALSE(format_by_extension("-"));
}
