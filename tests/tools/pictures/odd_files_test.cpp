// Pictures as some programs write them: PFM of Photoshop and netpbm, old runs of HDR, ICC profiles,
// light beyond the largest half.

#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "raster/images/texel.h"
#include "tests/support/run_program.h"
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
