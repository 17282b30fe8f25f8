// softfocus refocus: files that are damaged, hostile or no depth, and places that cannot be
// written.

#include <cmath>
#include <limits>

#include "raster/images/image.h"
#include "raster/numbers/half.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tests/support/sanitizers.h"
#include "tests/support/skip.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/picture_file.h"
#include "tools/pictures/png_text.h"

using namespace softfocus;
using nlohmann::json;

namespace {

/// A grey picture a.npy and its depth d.pfm, 8x6.
struct SmallPair {
  TemporaryDirectory directory;
  std::string colour = directory.file("a.npy"), depth = directory.file("d.pfm");
  std::string out = directory.file("out.png");

  SmallPair() {
    write_file(colour, encode_npy(make_image(Format::rgba16f, 8, 6)));
    put_depth(std::vector<float>(48, 2.0f));
  }
  void put_depth(const std::vector<float>& metres) const {
    write_file(depth, encode_grey_pfm(metres, 8, 6));
  }
};

/// A PNG of a size and no more data than `data`.
std::string small_png(int width, int height, const std::string& data) {
  std::string header;
  for (const int side : {width, height}) {
    for (int shift = 24; shift >= 0; shift -= 8) header += static_cast<char>(side >> shift & 0xFF);
  }
  header += std::string{"\x10\x02\0\0\0", 5};
  Bytes bytes;
  for (const char c : kPngSignature) bytes.push_back(static_cast<std::byte>(c));
  append_png_chunk(bytes, "IHDR", header);
  append_png_chunk(bytes, "IDAT", data);
  append_png_chunk(bytes, "IEND", {});
  return text_of(bytes);
}

/// An EXR whose windows end at another pixel in place of 7,5.
std::string swollen_exr(std::uint32_t right, std::uint32_t bottom) {
  std::string text = text_of(encode_exr(make_image(Format::rgba16f, 8, 6), ExrNumbers::half, ""));
  for (const std::string name : {"dataWindow", "displayWindow"}) {
    const auto at = text.find(name) + name.size() + 1 + sizeof "box2i" + 4;
    for (std::size_t byte = 0; byte < 4; ++byte) {
      text[at + 8 + byte] = static_cast<char>(right >> 8 * byte & 0xFF);
      text[at + 12 + byte] = static_cast<char>(bottom >> 8 * byte & 0xFF);
    }
  }
  return text;
}

}  // namespace

TEST_CASE(
    "bad input: small files that claim a gigabyte are refused by their size, as either file") {
  const SmallPair files;
  const std::string filler(1000, 'x');
  struct Hostile {
    std::string name, text;
  };
  std::vector<Hostile> all{
      {"h.pfm", "PF\n16384 16384\n-1.0\n" + filler},
      {"h.pfm", "Pf\n2000000000 1\n-1.0\n" + filler},
      {"h.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n" + filler},
      {"h.npy", std::string{"\x93NUMPY\x01\0\x76\0", 10} +
                    "{'descr': '<f8', 'fortran_order': False, 'shape': (16384, 16384, 4), }" +
                    std::string(47, ' ') + "\n" + filler},
      {"h.npy", std::string{"\x93NUMPY\x01\0\x76\0", 10} +
                    "{'descr': '<f8', 'fortran_order': False, 'shape': (1048576, 16384, 4), }" +
                    std::string(45, ' ') + "\n" + filler},
      {"h.npy", std::string{"\x93NUMPY\x02\0\xFF\xFF\xFF\x7F", 12} + filler},
      {"h.pfm", "PF\n16384 1048576\n-1.0\n" + filler},
      {"h.png", small_png(16384, 16384, filler)},
      {"h.png", std::string{kPngSignature} + std::string{"\x7F\xFF\xFF\xFFIHDR", 8} + filler},
      {"h.jpg", std::string{"\xFF\xD8\xFF\xC0\0\x11\x08\x40\0\x40\0\x03", 12} + filler}};
  if (missing_exr().empty()) {
    all.push_back({"h.exr", swollen_exr(0x3FFF, 0x3FFF)});
    all.push_back({"h.exr", swollen_exr(0x3FFF, 0xFFFFF)});  // terabytes, by rows
    all.push_back({"h.exr", swollen_exr(7, 0x7FFFFFF0)});
    all.push_back({"h.exr", swollen_exr(0x7FFFFFF0, 0x7FFFFFF0)});
  }
  for (const Hostile& hostile : all) {
    CAPTURE(hostile.name);
    const std::string file = files.directory.file(hostile.name);
    write_file(file, hostile.text);
    check_refused(files.directory, {"refocus", file, files.depth, "-o", files.out}, 1,
                  {hostile.name, "cannot read"});
    check_refused(files.directory, {"refocus", files.colour, file, "-o", files.out}, 1,
                  {hostile.name, "cannot read"});
    check_refused(files.directory,
                  {"refocus", files.colour, files.depth, "-o", files.out, "--mask", file}, 1,
                  {hostile.name, "cannot read"});
    check_refused(files.directory, {"inspect", file}, 1, {hostile.name, "cannot read"});
    const ProgramRun run = run_program({"refocus", file, files.depth, "-o", files.out});
    if (!kHasSanitizers) CHECK(run.peak_kib < 100 * 1024);
    const ProgramRun rows =
        run_program({"refocus", file, files.depth, "-o", files.directory.file("out.npy")});
    CHECK(rows.status == 1);
    if (!kHasSanitizers) CHECK(rows.peak_kib < 100 * 1024);
  }
}

