// Pictures' files as planes of numbers.

#include "tools/pictures/picture_file.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <string>

#include "raster/images/texel.h"
#include "tests/support/run_program.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/image_file.h"
#include "tools/pictures/png_text.h"

using namespace softfocus;

namespace {

/// A NumPy file of this dict, its values behind it.
Bytes npy_of(std::string_view type, bool columns_first, std::string_view shape,
             const Bytes& values) {
  const std::string dict = "{'descr': '" + std::string{type} +
                           "', 'fortran_order': " + (columns_first ? "True" : "False") +
                           ", 'shape': " + std::string{shape} + "}";
  Bytes bytes = bytes_of(std::string_view{"\x93NUMPY\x01\x00", 8});
  append_little_endian(bytes, static_cast<std::uint16_t>(dict.size()));
  const Bytes header = bytes_of(dict);
  bytes.insert(bytes.end(), header.begin(), header.end());
  bytes.insert(bytes.end(), values.begin(), values.end());
  return bytes;
}

/// All planes.
std::vector<PlaneValues> all_planes(const PictureFile& file, float outside = 0.0f) {
  std::vector<std::size_t> planes;
  for (std::size_t i = 0; i < file.planes.size(); ++i) planes.push_back(i);
  return read_planes(file, planes, outside);
}

std::string names(const PictureFile& file) { return plane_names(file); }

std::string error_of(Bytes bytes) {
  try {
    all_planes(open_picture_file(std::move(bytes), "the.file"));
  } catch (const FileError& error) {
    CHECK(std::string{error.what()}.find("the.file") != std::string::npos);
    return error.what();
  }
  return "";
}

bool has(const std::string& text, std::string_view part) { return text.find(part) != text.npos; }

/// Colours of 0 to 8, all exact in half, 9 x 5.
Image ramp() {
  Image image = make_image(Format::rgba16f, 9, 5);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 9; ++x) {
      const auto v = static_cast<float>(x);
      store_texel(image, x, y, {v, v * 0.5f, 0.25f, 1.0f + static_cast<float>(y)}, {});
    }
  }
  return image;
}

/// A PNG of rows that are stored without compression, each behind a 0, the filter's number.
Bytes plain_png(int width, int height, int bits, int colour_type, const Bytes& rows,
                std::string_view palette = {}, std::string_view transparency = {}) {
  const auto big = [](std::uint32_t value) {
    std::string text;
    for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 0xFFu);
    return text;
  };
  std::string packed{"\x78\x01\x01", 3};
  const auto length = static_cast<std::uint16_t>(rows.size());
  for (const std::uint16_t number : {length, static_cast<std::uint16_t>(~length)}) {
    packed += static_cast<char>(number & 0xFF);
    packed += static_cast<char>(number >> 8);
  }
  std::uint32_t a = 1, b = 0;  // Adler-32
  for (const std::byte byte : rows) {
    packed += static_cast<char>(byte);
    a = (a + std::to_integer<std::uint32_t>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  packed += big(b << 16 | a);
  Bytes png = bytes_of(kPngSignature);
  append_png_chunk(png, "IHDR",
                   big(static_cast<std::uint32_t>(width)) +
                       big(static_cast<std::uint32_t>(height)) + static_cast<char>(bits) +
                       static_cast<char>(colour_type) + std::string(3, '\0'));
  if (!palette.empty()) append_png_chunk(png, "PLTE", palette);
  if (!transparency.empty()) append_png_chunk(png, "tRNS", transparency);
  append_png_chunk(png, "IDAT", packed);
  append_png_chunk(png, "IEND", {});
  return png;
}

}  // namespace

TEST_CASE("PNG: palettes are looked up, with the alpha of their entries") {
  const Bytes rows = bytes_of(std::string_view{"\0\1\0", 3});
  const std::string_view palette{"\xFF\0\0\0\x80\0", 6};  // red, green
  const PictureFile plain = open_picture_file(plain_png(2, 1, 8, 3, rows, palette), "a.png");
  CHECK(names(plain) == "R, G, B");
  const auto planes = all_planes(plain);
  CHECK(planes[0] == PlaneValues{0, 255});
  CHECK(planes[1] == PlaneValues{128, 0});
  const PictureFile clear =
      open_picture_file(plain_png(2, 1, 8, 3, rows, palette, "\x40"), "a.png");
  CHECK(names(clear) == "R, G, B, A");
  CHECK(all_planes(clear)[3] == PlaneValues{255, 64});
}

