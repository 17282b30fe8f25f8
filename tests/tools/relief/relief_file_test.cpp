#include "tools/relief/relief_file.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "tests/support/relief_pictures.h"
#include "tools/cli/errors.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

std::string text_of(const ReliefTexture& relief) {
  const std::vector<std::byte> bytes = encode_relief(relief);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string complaint_of(const std::string& bytes) {
  try {
    decode_relief(bytes, "a.relief");
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

bool says(const std::string& bytes, const std::string& part) {
  const std::string complaint = complaint_of(bytes);
  CAPTURE(complaint);
  CHECK(complaint.starts_with("'a.relief'"));
  CHECK(complaint.find('\n') == std::string::npos);
  return complaint.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a relief comes back from its file as it was") {
  for (const int bits : {8, 16}) {
    ReliefTexture relief = rough_relief(13, 7, bits, 4);
    if (bits == 16) relief.normals.assign(relief.colours.size(), 0x00812345u);
    const ReliefTexture back = decode_relief(text_of(relief), "a.relief");
    CHECK(back.width == 13);
    CHECK(back.height == 7);
    CHECK(back.depth_bits == bits);
    CHECK(back.depths == relief.depths);
    CHECK(back.colours == relief.colours);
    CHECK(back.normals == relief.normals);
    CHECK(back.camera.origin == relief.camera.origin);
    CHECK(back.camera.a == relief.camera.a);
    CHECK(back.camera.b == relief.camera.b);
    CHECK(back.camera.f == relief.camera.f);
    CHECK(back.camera.depth_m == relief.camera.depth_m);
  }
}

TEST_CASE("a perspective relief's file keeps its eye, and an eye that cannot be is refused") {
  const ReliefTexture relief = seen_from_eye(rough_relief(13, 7, 8, 4), {0.1, -0.2, 0.9});
  const ReliefTexture back = decode_relief(text_of(relief), "a.relief");
  CHECK(back.camera.eye == relief.camera.eye);
  CHECK(back.colours == relief.colours);
  CHECK(says(text_of(seen_from_eye(relief, {0.0, 0.0, 0.2})), "eye must be before the plane"));
  CHECK(says(text_of(seen_from_eye(relief, {0.0, NAN, 0.9})), "eye must be before the plane"));
}

TEST_CASE("a relief's file that was cut short or made longer is refused at any length") {
  const std::string whole = text_of(rough_relief(5, 4, 8, 4));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    CHECK(complaint_of(whole.substr(0, length)) != "");
  }
  CHECK(says(whole.substr(0, 20), "cut short"));
  CHECK(says(whole + "x", "bytes; 5x4 texels take"));
}

TEST_CASE("a changed byte is found") {
  const std::string whole = text_of(rough_relief(5, 4, 8, 4));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 4);
    CHECK(complaint_of(changed) != "");
  }
}

TEST_CASE("wrong sizes, bits, cameras and empty depths get a line that says so") {
  const auto with = [](const auto& change) {
    ReliefTexture relief = rough_relief(5, 4, 8, 4);
    change(relief);
    return text_of(relief);
  };
  CHECK(says("PNG", "is no relief texture"));
  CHECK(says(with([](ReliefTexture& r) { r.width = 5000; }), "claims 5000x4 texels"));
  CHECK(says(with([](ReliefTexture& r) { r.depth_bits = 12; }), "12 bits of depth"));
  CHECK(says(with([](ReliefTexture& r) { r.camera.f *= 2.0; }), "right angles"));
  CHECK(says(with([](ReliefTexture& r) { r.camera.a = r.camera.b; }), "right angles"));
  CHECK(says(with([](ReliefTexture& r) { r.camera.depth_m = 0.0; }), "depth above 0"));
  CHECK(says(with([](ReliefTexture& r) { r.depths.assign(20, 255); }), "shows nothing"));
  CHECK(says(with([](ReliefTexture& r) { r.camera.a *= 1e-12; }), "1e-9 to 1e9 m"));
  CHECK(says(with([](ReliefTexture& r) { r.camera.depth_m = INFINITY; }), "1e-9 to 1e9 m"));
  CHECK(says(with([](ReliefTexture& r) { r.camera.origin.y = NAN; }), "within 1e9 m"));
}

TEST_CASE("every number of a header that cannot be is refused with what would be right") {
  struct BadNumber {
    std::size_t at;  // of a header's number of 32 bits
    std::uint32_t value;
    const char* says;
  };
  constexpr std::size_t kVersion = 8, kWidth = 12, kHeight = 16, kBits = 20, kNormals = 24;
  const std::string whole = text_of(rough_relief(5, 4, 8, 4));
  for (const BadNumber& bad : {BadNumber{kVersion, 0, "has version 0; 1 or 2"},
                               {kVersion, 3, "has version 3; 1 or 2"},
                               {kVersion, 2, "texels take"},
                               {kWidth, 0, "claims 0x4 texels; each side has 1 to 4096"},
                               {kWidth, 6, "6x4 texels take"},
                               {kHeight, 0xFFFFFFFFu, "claims 5x4294967295 texels"},
                               {kHeight, 3, "5x3 texels take"},
                               {kBits, 0, "claims 0 bits"},
                               {kBits, 16, "texels take"},
                               {kNormals, 1, "texels take"},
                               {kNormals, 2, "texels take"},
                               {kNormals, 3, "3 for its maps; 8 or 16, and 0, 1 or 2"}}) {
    std::string changed = whole;
    for (std::size_t i = 0; i < 4; ++i) {
      changed[bad.at + i] = static_cast<char>(bad.value >> (8 * i) & 255u);
    }
    CAPTURE(bad.says);
    CHECK(says(changed, bad.says));
  }
}

TEST_CASE("an unlit relief comes back from its file as it was, cut short nowhere") {
  ReliefTexture relief = rough_relief(5, 4, 8, 4);
  relief.unlit = relief.colours;
  relief.materials = {{glm::vec3{0.25f}, glm::vec3{0.5f}, 32, true},
                      {glm::vec3{0.0f}, glm::vec3{0.0f}, 1, false}};
  relief.normals.assign(20, 0x01808080u);
  const std::string whole = text_of(relief);
  const ReliefTexture back = decode_relief(whole, "f");
  CHECK(back.unlit == relief.unlit);
  CHECK(back.normals == relief.normals);
  REQUIRE(back.materials.size() == 2);
  CHECK(back.materials[0].specular == glm::vec3{0.5f});
  CHECK(back.materials[0].shininess == 32);
  CHECK(back.materials[0].lit);
  CHECK(!back.materials[1].lit);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    CHECK(complaint_of(whole.substr(0, length)) != "");
  }
  relief.normals[3] |= 2u << 24;
  CHECK(says(text_of(relief), "a texel of material 3 of 2"));
  relief.normals[3] = 0;
  relief.materials[1].shininess = 0;
  CHECK(says(text_of(relief), "wrong material 1"));
  relief.materials.clear();
  CHECK(says(text_of(relief), "claims 0 materials"));
}