TEST_CASE("bad input: a file that is cut short anywhere is refused, and nothing is written") {
  const SmallPair files;
  const Image picture = make_image(Format::rgba16f, 8, 6);
  std::vector<std::pair<std::string, Bytes>> whole{{"c.png", encode_png(picture)},
                                                   {"c.pfm", encode_pfm(picture)},
                                                   {"c.npy", encode_npy(picture)},
                                                   {"c.hdr", encode_hdr(picture)}};
  if (missing_exr().empty()) whole.push_back({"c.exr", encode_exr(picture, ExrNumbers::half, "")});
  for (const auto& [name, bytes] : whole) {
    for (const std::size_t length : {bytes.size() - 1, bytes.size() / 2, std::size_t{12}}) {
      const std::string file = files.directory.file(name);
      write_file(file, text_of(bytes).substr(0, length));
      check_refused(files.directory, {"refocus", file, files.depth, "-o", files.out}, 1, {name});
    }
  }
}

TEST_CASE("bad input: NaN, negative and infinite depths are missing or far, never a crash") {
  const SmallPair files;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> metres(48, 2.0f);
  metres[3] = kNan;
  metres[11] = -1.0f;
  metres[12] = -kInfinity;
  metres[20] = kInfinity;  // the sky
  metres[30] = 1e-40f;
  metres[31] = 3e38f;
  files.put_depth(metres);
  for (const std::string method : {"two-pass", "disc-layers", "scatter-aperture", "auto"}) {
    const ProgramRun run =
        run_program({"refocus", files.colour, files.depth, "-o", files.out, "--depth-encoding",
                     "metres", "--focus", "2", "--method", method, "--json"});
    CHECK(run.status == 0);
    REQUIRE(json::accept(run.out));
    CHECK(json::parse(run.out)["filled_pixels"] == 3);
  }
  check_refused(files.directory,
                {"refocus", files.colour, files.depth, "-o", files.directory.file("b.png"),
                 "--depth-encoding", "metres", "--holes", "refuse"},
                2, {"--holes refuse", "3 of 48"});
  files.put_depth(std::vector<float>(48, kNan));
  check_refused(files.directory,
                {"refocus", files.colour, files.depth, "-o", files.directory.file("b.png"),
                 "--depth-encoding", "metres"},
                2, {"d.pfm", "no depth that is known"});
}

TEST_CASE("bad input: depths of almost 0 stay numbers, in a smaller map too") {
  const SmallPair files;
  std::vector<float> metres(12, 16.5f);
  metres[0] = 2.4e-32f;
  metres[1] = 0.0f;
  metres[4] = 9e-40f;
  write_file(files.depth, encode_grey_pfm(metres, 4, 3));
  const std::string out = files.directory.file("out.npy");
  const ProgramRun run = run_program(
      {"refocus", files.colour, files.depth, "-o", out, "--depth-encoding", "metres", "-q"});
  CHECK(run.status == 0);
  const Image result = read_image_file(out).image;
  for (int y = 0; y < result.height; ++y) {
    for (const std::uint16_t half : row<std::uint16_t>(result, y)) {
      CHECK(half_to_float(half) >= 0.0f);  // NaN is not
    }
  }
}

