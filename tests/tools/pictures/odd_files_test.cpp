// Pictures as some programs write them: PFM of Photoshop and netpbm, old runs of HDR, ICC profiles,
// light beyond the largest half, TIFF.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "raster/images/texel.h"
#include "tests/support/run_program.h"
#include "tests/support/skip.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/pictures/picture_file.h"
#include "tools/pictures/png_text.h"

using namespace softfocus;

namespace {

/// 1 2 3 and 4 5 6, in the order of the file.
Bytes pfm_of(std::string_view header) {
  Bytes bytes = bytes_of(header);
  for (int i = 1; i <= 6; ++i) {
    append_little_endian(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(i)));
  }
  return bytes;
}

PlaneValues first_plane(const PictureFile& file) {
  const std::size_t first = 0;
  return read_planes(file, {&first, 1}, 0.0f)[0];
}

const PlaneValues kUpward{4, 5, 6, 1, 2, 3}, kDownward{1, 2, 3, 4, 5, 6};

std::string error_of(const Bytes& bytes) {
  try {
    first_plane(open_picture_file(bytes, "a.file"));
  } catch (const FileError& error) {
    return error.what();
  }
  return {};
}

/// The high byte first.
std::string number(std::size_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 0xFF);
  return text;
}

std::string xyz(double x, double y, double z) {
  std::string text = "XYZ " + number(0);
  for (const double value : {x, y, z})
    text += number(static_cast<std::uint32_t>(std::lround(65536 * value)));
  return text;
}

using Tags = std::vector<std::pair<std::string, std::string>>;

/// An ICC profile of a colour space (ICC.1:2001-04).
Bytes profile(std::string_view space, const Tags& tags) {
  std::string text(128, '\0');
  text.replace(8, 4, number(0x02100000)).replace(12, 4, "mntr").replace(16, 4, space);
  text.replace(20, 4, "XYZ ").replace(36, 4, "acsp").replace(68, 12, xyz(0.9642, 1.0, 0.8249), 8);
  text += number(tags.size());
  std::string data;
  for (const auto& [name, value] : tags) {
    text += name + number(132 + 12 * tags.size() + data.size()) + number(value.size());
    data += value;
  }
  text += data;
  return bytes_of(text.replace(0, 4, number(text.size())));
}

/// With that description alone, of version 2 or 4.
Bytes profile(std::string_view space, std::string_view name, bool is_wide) {
  std::string text = "desc" + number(0) + number(name.size() + 1) + std::string{name} + '\0';
  if (is_wide) {
    text =
        "mluc" + number(0) + number(1) + number(12) + "enUS" + number(2 * name.size()) + number(28);
    for (const char c : name) text += {'\0', c};
  }
  return profile(space, {{"desc", text}});
}

/// Display P3's red, green and blue, adapted to D50, with a line for a curve.
Bytes linear_p3_profile() {
  const std::string line = "curv" + number(0) + number(0);
  return profile("RGB ", {{"wtpt", xyz(0.9642, 1.0, 0.8249)},
                          {"rXYZ", xyz(0.51512, 0.24120, -0.00105)},
                          {"gXYZ", xyz(0.29198, 0.69225, 0.04189)},
                          {"bXYZ", xyz(0.15710, 0.06657, 0.78407)},
                          {"rTRC", line},
                          {"gTRC", line},
                          {"bTRC", line}});
}

Bytes grey_png() {
  Image image = make_image(Format::rgba16f, 24, 16);
  clear_image(image, {0.25f, 0.5f, 0.75f, 1.0f}, {});
  return encode_png(image);
}

}  // namespace

