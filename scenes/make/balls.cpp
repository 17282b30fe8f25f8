#include "scenes/make/balls.h"

#include <algorithm>

#include "raster/numbers/random_bits.h"
#include "raster/numbers/vector_math.h"

namespace softfocus {
namespace {

bool too_near(const Ball& a, const Ball& b, double gap) {
  const glm::dvec3 between = a.centre - b.centre;
  const double least = a.radius + b.radius + gap;
  return dot(between, between) < least * least;
}

}  // namespace

std::optional<std::vector<Ball>> place_balls(const BallRule& rule,
                                             const std::vector<Ball>& obstacles) {
  RandomSequence random{rule.seed};
  std::vector<Ball> balls;
  for (int i = 0; i < rule.count; ++i) {
    Ball ball;
    ball.radius = next_between(random, rule.radius_min, rule.radius_max);
    const auto is_taken = [&](const Ball& other) { return too_near(ball, other, rule.gap); };
    int attempt = 0;
    do {
      if (attempt++ == kBallAttempts) return std::nullopt;
      ball.centre.x = next_between(random, rule.region_min.x, rule.region_max.x);
      ball.centre.y = next_between(random, rule.region_min.y, rule.region_max.y);
      ball.centre.z = next_between(random, rule.region_min.z, rule.region_max.z);
      if (rule.on_ground) ball.centre.y = rule.region_min.y + ball.radius;
    } while (std::any_of(obstacles.begin(), obstacles.end(), is_taken) ||
             std::any_of(balls.begin(), balls.end(), is_taken));
    balls.push_back(ball);
  }
  return balls;
}

}  // namespace softfocus