TEST_CASE("bad input: a layer that is not there is answered with those that are") {
  if (!missing_exr().empty()) return;
  const SmallPair files;
  const std::string file = files.directory.file("l.exr");
  write_file(file, encode_exr(make_image(Format::rgba16f, 8, 6), ExrNumbers::half, ""));
  check_refused(files.directory, {"refocus", file, "-o", files.out, "--depth-layer", "deep"}, 2,
                {"--depth-layer 'deep'", "l.exr", "B, G, R, Z"});
  check_refused(files.directory, {"refocus", file, "-o", files.out, "--layer", "beauty"}, 2,
                {"--layer 'beauty'", "R, G, B"});
  check_refused(files.directory,
                {"refocus", files.colour, file, "-o", files.out, "--depth-layer", "deep"}, 2,
                {"--depth-layer 'deep'", "B, G, R, Z"});
}

TEST_CASE("bad input: refocus writes over nothing that it reads, links and sidecars included") {
  const SmallPair files;
  const std::string link = files.directory.file("link.pfm");
  std::filesystem::create_symlink(files.depth, link);
  check_refused(files.directory, {"refocus", files.colour, files.depth, "-o", link}, 2,
                {"-o", "write over"});
  const std::string hard = files.directory.file("hard.npy");
  std::filesystem::create_hard_link(files.colour, hard);
  check_refused(files.directory, {"refocus", files.colour, files.depth, "-o", hard}, 2,
                {"-o", "write over"});
  check_refused(files.directory,
                {"refocus", files.colour, files.depth, "-o", files.out, "--mask", files.out}, 2,
                {"-o", "write over"});
  check_refused(
      files.directory,
      {"refocus", files.colour, files.depth, "-o", files.out, "-o", files.directory.file("b.png")},
      2, {"-o", "twice"});
  const std::string sidecar = files.directory.file("d.npy.json");
  std::filesystem::copy_file(files.depth, sidecar);
  check_refused(files.directory,
                {"refocus", files.colour, sidecar, "-o", files.directory.file("d.npy")}, 2,
                {"the sidecar of -o", "write over"});
}

TEST_CASE("bad input: an empty name, as of a variable that is not set, is no file") {
  const SmallPair files;
  check_refused(files.directory, {"refocus", "", files.depth, "-o", files.out}, 1,
                {"cannot read ''"});
  check_refused(files.directory,
                {"refocus", files.colour, files.depth, "-o", files.out, "--mask", ""}, 1,
                {"cannot read ''"});
}

TEST_CASE("bad input: a place that refocus cannot write, and a full disk") {
  const SmallPair files;
  check_refused(files.directory,
                {"refocus", files.colour, files.depth, "-o", files.directory.file("no/such.png")},
                1, {"no/such.png"});
  check_refused(
      files.directory,
      {"refocus", files.colour, files.depth, "-o", files.directory.path(), "--format", "png"}, 1,
      {files.directory.path()});
  for (const std::string name : {"full.png", "full.npy", "full.pfm"}) {
    check_refused(files.directory,
                  {"refocus", files.colour, files.depth, "-o", files.directory.file(name),
                   "--depth-encoding", "metres"},
                  1, {name}, {.file_size_limit = 32});
  }
  if (!std::filesystem::exists("/dev/full")) return skip("full-device", "no /dev/full");
  check_refused(files.directory,
                {"refocus", files.colour, files.depth, "-o", "/dev/full", "--format", "npy",
                 "--depth-encoding", "metres"},
                1, {"/dev/full", "space"});
}

TEST_CASE("bad input: a PNG that is too wide is told its size") {
  const SmallPair files;
  const std::string file = files.directory.file("wide.png");
  write_file(file, small_png(16385, 1, "data"));
  check_refused(files.directory, {"refocus", file, files.depth, "-o", files.out}, 1,
                {"wide.png", "16385x1", "1 to 16384"});
  check_refused(files.directory, {"compare", file, file}, 2, {"wide.png", "16385x1"});
}

TEST_CASE("bad input: inspect writes over nothing that it reads, and says so before anything") {
  const SmallPair files;
  for (const std::string& file : {files.colour, files.depth}) {
    check_refused(files.directory, {"inspect", files.colour, files.depth, "-o", file}, 2,
                  {"-o", "write over"});
  }
  check_refused(files.directory, {"inspect", files.colour, files.depth, "-o", "-"}, 2,
                {"-o -", "a file"});
  check_refused(files.directory,
                {"inspect", files.colour, files.depth, "-o", files.directory.file("no/such.png")},
                1, {"no/such.png"});
}