TEST_CASE("PFM: a header with comments, blanks, tabs or CR LF has the same values") {
  for (const char* header : {"Pf\n3 2\n-1.0\n", "Pf\r\n3 2\r\n-1.0\r\n", "Pf 3 2 -1.0\n",
                             "Pf\n# by netpbm\n3 2\n# and so on\n-1.0\n", "Pf\n  3\t2  \n -1.0 \n",
                             "Pf\n3 2\n-1.000000\r\n"}) {
    CAPTURE(header);
    const PictureFile file = open_picture_file(pfm_of(header), "a.pfm");
    CHECK(file.width == 3);
    CHECK(file.height == 2);
    CHECK(first_plane(file) == kUpward);
  }
  // Behind a header's end the first value may look like a blank.
  Bytes bytes = bytes_of("Pf\n1 2\n-1.0\n");
  for (const std::uint32_t bits : {0x0A0D200Au, 0x3F800000u}) append_little_endian(bytes, bits);
  CHECK(first_plane(open_picture_file(bytes, "a.pfm"))[1] == std::bit_cast<float>(0x0A0D200Au));
  CHECK(
      contains(error_of(pfm_of("Pf\n3 3\n-1.0\n")), "24 bytes of values where its size needs 36"));
}

TEST_CASE("PFM: Photoshop's, with width and height on lines of their own, begin with the top row") {
  const PictureFile file = open_picture_file(pfm_of("Pf\n3\n2\n-1.0\n"), "a.pfm");
  CHECK(first_plane(file) == kDownward);
  CHECK(contains(file.remark, "Photoshop"));
  Bytes colour = bytes_of("PF\n1\n2\n-1.0\n");
  for (int i = 1; i <= 6; ++i) {
    append_little_endian(colour, std::bit_cast<std::uint32_t>(static_cast<float>(i)));
  }
  CHECK(load_texel(decode_picture(colour, "a.pfm").image, 0, 0).x == 1.0f);
  CHECK(load_texel(decode_picture(colour, "a.pfm").image, 0, 1).z == 6.0f);
}

TEST_CASE("refocus, apply: --flip turns the rows of PFM files") {
  const TemporaryDirectory directory;
  const std::string up = directory.file("up.pfm"), down = directory.file("down.pfm");
  write_file(up, pfm_of("Pf\n3 2\n-1.0\n"));
  write_file(down, pfm_of("Pf\n3\n2\n-1.0\n"));
  const auto rows = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words{
        "apply", name, "-o", directory.file("o.npy"), "--effect", "gaussian:sigma=0"};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun run = run_program(words);
    CAPTURE(run.err);
    REQUIRE(run.status == 0);
    return load_texel(read_image_file(directory.file("o.npy")).image, 0, 0).x;
  };
  CHECK(rows(up, {}) == 4.0f);
  CHECK(rows(up, {"--flip"}) == 1.0f);
  CHECK(rows(down, {}) == 1.0f);
  CHECK(rows(down, {"--flip"}) == 4.0f);
  CHECK(contains(run_program({"inspect", down}).out, "its top row first, as Photoshop"));
}

TEST_CASE("HDR: old runs repeat the last pixel, and longer ones have two counts") {
  const std::string start = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 300\n";
  Bytes bytes = bytes_of(start);
  const auto put = [&](std::initializer_list<int> values) {
    for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  };
  // 1 and 299 more, 299 = 43 + 256; then 2, 297 more, and 3 3.
  put({128, 0, 0, 129, 1, 1, 1, 43, 1, 1, 1, 1});
  put({128, 0, 0, 130, 1, 1, 1, 41, 1, 1, 1, 1, 192, 0, 0, 130, 192, 0, 0, 130});
  const PlaneValues red = first_plane(open_picture_file(bytes, "a.hdr"));
  for (std::size_t x = 0; x < 300; ++x) CHECK(red[x] == 1.0f);
  for (std::size_t x = 0; x < 300; ++x) CHECK(red[300 + x] == (x < 298 ? 2.0f : 3.0f));
  bytes[bytes.size() - 13] = std::byte{200};  // a count beyond the row
  CHECK(contains(error_of(bytes), "old runs"));
}

TEST_CASE("NPY: a structured array is told as one, with what makes plain numbers of it") {
  const std::string dict =
      "{'descr': [('r', '<f4'), ('g', '<f4')], 'fortran_order': False, 'shape': (1, 1), }";
  Bytes bytes = bytes_of(std::string_view{"\x93NUMPY\x01\x00", 8});
  append_little_endian(bytes, static_cast<std::uint16_t>(dict.size()));
  for (const std::byte b : bytes_of(dict)) bytes.push_back(b);
  CHECK(contains(error_of(bytes), "structured"));
  CHECK(contains(error_of(bytes), "numpy.stack"));
}

