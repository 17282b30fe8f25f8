// pentagonal and hexagonal: blurs along lines against their definition and against the polygon.

#include "dof/polygon/polygon.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "dof/polygon/polygon_lines.h"
#include "raster/images/texel.h"
#include "raster/numbers/random_bits.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr double kPi = 3.14159265358979323846;

int reach_of(const PolygonLines& lines) {
  int reach = 0;
  for (const auto& part : lines.parts) {
    for (const PolygonLine& line : part) reach = std::max(reach, line.reach);
  }
  return reach;
}

LineField random_field(bool near, int width, int height, int reach, ThreadPool& pool) {
  RandomSequence random{5};
  LineField field = make_line_field(near, width, height, reach, pool);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 4; ++c) {
        line_row(field, c, y)[x] = static_cast<float>(next_between(random, 0.0, 1.0));
      }
      const double size = std::max(0.5, next_between(random, -1.0, 5.0));
      line_row(field, kLineSize, y)[x] = static_cast<float>(size);
      line_row(field, kLineCounts, y)[x] =
          static_cast<float>(size * next_between(random, 0.0, 1.0));
    }
    repeat_line_ends(field, 0, kLinePlanes, y);
  }
  return field;
}

// The header's sum in binary64, for a segment of a direction of length 1.
struct Segment {
  double x, y, begin, end, hat;
};
double along_segment(const Segment& segment, const LineField& field, int plane, int x, int y) {
  const auto at = [&](int p, int column, int row) {
    return static_cast<double>(line_row(
        field, p, std::clamp(row, 0, field.height - 1))[std::clamp(column, 0, field.width - 1)]);
  };
  const double size = at(kLineSize, x, y), own = at(plane, x, y);
  if (size <= 0.5) return own;
  const bool by_columns = std::fabs(segment.x) >= std::fabs(segment.y);
  const double major = by_columns ? segment.x : segment.y;
  const double slope = by_columns ? segment.y / segment.x : segment.x / segment.y;
  const double middle = -0.5 * (segment.begin + segment.end) * major * size;
  const double half = std::max(0.5, 0.5 * (segment.end - segment.begin) * std::fabs(major) * size);
  double sum = 0.0, weights = 0.0;
  for (int n = -12; n <= 12; ++n) {
    const double inside = std::clamp(half + 0.5 - std::fabs(n - middle), 0.0, 1.0);
    for (int k = -14; k <= 14; ++k) {
      const double share =
          std::max(0.0, 1.0 - std::fabs(k - n * slope) / segment.hat) / segment.hat;
      const int column = by_columns ? x + n : x + k, row = by_columns ? y + k : y + n;
      const double counts =
          field.near ? 1.0 : std::min(1.0, 2.0 * at(kLineCounts, column, row) / size);
      sum += inside * share * (own + counts * (at(plane, column, row) - own));
      weights += inside * share;
    }
  }
  return sum / weights;
}

struct Point {
  double across, up;
};
Point corner(int corners, int i) {
  const double angle = kPi * (0.5 + 2.0 * i / corners);
  return {std::cos(angle), std::sin(angle)};
}

// How far two pictures' green differs, over the second: root of the sums of squares.
double relative_rms(const Image& a, const Image& b) {
  double difference = 0.0, all = 0.0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const double p = static_cast<double>(load_texel(a, x, y).y);
      const double q = static_cast<double>(load_texel(b, x, y).y);
      difference += (p - q) * (p - q);
      all += q * q;
    }
  }
  return std::sqrt(difference / all);
}

// The picture of bright pixels in a square in the middle, at a signed radius.
Image picture_of_light(const char* method, const Aperture& aperture, float radius, int half_side) {
  constexpr int kSide = 161;
  Image scene = make_image(Format::rgba16f, kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const bool lit = std::max(std::abs(x - kSide / 2), std::abs(y - kSide / 2)) <= half_side;
      const float light = lit ? 1000.0f : 0.0f;
      store_texel(scene, x, y, {light, light, light, 128.0f / (64.0f - radius)}, {});
    }
  }
  ThreadPool pool(2);
  const DofSettings settings{.coc = {64.0f, 2.0f}, .max_coc_px = 64.0f, .aperture = aperture};
  return apply(*find_method(method), {scene, settings, {}}, pool);
}

