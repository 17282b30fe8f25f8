#include "scenes/files/texture_file.h"

#include <doctest/doctest.h>

#include <string>

#include "raster/images/texel.h"
#include "scenes/files/picture_check.h"
#include "tests/support/scene_test_files.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

// load_texture()'s complaint about a file of these bytes, without the file's path.
std::string complaint(const std::string& bytes) {
  const TemporaryDirectory directory;
  const std::string file = directory.file("picture.png");
  write_file(file, bytes);
  const std::string message = scene_error_of([&] { load_texture(file); });
  const std::string prefix = file + ": ";
  return message.starts_with(prefix) ? message.substr(prefix.size()) : "unnamed: " + message;
}

const std::string kJpeg = SOFTFOCUS_TEST_DATA "/red-blue-16x8.jpg";

}  // namespace

TEST_CASE("a PNG becomes an sRGB texture, its first row on top, with mipmaps") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("picture.png");
  write_file(file, png_bytes(8, 4));
  const Texture texture = load_texture(file);
  REQUIRE(texture.levels.size() == 4);
  CHECK(texture.levels[0].format == Format::srgb8);
  CHECK(texture.levels[0].width == 8);
  CHECK(texture.levels[0].height == 4);
  CHECK(load_texel(texture.levels[0], 0, 0) == glm::vec4{1.0f, 0.0f, 0.0f, 1.0f});
  CHECK(load_texel(texture.levels[0], 0, 3) == glm::vec4{0.0f, 1.0f, 0.0f, 1.0f});
}

TEST_CASE("a JPEG becomes a texture") {
  const Texture texture = load_texture(kJpeg);
  CHECK(texture.levels[0].width == 16);
  CHECK(texture.levels[0].height == 8);
  const glm::vec4 left = load_texel(texture.levels[0], 2, 4);
  const glm::vec4 right = load_texel(texture.levels[0], 13, 4);
  CHECK(left.x > 10.0f * left.z);
  CHECK(right.z > 10.0f * right.x);
}

TEST_CASE("a texture may be of any size, not only powers of two") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("picture.png");
  write_file(file, png_bytes(13, 7));
  CHECK(load_texture(file).levels.size() == 4);
}

TEST_CASE("a missing texture is named") {
  const std::string message = scene_error_of([] { load_texture("/nowhere/wood.png"); });
  CHECK(message == "/nowhere/wood.png: no such file; check the path");
}

TEST_CASE("a directory is no texture") {
  const TemporaryDirectory directory;
  const std::string message = scene_error_of([&] { load_texture(directory.path()); });
  CHECK(contains(message, "is a directory"));
}

TEST_CASE("what is no picture is said to be none, and what would be one is said") {
  for (const std::string bytes : {"", "hello", "BM a bitmap of another age"}) {
    CHECK(contains(complaint(bytes), "not a picture that can be read"));
    CHECK(contains(complaint(bytes), "a PNG or JPEG file"));
  }
}

TEST_CASE("a PNG that is cut short is damaged, wherever it is cut") {
  const std::string whole = png_bytes(64, 64);
  for (std::size_t length = 40; length + 20 < whole.size(); length += 7) {
    CAPTURE(length);
    CHECK(contains(complaint(whole.substr(0, length)), "PNG or JPEG file"));
  }
}

TEST_CASE("no memory is taken for what a chunk of a PNG claims and the file does not have") {
  // The length of IDAT, behind the signature and IHDR's 25 bytes.
  std::string png = png_bytes(64, 64);
  REQUIRE(png.substr(37, 4) == "IDAT");
  png.replace(33, 4, std::string("\x7D\xFF\xFF\xFF", 4));
  CHECK(complaint(png).starts_with("is damaged (a chunk goes on past the end)"));
}

TEST_CASE("what comes behind the end of a PNG does not matter") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("longer.png");
  write_file(file, png_bytes(64, 64) + "\x7F\xFF\xFF\xFFmore than this");
  CHECK(load_texture(file).levels[0].width == 64);
}

TEST_CASE("a JPEG that is cut short is damaged, not half grey") {
  const std::string whole = read_file(kJpeg);
  REQUIRE(whole.size() > 100);
  for (std::size_t length = 4; length < whole.size(); length += 11) {
    CAPTURE(length);
    CHECK(contains(complaint(whole.substr(0, length)), "PNG or JPEG file"));
  }
}

TEST_CASE("a JPEG that lacks nothing but its end marker is damaged too") {
  std::string whole = read_file(kJpeg);
  whole.resize(whole.size() - 2);
  CHECK(contains(complaint(whole), "is damaged"));
}

TEST_CASE("a picture larger than a GPU's textures is refused before it is read") {
  // An IHDR that claims 20000 x 2 texels, and one of 16384 x 16384.
  std::string png = png_bytes(4, 4);
  png.replace(16, 8, std::string("\x00\x00\x4E\x20\x00\x00\x00\x02", 8));
  CHECK(contains(complaint(png), "16384"));
  png.replace(16, 8, std::string("\x00\x00\x40\x00\x00\x00\x40\x00", 8));
  CHECK(contains(complaint(png), "is 16384x16384 texels; up to 16384 along a side and 67108864"));
}

TEST_CASE("a JPEG without one of its Huffman tables is refused") {
  std::string bytes = read_file(kJpeg);
  CHECK_FALSE(lacks_huffman_table(bytes));
  // The first table of class 1 becomes number 2.
  bytes[bytes.find(std::string("\x10\x00\x02\x01\x03", 5))] = '\x12';
  CHECK(complaint(bytes).starts_with("is damaged (a scan without its Huffman table)"));
}