TEST_CASE("PNG: grey of one bit goes from 0 to 255, grey with alpha has two planes") {
  const PictureFile bits =
      open_picture_file(plain_png(4, 1, 1, 0, bytes_of(std::string_view{"\0\xA0", 2})), "a.png");
  CHECK(names(bits) == "Y");
  CHECK(all_planes(bits)[0] == PlaneValues{255, 0, 255, 0});
  const PictureFile grey = open_picture_file(
      plain_png(2, 1, 8, 4, bytes_of(std::string_view{"\0\x10\xFF\x20\x80", 5})), "a.png");
  CHECK(names(grey) == "Y, A");
  CHECK(all_planes(grey)[0] == PlaneValues{16, 32});
  CHECK(all_planes(grey)[1] == PlaneValues{255, 128});
}

TEST_CASE("PNG: a transparent colour is an alpha, of grey, of colours and of 16 bits") {
  const auto png = [](int bits, int colour_type, std::string_view rows, std::string_view colour) {
    return plain_png(2, 1, bits, colour_type, bytes_of(rows), {}, colour);
  };
  using namespace std::string_view_literals;
  const PictureFile grey = open_picture_file(png(8, 0, "\0\x10\x20"sv, "\0\x20"sv), "a.png");
  CHECK(names(grey) == "Y, A");
  CHECK(all_planes(grey)[0] == PlaneValues{16, 32});
  CHECK(all_planes(grey)[1] == PlaneValues{255, 0});
  const Bytes colours = png(8, 2, "\0\1\2\3\1\2\4"sv, "\0\1\0\2\0\3"sv);
  const PictureFile colour = open_picture_file(colours, "a.png");
  CHECK(names(colour) == "R, G, B, A");
  CHECK(all_planes(colour)[3] == PlaneValues{0, 255});
  CHECK(decode_picture(colours, "a.png").has_alpha);
  const PictureFile wide = open_picture_file(png(16, 0, "\0\1\2\1\3"sv, "\1\3"sv), "a.png");
  CHECK(names(wide) == "Y, A");
  CHECK(all_planes(wide)[1] == PlaneValues{65535, 0});
}

TEST_CASE("NPY: every type and both orders give the same planes") {
  struct Case {
    const char* type;
    void (*append)(Bytes&, int value);
  };
  const Case cases[] = {
      {"|u1", [](Bytes& b, int v) { b.push_back(static_cast<std::byte>(v)); }},
      {"<u2", [](Bytes& b, int v) { append_little_endian(b, static_cast<std::uint16_t>(v)); }},
      {"<f2",
       [](Bytes& b, int v) {
         append_little_endian(b, float_to_half(static_cast<float>(v), HalfRounding::nearest_even));
       }},
      {"<f4",
       [](Bytes& b, int v) {
         append_little_endian(b, std::bit_cast<std::uint32_t>(static_cast<float>(v)));
       }},
      {"<f8", [](Bytes& b, int v) {
         append_little_endian(b, std::bit_cast<std::uint64_t>(static_cast<double>(v)));
       }}};
  for (const Case& type : cases) {
    for (const bool columns_first : {false, true}) {
      CAPTURE(type.type);
      CAPTURE(columns_first);
      Bytes values;  // 2 rows, 3 columns, 4 channels: 100 y + 10 x + c
      const auto value = [](int y, int x, int c) { return 100 * y + 10 * x + c; };
      if (columns_first) {
        for (int c = 0; c < 4; ++c)
          for (int x = 0; x < 3; ++x)
            for (int y = 0; y < 2; ++y) type.append(values, value(y, x, c));
      } else {
        for (int y = 0; y < 2; ++y)
          for (int x = 0; x < 3; ++x)
            for (int c = 0; c < 4; ++c) type.append(values, value(y, x, c));
      }
      const PictureFile file =
          open_picture_file(npy_of(type.type, columns_first, "(2, 3, 4)", values), "a.npy");
      CHECK(names(file) == "R, G, B, A");
      const auto planes = all_planes(file);
      for (int c = 0; c < 4; ++c) {
        for (int y = 0; y < 2; ++y) {
          for (int x = 0; x < 3; ++x) {
            CHECK(planes[static_cast<std::size_t>(c)][static_cast<std::size_t>(3 * y + x)] ==
                  static_cast<float>(value(y, x, c)));
          }
        }
      }
    }
  }
}