// The light of one cell of a size by the lines alone, and how far its shape is from the polygon's.
struct CellPicture {
  double light = 0.0;
  double shape_error = 0.0;
};
CellPicture picture_of_cell(int corners, float size, bool upside_down) {
  constexpr int kSide = 91, kMiddle = 45;
  const PolygonLines lines = polygon_lines(corners, size, upside_down);
  ThreadPool pool(2);
  LineField field = make_line_field(true, kSide, kSide, reach_of(lines), pool);
  for (int y = 0; y < kSide; ++y) {
    std::fill_n(line_row(field, kLineSize, y), kSide, size);
    if (y == kMiddle) line_row(field, 0, y)[kMiddle] = 1000.0f;
    repeat_line_ends(field, 0, kLinePlanes, y);
  }
  blur_polygon(lines, field, pool);
  CellPicture picture;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      picture.light += static_cast<double>(line_row(field, 0, y)[x]) / 1000.0;
    }
  }
  // The polygon's cover of a cell, of 16x16 points of it.
  double difference = 0.0, all = 0.0;
  const double area = 0.5 * corners * std::sin(2.0 * kPi / corners) * size * size;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      int inside = 0;
      for (int i = 0; i < 256; ++i) {
        const int column = i % 16, line = i / 16;
        const double across = x - kMiddle + (column + 0.5) / 16.0 - 0.5;
        const double down = y - kMiddle + (line + 0.5) / 16.0 - 0.5;
        bool is_in = true;
        for (int k = 0; k < corners && is_in; ++k) {
          const Point a = corner(corners, k), b = corner(corners, k + 1);
          const double up = (upside_down ? down : -down) / static_cast<double>(size);
          const double to = (upside_down ? -across : across) / static_cast<double>(size);
          is_in = (b.across - a.across) * (up - a.up) - (b.up - a.up) * (to - a.across) >= 0.0;
        }
        inside += is_in ? 1 : 0;
      }
      const double exact = inside / 256.0 / area;
      const double got = static_cast<double>(line_row(field, 0, y)[x]) / 1000.0 / picture.light;
      difference += (got - exact) * (got - exact);
      all += exact * exact;
    }
  }
  picture.shape_error = std::sqrt(difference / all);
  return picture;
}

}  // namespace

TEST_CASE("a blur along a line is what its equation says, of both fields") {
  ThreadPool pool(2);
  // The top of the pentagon: from its corner down to the left, and down to the right.
  const double before = 1.0 / (2.0 * std::sin(kPi / 5.0)), side = 1.0 + std::cos(kPi / 5.0);
  const double all = side / std::sin(2.0 * kPi / 5.0);
  const double c = std::cos(kPi / 5.0), s = std::sin(kPi / 5.0);
  const std::array segments{Segment{-c, s, -before, all - before, 1.0},
                            Segment{c, s, -before, all - before, 2.0 * s / c}};
  const PolygonLines lines = polygon_lines(5, 5.0f, false);
  for (const bool near : {false, true}) {
    const LineField field = random_field(near, 31, 23, reach_of(lines), pool);
    for (std::size_t pass = 0; pass < 2; ++pass) {
      LineField blurred = make_line_field(near, 31, 23, 0, pool);
      blur_line(lines.parts[0][pass], field, blurred, pool);
      double worst = 0.0;
      for (int y = 0; y < 23; ++y) {
        for (int x = 0; x < 31; ++x) {
          const double got = static_cast<double>(line_row(blurred, 1, y)[x]);
          worst = std::max(worst, std::fabs(got - along_segment(segments[pass], field, 1, x, y)));
        }
      }
      INFO(std::string{near ? "near" : "far"}, ", pass ", pass);
      CHECK(worst < 2e-6);
    }
  }
}

TEST_CASE("six parallelograms are the pentagon, with all of a lone cell's light") {
  for (const bool upside_down : {false, true}) {
    for (const float size : {4.0f, 8.0f, 16.0f}) {
      const CellPicture picture = picture_of_cell(5, size, upside_down);
      INFO("size ", size, std::string{upside_down ? ", upside down" : ""}, ", light ",
           picture.light, ", shape ", picture.shape_error);
      CHECK(picture.light == doctest::Approx(1.0).epsilon(0.02));
      CHECK(picture.shape_error < 0.15);
    }
  }
}

TEST_CASE("three rhombi are the hexagon, with all of a lone cell's light") {
  for (const float size : {4.0f, 8.0f, 16.0f}) {
    const CellPicture picture = picture_of_cell(6, size, false);
    INFO("size ", size, ", light ", picture.light, ", shape ", picture.shape_error);
    CHECK(picture.light == doctest::Approx(1.0).epsilon(0.002));
    CHECK(picture.shape_error < 0.16);
  }
}

TEST_CASE("a light shows the aperture's exact polygon, upside down before the focus") {
  for (const float radius : {8.0f, 16.0f, 32.0f, -8.0f, -16.0f, -32.0f}) {
    for (const int corners : {5, 6}) {
      const char* const method = corners == 5 ? "pentagonal" : "hexagonal";
      const Image exact = picture_of_light("scatter-aperture", {.blades = corners}, radius, 0);
      const double error = relative_rms(picture_of_light(method, {}, radius, 0), exact);
      INFO(std::string{method}, " at radius ", radius, ": ", error);
      CHECK(error < 0.1);
    }
  }
}

TEST_CASE("a lamp too large for a highlight shows a polygon, by the lines") {
  for (const float radius : {24.0f, -24.0f}) {
    for (const int corners : {5, 6}) {
      const char* const method = corners == 5 ? "pentagonal" : "hexagonal";
      const Image exact = picture_of_light("scatter-aperture", {.blades = corners}, radius, 14);
      const double error = relative_rms(picture_of_light(method, {}, radius, 14), exact);
      INFO(std::string{method}, " at radius ", radius, ": ", error);
      CHECK(error < 0.07);
      // A disc is not as near.
      CHECK(relative_rms(picture_of_light("circular-2", {}, radius, 14), exact) > error);
    }
  }
}