TEST_CASE("ICC profiles: PNG and JPEG keep theirs in a PNG, and are told where there is no place") {
  const TemporaryDirectory directory;
  const Bytes p3 = profile("RGB ", "Display P3", true);
  const Bytes adobe = profile("RGB ", "Adobe RGB (1998)", false);
  const std::string png = directory.file("a.png"), jpeg = directory.file("a.jpg");
  write_file(png, with_png_profile(grey_png(), p3));
  Bytes file = read_picture_bytes(SOFTFOCUS_TEST_DATA "/red-blue-16x8.jpg");
  // In two segments, as of a profile above 64 kB.
  std::string segments;
  const std::string whole = text_of(adobe);
  for (const int part : {1, 2}) {
    const std::string half = part == 1 ? whole.substr(0, 100) : whole.substr(100);
    const std::string data =
        std::string{"ICC_PROFILE\0", 12} + static_cast<char>(part) + '\2' + half;
    segments += "\xFF\xE2" + std::string{'\0', static_cast<char>(data.size() + 2)} + data;
  }
  const Bytes inserted = bytes_of(segments);
  file.insert(file.begin() + 2, inserted.begin(), inserted.end());
  write_file(jpeg, file);
  CHECK(open_picture_file(png).icc == p3);
  CHECK(open_picture_file(jpeg).icc == adobe);
  CHECK(contains(run_program({"inspect", png}).out, "ICC profile Display P3"));
  CHECK(contains(run_program({"inspect", jpeg}).out, "ICC profile Adobe RGB (1998)"));
  const auto made = [&](const std::string& from, const std::string& to) {
    const ProgramRun run = run_program({"apply", from, "-o", to, "--effect", "gaussian:sigma=0"});
    CHECK(run.status == 0);
    return run.err;
  };
  const std::string out = directory.file("o.png");
  CHECK(made(png, out).empty());
  CHECK(open_picture_file(out).icc == p3);
  // The numbers are the same: what is not changed looks as it did.
  CHECK(equal(read_image_file(out).image, read_image_file(png).image));
  CHECK(made(jpeg, out).empty());
  CHECK(open_picture_file(out).icc == adobe);
  CHECK(
      contains(made(png, directory.file("o.npy")), "profile Display P3, which the result has no"));
  write_file(png, with_png_profile(grey_png(), profile("GRAY", "Dot Gain 20%", true)));
  CHECK(contains(made(png, out), "Dot Gain 20%"));
  CHECK(open_picture_file(out).icc.empty());
  write_file(png, with_png_profile(grey_png(), p3));
  const std::string depth = directory.file("d.npy");
  write_file(depth, encode_grey_npy(PlaneValues(24 * 16, 2.0f), 24, 16));
  const ProgramRun run = run_program({"refocus", png, depth, "-o", out});
  CHECK(run.status == 0);
  CHECK(contains(run.err, "the profile Display P3"));
  CHECK(open_picture_file(out).icc == p3);
}

TEST_CASE("--icc srgb: a colour's light is that of sRGB's primaries, and the profile goes") {
  const TemporaryDirectory directory;
  const std::string from = directory.file("a.png"), to = directory.file("o.exr");
  const auto applied = [&](const std::string& out) {
    return run_program({"apply", from, "-o", out, "--effect", "gaussian:sigma=0", "--icc", "srgb"});
  };
  write_file(from, with_png_profile(grey_png(), linear_p3_profile()));
  const ProgramRun run = applied(directory.file("o.npy"));
  if (!missing_lcms().empty()) {
    CHECK(run.status == 2);
    CHECK(contains(run.err, "liblcms2-dev"));
    return;
  }
  CAPTURE(run.err);
  REQUIRE(run.status == 0);
  // Of Display P3 to sRGB, by the matrices of both (CSS Color 4).
  const std::array<float, 3> p3{137.0f / 255.0f, 188.0f / 255.0f, 225.0f / 255.0f};
  const glm::vec4 colour = load_texel(read_image_file(directory.file("o.npy")).image, 3, 3);
  CHECK(colour.x == doctest::Approx(1.2249f * p3[0] - 0.2247f * p3[1]).epsilon(0.01));
  CHECK(colour.y == doctest::Approx(-0.0420f * p3[0] + 1.0419f * p3[1]).epsilon(0.01));
  CHECK(colour.z ==
        doctest::Approx(-0.0197f * p3[0] - 0.0786f * p3[1] + 1.0979f * p3[2]).epsilon(0.01));
  REQUIRE(applied(directory.file("o.png")).status == 0);
  CHECK(open_picture_file(directory.file("o.png")).icc_name.empty());
}

