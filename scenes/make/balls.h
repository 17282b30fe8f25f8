#pragma once
// Balls at random places, none touching another: the same ones on every machine.

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

namespace softfocus {

struct Ball {
  glm::dvec3 centre{0.0};
  double radius = 1.0;
};

struct BallRule {
  int count = 1;
  std::uint64_t seed = 1;
  glm::dvec3 region_min{-1.0};  ///< of the centres
  glm::dvec3 region_max{1.0};
  double radius_min = 0.1;
  double radius_max = 0.1;
  double gap = 0.0;        ///< least distance between two surfaces
  bool on_ground = false;  ///< the balls lie on y = region_min.y
};

/// Draws radius, x, y and z of each ball, in this order. Draws x, y and z again while the ball
/// is nearer than `gap` to an obstacle or an earlier ball. Empty if a ball finds no place in
/// kBallAttempts.
std::optional<std::vector<Ball>> place_balls(const BallRule& rule,
                                             const std::vector<Ball>& obstacles);

inline constexpr int kBallAttempts = 1000;
/// Each place is compared with every ball, so time grows with the square.
inline constexpr int kMostBalls = 4096;

}  // namespace softfocus
