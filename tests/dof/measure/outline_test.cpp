#include "dof/measure/regions.h"

#include <doctest/doctest.h>

using namespace softfocus;

namespace {

/// A square of `side` pixels from (left, 4) on, in 24x24.
std::vector<std::uint8_t> square_at(int left, int side) {
  std::vector<std::uint8_t> covered(24 * 24);
  for (int y = 4; y < 4 + side; ++y) {
    for (int x = left; x < left + side; ++x) {
      covered[static_cast<std::size_t>(24 * y + x)] = 1;
    }
  }
  return covered;
}

}  // namespace

TEST_CASE("an outline that is shifted by two pixels is wrong by them on two of its four sides") {
  const OutlineError error = outline_error(square_at(4, 10), square_at(6, 10), 24, 24);
  CHECK(error.lost == 20);
  CHECK(error.gained == 20);
  CHECK(error.seen == 100);
  CHECK(error.mean_px == 40.0 / 36.0);  // 36 pixels have a neighbour outside
  CHECK(error.most_px == 1.5);          // from a wrong pixel's centre to the outline
}

TEST_CASE("the same coverage has no error, and nothing drawn has no outline") {
  const OutlineError same = outline_error(square_at(4, 10), square_at(4, 10), 24, 24);
  CHECK(same.mean_px == 0.0);
  CHECK(same.most_px == 0.0);
  const std::vector<std::uint8_t> nothing(24 * 24);
  const OutlineError none = outline_error(nothing, square_at(4, 3), 24, 24);
  CHECK(none.gained == 9);
  CHECK(none.mean_px == 0.0);
}

TEST_CASE("a pixel is covered where its depth is not the background's") {
  Image picture = make_image(Format::rgba16f, 2, 1);
  const auto values = row<std::uint16_t>(picture, 0);
  values[3] = 0x4000;
  values[7] = 0x7bff;
  CHECK(coverage_of(picture, 0x7bff) == std::vector<std::uint8_t>{1, 0});
}
