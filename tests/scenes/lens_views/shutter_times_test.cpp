#include "scenes/lens_views/shutter_times.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "scenes/lens_views/few_pixel_offsets.h"
#include "scenes/lens_views/lens_points.h"
#include "tests/support/random.h"

using namespace softfocus;

namespace {

using Points = std::vector<glm::dvec2>;

int part_of(double time, int parts) { return static_cast<int>(std::floor((time + 0.5) * parts)); }

// Each of n equal parts of the time has one.
void check_one_a_part(std::vector<double> times) {
  const auto count = static_cast<int>(times.size());
  std::sort(times.begin(), times.end());
  for (int i = 0; i < count; ++i) CHECK(part_of(times[static_cast<std::size_t>(i)], count) == i);
}

// An edge that is out of focus and moves is seen by the views on one side of a plane of lens and
// time. The root of the mean square, over planes, of the share of the views less that of all.
double edge_error(const Points& points, const std::vector<double>& times) {
  constexpr int kMany = 4096, kPlanes = 100, kPlaces = 9;
  static const Points all_points = lens_points({}, kMany);
  test::Random random{7};
  double squares = 0.0;
  for (int plane = 0; plane < kPlanes; ++plane) {
    const double angle = random.between(0.0, 2.0 * 3.14159265358979323846);
    const double cosine = std::cos(angle), sine = std::sin(angle);
    const double speed = random.between(0.1, 4.0);
    const auto place = [&](glm::dvec2 point, double time) {
      return point.x * cosine + point.y * sine + speed * time;
    };
    for (int i = 0; i < kPlaces; ++i) {
      const double edge = (1.0 + speed / 2.0) * (2.0 * (i + 0.5) / kPlaces - 1.0);
      double few = 0.0, many = 0.0;
      for (std::size_t k = 0; k < points.size(); ++k) {
        few += place(points[k], times[k]) < edge ? 1.0 : 0.0;
      }
      // The exact share of the time at each point.
      for (const glm::dvec2 point : all_points) {
        many += std::clamp(0.5 + (edge - place(point, 0.0)) / speed, 0.0, 1.0);
      }
      const double error = few / static_cast<double>(points.size()) - many / kMany;
      squares += error * error;
    }
  }
  return std::sqrt(squares / (kPlanes * kPlaces));
}

std::vector<double> in_any_order(std::vector<double> times, std::uint64_t seed) {
  test::Random random{seed};
  for (std::size_t i = times.size(); i > 1; --i) {
    std::swap(times[i - 1], times[static_cast<std::size_t>(random.next() % i)]);
  }
  return times;
}

double mean_error_in_any_order(const Points& points, const std::vector<double>& times) {
  double sum = 0.0;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    sum += edge_error(points, in_any_order(times, seed));
  }
  return sum / 3.0;
}

}  // namespace

TEST_CASE("shutter times: a block of 2^k of the sequence has one time in each of 2^k parts") {
  const std::vector<double> times = shutter_sequence(6 * 1024);
  CHECK(times[0] == 0.0);
  for (int k = 0; k <= 10; ++k) {
    const auto size = std::ptrdiff_t{1} << k;
    for (const std::ptrdiff_t start : {std::ptrdiff_t{0}, size, 5 * size}) {
      check_one_a_part({times.begin() + start, times.begin() + start + size});
    }
  }
}

TEST_CASE("shutter times: with the lens, a block of 2^k has two in each box of 2^(1-k) of all") {
  for (int k = 1; k <= 9; ++k) {
    const std::uint32_t size = 1u << k;
    for (const std::uint32_t start : {0u, size, 5 * size}) {
      for (int a = 0; a < k; ++a) {
        for (int b = 0; a + b < k; ++b) {
          const int c = k - 1 - a - b;
          std::map<std::array<int, 3>, int> boxes;
          for (std::uint32_t i = start; i < start + size; ++i) {
            const glm::dvec2 square = square_point(i, 0);
            ++boxes[{static_cast<int>(square.x * (1 << a)), static_cast<int>(square.y * (1 << b)),
                     static_cast<int>(shutter_point(i) * (1 << c))}];
          }
          const bool all_have_two = std::all_of(boxes.begin(), boxes.end(),
                                                [](const auto& box) { return box.second == 2; });
          CHECK(all_have_two);
        }
      }
    }
  }
}

TEST_CASE("shutter times: of any number of views, the middles of as many parts, with the sum 0") {
  for (const int count : {1, 2, 3, 7, 8, 33, 100, 256, 300, 1000}) {
    CAPTURE(count);
    const Points points = lens_points_for({}, count);
    const std::vector<double> times = shutter_times(points, view_offsets(true, points));
    REQUIRE(times.size() == points.size());
    check_one_a_part(times);
    double sum = 0.0;
    for (const double time : times) sum += time;
    CHECK(sum == 0.0);
  }
}

TEST_CASE("shutter times: those of views that grow are evenly spread at each size") {
  const std::vector<int> sizes{8, 64, 256};
  const Points points = growing_lens_points({}, sizes);
  const std::vector<double> times =
      growing_shutter_times(points, growing_pixel_offsets(points, sizes), sizes);
  for (const int size : sizes) check_one_a_part({times.begin(), times.begin() + size});
}

TEST_CASE("shutter times: edges that move out of focus err less than with times in any order" *
          doctest::test_suite("long")) {
  for (const int count : {16, 32, 64, 128, 1024}) {
    CAPTURE(count);
    const Points points = lens_points_for({}, count);
    const std::vector<double> times = shutter_times(points, Points(points.size(), glm::dvec2{0.0}));
    const double found = edge_error(points, times);
    const double any = mean_error_in_any_order(points, times);
    MESSAGE(count << " views: " << found << ", in any order " << any);
    CHECK(found < 0.8 * any);
  }
}

TEST_CASE("shutter times: in the sequence they have nothing to do with places in the pixel") {
  const std::vector<double> times = shutter_sequence(4096);
  const Points offsets = pixel_offsets(true, 4096);
  for (int axis = 0; axis < 2; ++axis) {
    double product = 0.0;
    for (std::size_t i = 0; i < times.size(); ++i) product += times[i] * offsets[i][axis];
    CHECK(std::fabs(product / 4096.0) < 0.005);  // of same things it would be 0.083
  }
}