TEST_CASE("refocus: colours beyond the largest half keep their light") {
  const TemporaryDirectory directory;
  const std::string from = directory.file("a.pfm"), depth = directory.file("d.npy");
  constexpr int kSide = 41;
  const auto write_lamp = [&](float light) {
    Bytes bytes = bytes_of("PF\n41 41\n-1.0\n");
    for (int i = 0; i < 3 * kSide * kSide; ++i) {
      const bool is_lamp = i / 3 == kSide * (kSide / 2) + kSide / 2;
      append_little_endian(bytes, std::bit_cast<std::uint32_t>(is_lamp ? light : 0.25f));
    }
    write_file(from, bytes);
  };
  write_file(depth, encode_grey_npy(PlaneValues(kSide * kSide, 1e10f), kSide, kSide));
  const auto sum = [&](const std::string& out, const char* method) {
    const ProgramRun run =
        run_program({"refocus", from, depth, "-o", out, "--focus", "2", "--blur-at-infinity", "7",
                     "--method", method, "--depth-encoding", "metres"});
    CAPTURE(run.err);
    REQUIRE(run.status == 0);
    CHECK(contains(run.err, "colours up to 1e+06 are filtered at 1/16 of their light"));
    double light = 0.0;
    for (const float value : first_plane(open_picture_file(out))) {
      light += static_cast<double>(value);
    }
    return light;
  };
  write_lamp(1e6f);
  for (const char* method : {"disc-layers", "two-pass"}) {
    for (const char* name : {"o.pfm", "o.hdr", "o.npy"}) {
      CHECK(sum(directory.file(name), method) ==
            doctest::Approx(1e6 + 0.25 * kSide * kSide).epsilon(0.01));
    }
  }
  // Beyond what the power holds it is told.
  write_lamp(1e9f);
  const ProgramRun run =
      run_program({"refocus", from, depth, "-o", directory.file("o.pfm"), "--focus", "2"});
  CHECK(contains(run.err, "colours beyond 6.70761e+07 or infinite are cut to that, in 3 values"));
  CHECK(
      contains(run_program({"apply", from, "-o", directory.file("o.pfm"), "--effect", "box-3"}).err,
               "colours beyond 65504 or infinite"));
  write_lamp(std::numeric_limits<float>::infinity());
  for (const char* method : {"disc-layers", "two-pass"}) {
    CHECK(contains(run_program({"refocus", from, depth, "-o", directory.file("o.pfm"), "--method",
                                method, "--focus", "2"})
                       .err,
                   "colours beyond 65504 or infinite are cut to that, in 3 values"));
  }
}

namespace {

/// A TIFF of one strip, or of one tile a sample: 3 x 2 pixels in blocks of `across` x `down`.
struct TiffOf {
  bool high_byte_first = false;
  unsigned bits = 16, samples = 1, format = 1, photometric = 1, orientation = 1;
  bool apart = false, tiled = false, is_multiplied = false;

  std::string number(std::uint64_t value, unsigned bytes) const {
    std::string text;
    for (unsigned i = 0; i < bytes; ++i) {
      text += static_cast<char>(value >> (8 * (high_byte_first ? bytes - 1 - i : i)) & 0xFF);
    }
    return text;
  }