TEST_CASE("a file that becomes shorter while it is read by rows is refused by its name") {
  const TemporaryDirectory directory;
  const Image picture = make_image(Format::rgba16f, 300, 200);
  for (const std::string name : {"a.npy", "a.pfm"}) {
    CAPTURE(name);
    const Bytes bytes = name == "a.npy" ? encode_npy(picture) : encode_pfm(picture);
    write_file(directory.file(name), bytes);
    std::string why;
    const auto file = open_on_disk(directory.file(name), why);
    REQUIRE(file);
    const ReadRows read = rows_of(*file, {0});
    std::vector<PlaneValues> values{PlaneValues(300 * 10)};
    read({95, 10}, values);
    std::filesystem::resize_file(directory.file(name), bytes.size() / 2);
    CHECK_THROWS_WITH_AS(read({95, 10}, values), doctest::Contains(name.c_str()), FileError);
  }
}

TEST_CASE("NPY: an array of two dimensions is grey") {
  const PictureFile file =
      open_picture_file(npy_of("|u1", false, "(1, 2)", bytes_of("\x07\x09")), "a.npy");
  CHECK(names(file) == "Y");
  CHECK(file.is_srgb);
  CHECK(all_planes(file)[0] == PlaneValues{7.0f, 9.0f});
}

TEST_CASE("PFM: grey comes back from its file, top row first") {
  const std::vector<float> values{1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f};
  const PictureFile file = open_picture_file(encode_grey_pfm(values, 2, 3), "a.pfm");
  CHECK(names(file) == "Y");
  CHECK(all_planes(file)[0] == values);
}

TEST_CASE("PNG: 16 bits of grey and of colour come back from their file") {
  std::vector<std::uint16_t> values;
  values.reserve(700);
  for (int i = 0; i < 700; ++i) values.push_back(static_cast<std::uint16_t>(i * 93));
  const PictureFile grey = open_picture_file(encode_grey_png_16(values, 35, 20), "a.png");
  CHECK(names(grey) == "Y");
  CHECK(grey.planes[0].type == NumberType::unsigned16);
  const PlaneValues back = all_planes(grey)[0];
  CHECK(std::equal(back.begin(), back.end(), values.begin(), values.end(),
                   [](float a, std::uint16_t b) { return a == static_cast<float>(b); }));

  Image image = make_image(Format::rgba16f, 128, 120);  // halves from 0 to 1
  std::uint16_t next = 0;
  for (int y = 0; y < image.height; ++y) {
    const auto to = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < to.size(); i += 4, ++next) to[i] = to[i + 1] = to[i + 2] = next;
  }
  const Image colour = decode_png(encode_png_16(image)).image;
  int wrong = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float a = load_texel(image, x, y).x, b = load_texel(colour, x, y).y;
      wrong += std::fabs(a - b) > 1e-5f + 1e-3f * a;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("sRGB of 16 bits agrees with that of 8 bits at its 256 values") {
  for (int i = 0; i < 256; ++i) {
    CHECK(srgb16_to_linear(static_cast<std::uint16_t>(i * 257)) ==
          doctest::Approx(srgb8_to_linear(static_cast<std::uint8_t>(i))).epsilon(1e-5));
  }
}

TEST_CASE("HDR: colours come back within a half of 1/128 of the brightest channel") {
  for (const int width : {9, 7}) {  // in runs, and flat
    Image image = make_image(Format::rgba16f, width, 5);
    const Image from = ramp();
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < width; ++x) store_texel(image, x, y, load_texel(from, x, y), {});
    }
    const PictureFile file = open_picture_file(encode_hdr(image), "a.hdr");
    CHECK(names(file) == "R, G, B");
    const auto planes = all_planes(file);
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < width; ++x) {
        const glm::vec4 texel = load_texel(image, x, y);
        const float most = std::max({texel.x, texel.y, texel.z});
        for (int c = 0; c < 3; ++c) {
          const float back =
              planes[static_cast<std::size_t>(c)][static_cast<std::size_t>(y * width + x)];
          CHECK(std::fabs(back - texel[c]) <= most / 256.0f);
        }
      }
    }
  }
}

