#include "scenes/models/node_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/numbers/vector_math.h"

namespace softfocus {
namespace {

double dot4(glm::dvec4 a, glm::dvec4 b) {
  return ((a.x * b.x + a.y * b.y) + a.z * b.z) + a.w * b.w;
}

// At `t`, 0 to 1, of the shorter arc between two unit quaternions. The unit of their sum is the
// arc's middle: so it is halved until a chord is as good as the arc, which needs no sine.
glm::dvec4 on_arc(glm::dvec4 a, glm::dvec4 b, double t) {
  if (dot4(a, b) < 0.0) b = -b;
  constexpr int kHalvings = 20;  // of at most 90 degrees
  for (int i = 0; i < kHalvings; ++i) {
    const glm::dvec4 middle = unit_quaternion(a + b);
    t *= 2.0;
    if (t < 1.0) {
      b = middle;
    } else {
      a = middle;
      t -= 1.0;
    }
  }
  return unit_quaternion(a + (b - a) * t);
}

// `is_turn`: a quaternion.
glm::dvec4 value_of(const NodeTrack& track, bool is_turn, double frame) {
  const std::size_t of_key = track.form == KeyForm::cubic ? 3 : 1;
  const auto value = [&](std::size_t key) { return track.values[of_key * key + of_key / 2]; };
  const auto next = std::upper_bound(track.frames.begin(), track.frames.end(), frame);
  const auto right = static_cast<std::size_t>(next - track.frames.begin());
  if (right == 0) return value(0);
  const std::size_t left = right - 1;
  const bool is_key = frame == track.frames[left];
  if (is_key || right == track.frames.size() || track.form == KeyForm::step) return value(left);
  const double frames = track.frames[right] - track.frames[left];
  const double t = (frame - track.frames[left]) / frames;
  if (track.form == KeyForm::linear) {
    if (is_turn) return on_arc(value(left), value(right), t);
    return value(left) + (value(right) - value(left)) * t;
  }
  const double u = 1.0 - t;
  const glm::dvec4 behind = track.values[3 * left + 2], before = track.values[3 * right];
  const glm::dvec4 on_cubic =
      (value(left) + (value(right) - value(left)) * (t * t * (3.0 - 2.0 * t))) +
      (behind * (t * u * u) - before * (t * t * u)) * frames;
  return is_turn ? unit_quaternion(on_cubic) : on_cubic;
}

// The largest of a value's numbers on the way, or its length there, at most.
double most_of(const NodeTrack& track, bool is_length) {
  const auto length = [&](glm::dvec4 v) {
    if (is_length) return std::sqrt(dot4(v, v));
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  };
  double most = 0.0;
  if (track.form != KeyForm::cubic) {
    for (const glm::dvec4 value : track.values) most = std::max(most, length(value));
    return most;
  }
  const double frames = track.frames.back() - track.frames.front();
  for (std::size_t i = 0; i < track.values.size(); i += 3) {
    most = std::max(most, length(track.values[i + 1]) +
                              frames * (length(track.values[i]) + length(track.values[i + 2])));
  }
  return most;
}

std::array<const NodeTrack*, 3> tracks_of(const NodeMotion& motion) {
  return {motion.translation.get(), motion.rotation.get(), motion.scale.get()};
}

}  // namespace

glm::dvec4 unit_quaternion(glm::dvec4 q) {
  const double length = std::sqrt(dot4(q, q));
  return length > 0.0 ? q / length : glm::dvec4{0.0, 0.0, 0.0, 1.0};
}

glm::dmat4 placing_matrix(glm::dvec3 translation, glm::dvec4 rotation, glm::dvec3 scale) {
  const double x = rotation.x, y = rotation.y, z = rotation.z, w = rotation.w;
  glm::dmat4 m{1.0};
  m[0] = glm::dvec4{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w), 0.0};
  m[1] = glm::dvec4{2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w), 0.0};
  m[2] = glm::dvec4{2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y), 0.0};
  for (int i = 0; i < 3; ++i) {
    m[i] = m[i] * scale[i];
    m[3][i] = translation[i];
  }
  return m;
}

glm::dmat4 matrix_at(const NodeMotion& motion, double frame) {
  const glm::dmat4 own = placing_matrix(glm::dvec3{value_of(*motion.translation, false, frame)},
                                        value_of(*motion.rotation, true, frame),
                                        glm::dvec3{value_of(*motion.scale, false, frame)});
  const glm::dmat4 to_above = multiply(motion.between, own);
  return motion.above ? multiply(matrix_at(*motion.above, frame), to_above) : to_above;
}

double last_frame(const NodeMotion& motion) {
  double last = motion.above ? last_frame(*motion.above) : 0.0;
  for (const NodeTrack* track : tracks_of(motion)) last = std::max(last, track->frames.back());
  return last;
}

std::vector<double> telling_frames(const NodeMotion& motion) {
  constexpr std::size_t kMostKeys = 64;
  constexpr int kBetween = 64;
  std::vector<double> keys;
  for (const NodeMotion* at = &motion; at != nullptr; at = at->above.get()) {
    for (const NodeTrack* track : tracks_of(*at)) {
      // Of many keys some, evenly.
      const std::size_t step = track->frames.size() / kMostKeys + 1;
      for (std::size_t i = 0; i < track->frames.size(); i += step) {
        keys.push_back(track->frames[i]);
      }
    }
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  std::vector<double> frames;
  for (std::size_t i = 0; i < keys.size(); i += keys.size() / kMostKeys + 1) {
    frames.push_back(keys[i]);
  }
  const double last = last_frame(motion);
  for (int i = 0; i <= kBetween; ++i) frames.push_back(last * i / kBetween);
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

double reach(const NodeMotion& motion, double radius) {
  double far = radius * most_of(*motion.scale, false) + most_of(*motion.translation, true);
  // A matrix lengthens by at most the root of the largest sum of magnitudes in a row of its square:
  // 1 if it only turns.
  double square = 0.0;
  for (int i = 0; i < 3; ++i) {
    double row = 0.0;
    for (int k = 0; k < 3; ++k) {
      row += std::fabs(dot(glm::dvec3{motion.between[i]}, glm::dvec3{motion.between[k]}));
    }
    square = std::max(square, row);
  }
  far = far * std::sqrt(square) + length_of(glm::dvec3{motion.between[3]});
  return motion.above ? reach(*motion.above, far) : far;
}

}  // namespace softfocus