  /// The blocks' bytes stand behind the head.
  Bytes with(const std::vector<std::string>& blocks) const {
    constexpr unsigned kShort = 3, kLong = 4;
    std::vector<std::array<unsigned, 3>> entries{{256, kLong, 3},
                                                 {257, kLong, 2},
                                                 {258, kShort, bits},
                                                 {259, kShort, 1},
                                                 {262, kShort, photometric},
                                                 {274, kShort, orientation},
                                                 {277, kShort, samples},
                                                 {284, kShort, apart ? 2u : 1u},
                                                 {339, kShort, format}};
    if (tiled) {
      entries.push_back({322, kLong, 16});
      entries.push_back({323, kLong, 16});
    } else {
      entries.push_back({278, kLong, 2});
    }
    if (is_multiplied) entries.push_back({338, kShort, 1});
    const auto count = static_cast<unsigned>(blocks.size());
    const unsigned places = tiled ? 324 : 273, lengths = tiled ? 325 : 279;
    const unsigned head = 8 + 2 + 12 * static_cast<unsigned>(entries.size() + 2) + 4;
    const unsigned data = head + (count > 1 ? 8 * count : 0);
    std::string text = (high_byte_first ? "MM" : "II") + number(42, 2) + number(8, 4);
    std::string lists[2], all;
    for (const std::string& block : blocks) {
      lists[0] += number(data + all.size(), 4);
      lists[1] += number(block.size(), 4);
      all += block;
    }
    entries.push_back({places, kLong, 0});
    entries.push_back({lengths, kLong, 0});
    std::sort(entries.begin(), entries.end());
    text += number(entries.size(), 2);
    for (const auto& [tag, type, value] : entries) {
      const bool is_list = tag == places || tag == lengths;
      // Bits and forms are alike for all samples; readers take one for all.
      text += number(tag, 2) + number(type, 2) + number(is_list ? count : 1, 4);
      const std::string& list = lists[tag == lengths ? 1 : 0];
      if (is_list && count > 1) {
        text += number(head + (tag == lengths ? 4 * count : 0), 4);
      } else {
        text += is_list ? list
                        : number(value, type == kShort ? 2 : 4) +
                              std::string(type == kShort ? 2 : 0, '\0');
      }
    }
    text += number(0, 4);
    if (count > 1) text += lists[0] + lists[1];
    return bytes_of(text + all);
  }

  /// The whole numbers or floats from 1 on, `of` of them.
  std::string counted(unsigned of, unsigned first = 1) const {
    std::string text;
    for (unsigned i = first; i < first + of; ++i) {
      const auto value = static_cast<float>(i);
      text += number(format == 1  ? i
                     : bits == 16 ? float_to_half(value, HalfRounding::nearest_even)
                     : bits == 32 ? std::bit_cast<std::uint32_t>(value)
                                  : std::bit_cast<std::uint64_t>(static_cast<double>(value)),
                     bits / 8);
    }
    return text;
  }
};

PlaneValues plane_of(const Bytes& bytes, std::size_t plane) {
  return read_planes(open_picture_file(bytes, "a.tiff"), {&plane, 1}, 0.0f)[0];
}

}  // namespace

TEST_CASE("TIFF: whole numbers and floats of each size, of both byte orders") {
  if (!missing_tiff().empty()) return skip("TIFF", missing_tiff());
  for (const bool high : {false, true}) {
    for (const auto& kind :
         {std::pair{8u, 1u}, {16u, 1u}, {32u, 1u}, {16u, 3u}, {32u, 3u}, {64u, 3u}}) {
      const unsigned bits = kind.first, format = kind.second;
      CAPTURE(bits);
      CAPTURE(format);
      const TiffOf tiff{.high_byte_first = high, .bits = bits, .format = format};
      const Bytes bytes = tiff.with({tiff.counted(6)});
      CHECK(plane_of(bytes, 0) == kDownward);
      const PictureFile file = open_picture_file(bytes, "a.tiff");
      CHECK(file.is_srgb == (format == 1));
      CHECK(file.planes[0].name == "Y");
    }
  }
}

