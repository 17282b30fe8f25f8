#include "scenes/make/shapes.h"

#include <doctest/doctest.h>

#include <cmath>

#include "raster/numbers/random_bits.h"
#include "raster/numbers/vector_math.h"

using namespace softfocus;

namespace {

BallRule some_rule() {
  BallRule rule;
  rule.count = 200;
  rule.seed = 5;
  rule.region_min = {-3.0, 0.0, -4.0};
  rule.region_max = {3.0, 1.0, 4.0};
  rule.radius_min = 0.05;
  rule.radius_max = 0.15;
  rule.gap = 0.02;
  return rule;
}

double distance(glm::dvec3 a, glm::dvec3 b) { return std::sqrt(dot(a - b, a - b)); }

}  // namespace

TEST_CASE("splitmix64 gives the published numbers") {
  // The first outputs for the seed 1234567, as in the reference implementation's tests.
  RandomSequence sequence{1234567};
  CHECK(next_bits(sequence) == 6457827717110365317u);
  CHECK(next_bits(sequence) == 3203168211198807973u);
  CHECK(next_bits(sequence) == 9817491932198370423u);
}

TEST_CASE("a number between two lies between them") {
  RandomSequence sequence{9};
  for (int i = 0; i < 10000; ++i) {
    const double x = next_between(sequence, -2.0, 3.0);
    CHECK_UNARY(x >= -2.0);
    CHECK_UNARY(x < 3.0);
  }
}

TEST_CASE("scattered balls keep their distance from one another and from obstacles") {
  const std::vector<Ball> obstacles = {{{0.0, 0.5, 0.0}, 1.0}};
  const auto balls = place_balls(some_rule(), obstacles);
  REQUIRE(balls);
  REQUIRE(balls->size() == 200);
  for (std::size_t i = 0; i < balls->size(); ++i) {
    const Ball& a = (*balls)[i];
    CHECK(distance(a.centre, obstacles[0].centre) >= a.radius + 1.0 + 0.02 - 1e-12);
    for (std::size_t j = 0; j < i; ++j) {
      const Ball& b = (*balls)[j];
      CHECK_UNARY(distance(a.centre, b.centre) >= a.radius + b.radius + 0.02 - 1e-12);
    }
  }
}

TEST_CASE("scattered balls stay in the region and the range of radii") {
  const BallRule rule = some_rule();
  const auto balls = place_balls(rule, {});
  REQUIRE(balls);
  for (const Ball& ball : *balls) {
    for (int axis = 0; axis < 3; ++axis) {
      CHECK_UNARY(ball.centre[axis] >= rule.region_min[axis]);
      CHECK_UNARY(ball.centre[axis] <= rule.region_max[axis]);
    }
    CHECK_UNARY(ball.radius >= rule.radius_min);
    CHECK_UNARY(ball.radius <= rule.radius_max);
  }
}

TEST_CASE("balls on the ground touch it") {
  BallRule rule = some_rule();
  rule.on_ground = true;
  rule.region_min.y = rule.region_max.y = 0.25;
  const auto balls = place_balls(rule, {});
  REQUIRE(balls);
  for (const Ball& ball : *balls) CHECK(ball.centre.y - ball.radius == doctest::Approx(0.25));
}

TEST_CASE("the same seed scatters the same balls, another seed others") {
  BallRule rule = some_rule();
  const auto once = *place_balls(rule, {});
  CHECK(place_balls(rule, {})->back().centre == once.back().centre);
  rule.seed = 6;
  CHECK(place_balls(rule, {})->back().centre != once.back().centre);
}

TEST_CASE("where there is no room, there is no answer") {
  BallRule rule = some_rule();
  rule.radius_min = rule.radius_max = 2.0;
  CHECK_FALSE(place_balls(rule, {}));
}
