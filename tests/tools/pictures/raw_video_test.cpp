#include <doctest/doctest.h>

#include "raster/images/texel.h"
#include "tests/support/random.h"
#include "tools/pictures/image_file.h"

using namespace softfocus;

TEST_CASE("raw video has the colours of the picture's PNG files") {
  test::Random random{5};
  Image image = make_image(Format::rgba16f, 7, 5);
  for (int y = 0; y < image.height; ++y) {
    for (std::uint16_t& half : row<std::uint16_t>(image, y)) {
      half = static_cast<std::uint16_t>(random.next());  // NaN and infinity too
    }
  }
  const auto of_png = [&](const Bytes& png) { return decode_picture(png, "a.png").image; };
  const Image of_8 = of_png(encode_png(image)), of_16 = of_png(encode_png_16(image));
  const Bytes rgb24 = encode_rgb24(image), rgb48 = encode_rgb48le(image);
  REQUIRE(rgb24.size() == 3 * 7 * 5);
  REQUIRE(rgb48.size() == 6 * 7 * 5);
  std::size_t next = 0;
  for (int y = 0; y < image.height; ++y) {
    for (std::size_t i = 0; i < 4 * 7; ++i) {
      if (i % 4 == 3) continue;
      const auto byte = [&](const Bytes& bytes, std::size_t at) {
        return std::to_integer<std::uint8_t>(bytes[at]);
      };
      CHECK(row<std::uint16_t>(of_8, y)[i] ==
            float_to_half(srgb8_to_linear(byte(rgb24, next)), HalfRounding::nearest_even));
      const int wide = byte(rgb48, 2 * next) | byte(rgb48, 2 * next + 1) << 8;
      CHECK(row<std::uint16_t>(of_16, y)[i] ==
            float_to_half(srgb16_to_linear(static_cast<std::uint16_t>(wide)),
                          HalfRounding::nearest_even));
      ++next;
    }
  }
}

TEST_CASE("raw video has a name as a format, and no ending") {
  CHECK(format_by_name("rgb24") == FileFormat::rgb24);
  CHECK(format_by_name("rgb48le") == FileFormat::rgb48le);
  CHECK(!format_by_extension("a.rgb24"));
}