TEST_CASE("TIFF: planes apart, tiles, white as 0 and an orientation") {
  if (!missing_tiff().empty()) return skip("TIFF", missing_tiff());
  TiffOf apart{.samples = 3, .photometric = 2, .apart = true};
  const Bytes rgb = apart.with({apart.counted(6), apart.counted(6, 11), apart.counted(6, 21)});
  CHECK(plane_of(rgb, 0) == kDownward);
  CHECK(plane_of(rgb, 2) == PlaneValues{21, 22, 23, 24, 25, 26});
  TiffOf together{.bits = 8, .samples = 3, .photometric = 2};
  CHECK(plane_of(together.with({together.counted(18)}), 1) == PlaneValues{2, 5, 8, 11, 14, 17});
  TiffOf tiles{.bits = 32, .format = 3, .tiled = true};
  std::string tile;
  for (unsigned y = 0; y < 16; ++y) tile += tiles.counted(16, 16 * y + 1);
  CHECK(plane_of(tiles.with({tile}), 0) == PlaneValues{1, 2, 3, 17, 18, 19});
  TiffOf inverse{.bits = 8, .photometric = 0};
  CHECK(plane_of(inverse.with({inverse.counted(6)}), 0) ==
        PlaneValues{254, 253, 252, 251, 250, 249});
  TiffOf turned{.orientation = 6};
  CHECK(plane_of(turned.with({turned.counted(6)}), 0) == PlaneValues{4, 1, 5, 2, 6, 3});
}

TEST_CASE("TIFF: colours that are multiplied by their alpha are divided by it") {
  if (!missing_tiff().empty()) return skip("TIFF", missing_tiff());
  const TiffOf whole{.bits = 8, .samples = 2, .is_multiplied = true};
  const Bytes bytes = whole.with({std::string("\x32\x64\xFF\xFF\0\0\x05\0\x80\x80\x40\x80", 12)});
  CHECK(plane_of(bytes, 0) == PlaneValues{128, 255, 0, 5, 255, 128});  // 50 255 / 100 = 127.5
  CHECK(plane_of(bytes, 1) == PlaneValues{100, 255, 0, 0, 128, 128});
  const TiffOf light{.bits = 32, .samples = 2, .format = 3, .is_multiplied = true};
  CHECK(plane_of(light.with({light.counted(12)}), 0) ==
        PlaneValues{0.5f, 3.0f * 0.25f, 5.0f * (1.0f / 6.0f), 7.0f * 0.125f, 9.0f * (1.0f / 10.0f),
                    11.0f * (1.0f / 12.0f)});
}

TEST_CASE("TIFF: black and white, of a bit a pixel") {
  if (!missing_tiff().empty()) return skip("TIFF", missing_tiff());
  const TiffOf bits{.bits = 1};
  CHECK(plane_of(bits.with({std::string("\xA0\x40", 2)}), 1) ==
        PlaneValues{255, 0, 255, 0, 255, 0});
}

TEST_CASE("TIFF: what is cut short, of odd numbers or too large for its bytes is refused") {
  if (!missing_tiff().empty()) return skip("TIFF", missing_tiff());
  const TiffOf tiff{};
  Bytes bytes = tiff.with({tiff.counted(6)});
  for (std::size_t size = 4; size < bytes.size(); ++size) {
    CAPTURE(size);
    CHECK(error_of(Bytes{bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)})
              .find("the TIFF is damaged") != std::string::npos);
  }
  const TiffOf odd{.bits = 24, .format = 3};
  CHECK(error_of(odd.with({std::string(18, 'x')})).find("floats would be right") !=
        std::string::npos);
}

TEST_CASE("TIFF: what is written has a 16-bit PNG's numbers, with alpha and a profile") {
  if (!missing_tiff().empty()) return skip("TIFF", missing_tiff());
  Image image = make_image(Format::rgba16f, 5, 4);
  for (int i = 0; i < 20; ++i) {
    const auto light = static_cast<float>(i) / 20.0f;
    store_texel(image, i % 5, i / 5, {light, light * light, 1.0f - light, 1.0f}, {});
  }
  std::vector<float> alpha(20, 0.75f);
  const Bytes icc = linear_p3_profile();
  const PictureFile file = open_picture_file(encode_tiff(image, alpha, icc), "a.tiff");
  const PictureFile png = open_picture_file(encode_png_16(image, alpha), "a.png");
  REQUIRE(file.planes.size() == 4);
  for (std::size_t plane = 0; plane < 4; ++plane) {
    CHECK(read_planes(file, {&plane, 1}, 0.0f)[0] == read_planes(png, {&plane, 1}, 0.0f)[0]);
  }
  CHECK(file.icc == icc);
}
