#pragma once
// Nodes of a model that move by keys of their translation, rotation and scale (glTF 2.0, section
// 3.11 and appendix C).

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <vector>

namespace softfocus {

/// The way from key to key. `step` holds a value until the next key, `linear` takes the straight
/// line, or a rotation's shorter arc, and `cubic` Hermite's cubic.
enum class KeyForm : std::uint8_t { step, linear, cubic };

/// A value by frame. Before the first key and after the last it stands still.
struct NodeTrack {
  KeyForm form = KeyForm::step;
  std::vector<double> frames;  ///< at least one, increasing
  /// One a key, x, y and z, or a unit quaternion with w last. If cubic three: the speed a frame
  /// before the key, the value, the speed behind it.
  std::vector<glm::dvec4> values;
};

struct NodeMotion {
  std::shared_ptr<const NodeMotion> above{};                            ///< null: none above moves
  glm::dmat4 between{1.0};                                              ///< from the parent to that
  std::shared_ptr<const NodeTrack> translation{}, rotation{}, scale{};  ///< all there
};

/// Of length 1; of length 0 it turns nothing.
glm::dvec4 unit_quaternion(glm::dvec4 q);

/// Scaled, then turned by a unit quaternion, w last, then moved.
glm::dmat4 placing_matrix(glm::dvec3 translation, glm::dvec4 rotation, glm::dvec3 scale);

/// From the node to its model. In binary64 by + - * / and square roots alone: the same bits on
/// every machine.
glm::dmat4 matrix_at(const NodeMotion& motion, double frame);

/// Of its keys and those above.
double last_frame(const NodeMotion& motion);

/// Frames by which one sees where it goes: 0, its keys and those above, or some of them, and some
/// between; about 130 at most.
std::vector<double> telling_frames(const NodeMotion& motion);

/// How far from the model's origin it ever takes what is so far from the node's, at most.
double reach(const NodeMotion& motion, double radius);

}  // namespace softfocus
