#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "dof/two_pass/two_pass.h"
#include "tests/support/test_images.h"
#include "tools/boards/float_filter.h"
#include "tools/boards/frame.h"

using namespace softfocus;

namespace {

/// Depth codes 0 to 255 are 1 + code / 64 metres, which halves hold.
struct CodedPicture {
  Image image;
  std::vector<std::uint8_t> codes;
};

CodedPicture random_coded_picture(int width, int height) {
  CodedPicture picture{make_image(Format::rgba16f, width, height), {}};
  Random random{7};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      // Stripes of one depth, and noise.
      const auto chance = static_cast<int>(random.next() >> 56);
      const int code = (x / 9 + y / 7) % 3 == 0 ? chance : x / 9 % 7 * 40;
      picture.codes.push_back(static_cast<std::uint8_t>(code));
      store_texel(
          picture.image, x, y,
          {random.unit(), random.unit(), random.unit(), 1.0f + static_cast<float>(code) / 64.0f},
          {});
    }
  }
  return picture;
}

/// The board's filter applied to a picture, stored as halves.
Image filter_on_board(const CodedPicture& picture, const DofSettings& settings) {
  const int width = picture.image.width;
  const int max_radius = static_cast<int>(settings.max_coc_px);
  Image result = make_image(Format::rgba16f, width, picture.image.height);
  std::vector<std::uint64_t> memory(boards::float_filter_bytes(width, max_radius) / 8 + 1);
  const boards::FloatLens lens = {settings.coc.radius_at_infinity_px, settings.coc.focus_m, 1.0f,
                                  1.0f + 255.0f / 64.0f, settings.leak};
  boards::FloatFilter* const filter = boards::begin_float_filter(
      lens, width, max_radius, reinterpret_cast<std::uint8_t*>(memory.data()));
  std::vector<float> colour(3 * static_cast<std::size_t>(width));
  int rows_out = 0;
  const auto take_row = [&] {
    if (!boards::take_float_row(*filter, colour.data())) return false;
    REQUIRE(rows_out < result.height);
    for (int x = 0; x < width; ++x) {
      const float* const c = &colour[3 * static_cast<std::size_t>(x)];
      store_texel(result, x, rows_out, {c[0], c[1], c[2], load_texel(picture.image, x, rows_out).w},
                  {});
    }
    ++rows_out;
    return true;
  };
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < width; ++x) {
      const glm::vec4 texel = load_texel(picture.image, x, y);
      for (int i = 0; i < 3; ++i) colour[static_cast<std::size_t>(3 * x + i)] = texel[i];
    }
    boards::put_float_row(*filter, colour.data(),
                          &picture.codes[static_cast<std::size_t>(y * width)]);
    take_row();
  }
  boards::end_float_rows(*filter);
  while (take_row()) {
  }
  CHECK(rows_out == result.height);
  return result;
}

}  // namespace

TEST_CASE("the board's float filter has the bits of two-pass-single") {
  ThreadPool pool(1);
  const CodedPicture picture = random_coded_picture(70, 50);
  for (const float leak : {1.0f, 0.25f}) {
    for (const float max_radius : {1.0f, 2.0f, 8.0f, 32.0f}) {
      const DofSettings settings{.coc = {11.3f, 2.0f}, .max_coc_px = max_radius, .leak = leak};
      Image expected = make_image(Format::rgba16f, 70, 50);
      two_pass_single_oracle({picture.image, settings, {}}, expected, pool);
      INFO("max radius ", max_radius, ", leak ", leak);
      CHECK(equal(filter_on_board(picture, settings), expected));
    }
  }
}

TEST_CASE("a half becomes the nearest level and the nearest code of depth") {
  int wrong_levels = 0;
  int wrong_codes = 0;
  for (int bits = 0; bits < kHalfInfinity; ++bits) {
    const auto half = static_cast<std::uint16_t>(bits);
    const auto value = static_cast<double>(half_to_float(half));
    for (const int largest : {31, 63, 255}) {
      const double level = std::floor(std::fmin(value, 1.0) * largest + 0.5);
      wrong_levels += boards::level_of_half(half, largest) != static_cast<int>(level);
    }
    for (const int largest : {255, 65535}) {
      const double exact = std::fmin(std::fmax((value - 0.25) / 7.75, 0.0), 1.0) * largest;
      const int code = boards::depth_code_of_half(half, 250000, 8000000, largest);
      // Half a code, and what whole micrometres cut off: up to 1/7.75 of 10^-6.
      wrong_codes += !(std::fabs(code - exact) <= 0.5 + 1.3e-7 * largest);
    }
  }
  CHECK(wrong_levels == 0);
  CHECK(wrong_codes == 0);
}

TEST_CASE("negative and NaN halves are level 0, infinity is the last") {
  for (const int half : {0x8000, 0xBC00, 0xFC00, 0x7E00, 0xFE00}) {
    CHECK(boards::level_of_half(static_cast<std::uint16_t>(half), 255) == 0);
  }
  CHECK(boards::level_of_half(kHalfInfinity, 255) == 255);
  for (const int largest : {255, 65535}) {
    CHECK(boards::depth_code_of_half(kHalfInfinity, 250000, 8000000, largest) == largest);
  }
}