TEST_CASE("HDR: a file cut short anywhere is refused") {
  const Bytes whole = encode_hdr(ramp());
  CHECK(error_of(whole) == "");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    CAPTURE(length);
    CHECK(error_of({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)}) != "");
  }
}

TEST_CASE("JPEG: a picture has the colours of its sRGB numbers") {
  const PictureFile file = open_picture_file(SOFTFOCUS_TEST_DATA "/red-blue-16x8.jpg");
  CHECK(names(file) == "R, G, B");
  const Picture picture = read_colour(file, colour_layers(file).front(), false);
  CHECK(load_texel(picture.image, 2, 4).x > 5.0f * load_texel(picture.image, 2, 4).z);
  CHECK(load_texel(picture.image, 13, 4).z > 5.0f * load_texel(picture.image, 13, 4).x);
}

/// The test's JPEG with Exif data: a TIFF of one entry, the orientation.
Bytes turned_jpeg(std::string_view tiff) {
  Bytes jpeg = read_picture_bytes(SOFTFOCUS_TEST_DATA "/red-blue-16x8.jpg");
  const Bytes data = bytes_of(std::string{"Exif\0\0", 6} + std::string{tiff});
  Bytes segment = bytes_of("\xFF\xE1");
  segment.push_back(std::byte{0});
  segment.push_back(static_cast<std::byte>(data.size() + 2));
  segment.insert(segment.end(), data.begin(), data.end());
  jpeg.insert(jpeg.begin() + 2, segment.begin(), segment.end());
  return jpeg;
}

TEST_CASE("JPEG: the orientation of Exif data is told, of either byte order, and damage is none") {
  using namespace std::string_view_literals;
  const auto orientation = [](std::string_view tiff) {
    return open_picture_file(turned_jpeg(tiff), "a.jpg").exif_orientation;
  };
  const auto big = "MM\0*\0\0\0\x08\0\1\1\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0"sv;
  CHECK(orientation(big) == 6);
  CHECK(orientation("II*\0\x08\0\0\0\1\0\x12\1\3\0\1\0\0\0\x08\0\0\0\0\0\0\0"sv) == 8);
  CHECK(open_picture_file(turned_jpeg(big), "a.jpg").remark == "turned by its EXIF orientation, 6");
  for (std::size_t length = 0; length < 22; ++length)
    CHECK(orientation(big.substr(0, length)) == 1);
  CHECK(orientation("MM\0*\xFF\xFF\xFF\xFF\0\1"sv) == 1);
  CHECK(orientation("MM\0*\0\0\0\x08\0\1\1\x12\0\3\0\0\0\1\0\x09\0\0"sv) == 1);
  CHECK(open_picture_file(SOFTFOCUS_TEST_DATA "/red-blue-16x8.jpg").exif_orientation == 1);
}

