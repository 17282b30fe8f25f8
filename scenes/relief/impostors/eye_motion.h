#pragma once
// Prediction of the eye: its motion of the last frame goes on. An object's picture depends first on
// the direction from which it is seen. So the motion is a turn about the object's middle, by one
// angle a frame, and a way to it or away, by one length a frame. Clua (2004, 7.4 and 9.2) asks for
// a prediction from the eye's velocity, and gives none.
//
// With p and q the directions to the eye in two frames, s = p x q has the sine of the angle for
// its length and c = p.q the cosine. So Rodrigues' turn about s needs no angle:
//
//   v' = c v + s x v + s (s.v) / (1 + c)

#include <glm/vec3.hpp>

namespace softfocus {

struct EyeMotion {
  glm::dvec3 middle{0.0};  ///< about which the eye turns
  double least_m = 0.0;    ///< it comes no nearer than this
  glm::dvec3 sine{0.0};    ///< s, of a frame's turn
  double cosine = 1.0;
  double outwards_m = 0.0;  ///< in a frame
};

/// From the eye of a frame to that of the next. A turn by half a circle is none: no axis is known.
EyeMotion eye_motion(glm::dvec3 middle, double least_m, glm::dvec3 eye, glm::dvec3 next_eye);

/// The eye after so many frames of this motion, or before if they are negative.
glm::dvec3 moved_eye(const EyeMotion& motion, glm::dvec3 eye, int frames);

}  // namespace softfocus
