// The example in C, docs/examples/blur_frame.c, where it is built.

#include <doctest/doctest.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#ifdef SOFTFOCUS_EXAMPLE

namespace {

constexpr int kWidth = 160, kHeight = 120;

std::string output() {
  std::FILE* pipe = ::popen(SOFTFOCUS_EXAMPLE, "r");
  REQUIRE(pipe != nullptr);
  std::string bytes;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
    bytes.push_back(static_cast<char>(c));
  }
  CHECK(::pclose(pipe) == 0);
  return bytes;
}

}  // namespace

TEST_CASE("the example in C keeps the middle of its frame sharp and blurs the left") {
  const std::string header = "P6 160 120 255\n";
  const std::string picture = output();
  REQUIRE(picture.size() == header.size() + 3 * kWidth * kHeight);
  CHECK(picture.starts_with(header));
  const auto green = [&](int x, int y) {
    const std::size_t at = header.size() + 3 * static_cast<std::size_t>(y * kWidth + x) + 1;
    return static_cast<int>(static_cast<std::uint8_t>(picture[at]));
  };
  // Squares of 8 pixels, white and one of little green.
  for (int y = 0; y < kHeight; ++y) {
    CAPTURE(y);
    CHECK(green(80, y) == ((80 / 8 + y / 8) % 2 != 0 ? 255 : 52));
    CHECK(green(4, y) > 52);
    CHECK(green(4, y) < 255);
  }
}

TEST_CASE("the example in C has fewer than 60 lines") {
  std::ifstream file(SOFTFOCUS_TEST_DATA "/../../docs/examples/blur_frame.c");
  REQUIRE(file);
  int lines = 0;
  for (std::string line; std::getline(file, line);) ++lines;
  CHECK(lines < 60);
}

#endif