TEST_CASE("JPEG, PNG: each EXIF orientation turns the pixels upright") {
  // The corner of the pixels as they are stored that is the upright picture's top left.
  constexpr std::array<std::array<int, 2>, 8> kTopLeft{
      {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {0, 1}, {1, 1}, {1, 0}}};
  const PlaneValues stored = [] {
    const PictureFile file = open_picture_file(SOFTFOCUS_TEST_DATA "/red-blue-16x8.jpg");
    const std::size_t red = 0;
    return read_planes(file, {&red, 1}, 0.0f)[0];
  }();
  std::vector<std::uint16_t> codes(6);
  for (std::size_t i = 0; i < 6; ++i) codes[i] = static_cast<std::uint16_t>(100 + i);
  const Bytes png = encode_grey_png_16(codes, 3, 2);
  for (int orientation = 1; orientation <= 8; ++orientation) {
    CAPTURE(orientation);
    std::string tiff{"MM\0*\0\0\0\x08\0\1\1\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0", 26};
    tiff[19] = static_cast<char>(orientation);
    const auto& corner = kTopLeft[static_cast<std::size_t>(orientation - 1)];
    const PictureFile jpeg = open_picture_file(turned_jpeg(tiff), "a.jpg");
    CHECK((jpeg.width == 16) == (orientation < 5));
    const std::size_t plane = 0;
    const PlaneValues red = read_planes(jpeg, {&plane, 1}, 0.0f)[0];
    CHECK(red[0] == stored[static_cast<std::size_t>(corner[1] * 7 * 16 + corner[0] * 15)]);
    Bytes exif;
    append_png_chunk(exif, "eXIf", tiff);
    Bytes turned = png;
    constexpr int kBehindHeader = 8 + 25;
    turned.insert(turned.begin() + kBehindHeader, exif.begin(), exif.end());
    const PictureFile file = open_picture_file(turned, "a.png");
    CHECK((file.width == 3) == (orientation < 5));
    const PlaneValues grey = read_planes(file, {&plane, 1}, 0.0f)[0];
    CHECK(grey[0] == static_cast<float>(100 + corner[1] * 3 + corner[0] * 2));
    // The next pixel to the right.
    const bool on_side = orientation >= 5;
    const int step = on_side ? (corner[1] == 0 ? 3 : -3) : (corner[0] == 0 ? 1 : -1);
    CHECK(grey[1] == grey[0] + static_cast<float>(step));
  }
}

TEST_CASE("a picture that is not read is named, and the program that converts it") {
  // Whole numbers would be other ones in an EXR.
  CHECK(has(error_of(bytes_of("SDPX....")), "oiiotool IN -o OUT.png"));
  CHECK(has(error_of(bytes_of(std::string_view{"\0\0\0\x18"
                                               "ftypheic....",
                                               16})),
            "heif-convert"));
  CHECK(has(error_of(bytes_of("RIFF....WEBPVP8 ")), "dwebp"));
  CHECK(has(error_of(bytes_of("hello")), "none of PNG"));
  CHECK(has(error_of(bytes_of("P2\n1 1\n9\n5\n")), "pnmtopng"));
  CHECK(has(error_of(bytes_of("\xFF\x0A....")), "djxl"));
  CHECK(has(error_of({}), "it is empty"));
}

TEST_CASE("a small file that claims a large picture is refused before there is memory for it") {
  CHECK(has(error_of(bytes_of("#?RADIANCE\n\n-Y 16384 +X 16384\n\x02\x02\x40")), "too small"));
  CHECK(has(error_of(bytes_of("PF\n16384 16384\n-1\n")), "bytes of values"));
  CHECK(has(error_of(npy_of("<f8", false, "(16384, 16384, 4)", {})), "bytes of values"));
  // A whole PNG, its header's size overwritten and its checksum mended, is more than 1032 times
  // as large as its data.
  std::vector<std::uint16_t> grey(64, 7);
  Bytes png = encode_grey_png_16(grey, 8, 8);
  png[18] = png[22] = std::byte{0x40};  // 16392 pixels, beyond the most
  CHECK(error_of(png) != "");
}

TEST_CASE("colour layers: plain, named and grey ones are found by their channels") {
  PictureFile file{.path = "a.exr"};
  for (const char* name : {"A", "B", "G", "R", "Z", "deep.Combined.B", "deep.Combined.G",
                           "deep.Combined.R", "mask.Y", "normal.X", "normal.Y", "normal.Z"}) {
    file.planes.push_back({.name = name});
  }
  const auto layers = colour_layers(file);
  REQUIRE(layers.size() == 3);  // a normal is no colour
  CHECK(layers[0].name == "");
  CHECK(layers[0].red == 3);
  CHECK(layers[0].alpha == 0);
  CHECK(layers[1].name == "deep.Combined");
  CHECK(layers[1].red == 7);
  CHECK(layers[2].name == "mask");
  CHECK(layers[2].red == layers[2].blue);
}

TEST_CASE("depth as PNG has whole millimetres, 0 for what has none") {
  const std::vector<float> metres{0.5f, 1.2346f, 0.0f, -1.0f, 70.0f, INFINITY, NAN, 65.535f};
  const PictureFile file = open_picture_file(encode_depth(metres, 8, 1, FileFormat::png), "a.png");
  CHECK(all_planes(file)[0] == PlaneValues{500, 1235, 0, 0, 0, 0, 0, 65535});
}
