#include "scenes/relief/height_relief.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/numbers/vector_math.h"

using namespace softfocus;

namespace {

/// A dome of a height of 6 texels over a plain.
HeightField dome_field(int size) {
  HeightField field{size, size, {}};
  field.heights.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double dx = x - 0.5 * (size - 1), dy = y - 0.5 * (size - 1);
      field.heights.push_back(static_cast<float>(std::fmax(0.0, 6.0 - 0.05 * (dx * dx + dy * dy))));
    }
  }
  return field;
}

}  // namespace

TEST_CASE("a height field's texels are its points, the heights upwards") {
  const HeightField field = dome_field(33);
  for (const int bits : {8, 16}) {
    const ReliefTexture relief = *relief_of_heights(field, {0.25, bits, false});
    CHECK(relief.normals.empty());
    double most = 0.0;
    for (int y = 0; y < 33; ++y) {
      for (int x = 0; x < 33; ++x) {
        const auto at = static_cast<std::size_t>(33 * y + x);
        const glm::dvec3 point = relief_point(relief, x, y, relief.depths[at]);
        CHECK(point.x == doctest::Approx((x - 16) * 0.25));
        CHECK(point.y == doctest::Approx((16 - y) * 0.25));
        most = std::fmax(most, std::fabs(point.z - 0.25 * static_cast<double>(field.heights[at])));
      }
    }
    CHECK(most <= 0.5001 * depth_step(relief));
  }
}

TEST_CASE("what is no number is a hole") {
  HeightField field = dome_field(9);
  field.heights[40] = NAN;
  field.heights[7] = INFINITY;
  const ReliefTexture relief = *relief_of_heights(field, {1.0, 8, true});
  for (const std::size_t at : {std::size_t{40}, std::size_t{7}}) {
    CHECK(relief.depths[at] == 255);
    CHECK(relief.colours[at] == 0);
    CHECK(relief.normals[at] == 0);
  }
  CHECK(relief_extent(relief)->filled == 79);
  for (float& height : field.heights) height = NAN;
  CHECK(!relief_of_heights(field, {}));
}

TEST_CASE("a slope's normals are its plane's, at borders and beside holes too") {
  HeightField field{8, 6, {}};
  field.heights.reserve(48);
  for (int i = 0; i < 48; ++i) {
    const int column = i % 8, row = i / 8;
    field.heights.push_back(0.5f * static_cast<float>(column) - 0.25f * static_cast<float>(row));
  }
  field.heights[20] = NAN;
  const ReliefTexture relief = *relief_of_heights(field, {1.0, 16, true});
  const glm::dvec3 right = normalize(glm::dvec3{-0.5, -0.25, 1.0});
  for (std::size_t at = 0; at < 48; ++at) {
    if (at == 20) continue;
    for (int i = 0; i < 3; ++i) {
      const double part = (static_cast<int>(relief.normals[at] >> (8 * i) & 255u) - 128) / 127.0;
      CHECK(std::fabs(part - right[i]) < 0.5 / 127.0 + 1e-6);
    }
  }
}

TEST_CASE("a plain without heights has a depth, and its own colours") {
  HeightField field{3, 2, std::vector<float>(6, 5.0f)};
  field.colours.assign(6, 0x00112233u);
  const ReliefTexture relief = *relief_of_heights(field, {0.5, 8, false});
  CHECK(relief.camera.depth_m == 0.5);
  CHECK(relief.camera.origin.z == 2.5);
  for (const std::uint16_t code : relief.depths) CHECK(code == 0);
  for (const std::uint32_t colour : relief.colours) CHECK(colour == 0xFF112233u);
}

TEST_CASE("a lit slope is brighter on the side of the light, the upper left") {
  const ReliefTexture relief = *relief_of_heights(dome_field(33), {});
  const auto brightness = [&](int x, int y) {
    return relief.colours[static_cast<std::size_t>(33 * y + x)] & 255u;
  };
  CHECK(brightness(10, 10) > brightness(16, 16));
  CHECK(brightness(16, 16) > brightness(22, 22));
}
