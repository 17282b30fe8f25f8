#include "scenes/relief/impostors/eye_motion.h"

#include <cmath>
#include <cstdlib>

#include "raster/numbers/vector_math.h"

namespace softfocus {

EyeMotion eye_motion(glm::dvec3 middle, double least_m, glm::dvec3 eye, glm::dvec3 next_eye) {
  const glm::dvec3 before = eye - middle, after = next_eye - middle;
  const glm::dvec3 p = normalize(before), q = normalize(after);
  EyeMotion motion;
  motion.middle = middle;
  motion.least_m = least_m;
  motion.outwards_m = std::sqrt(dot(after, after)) - std::sqrt(dot(before, before));
  const double cosine = dot(p, q);
  if (cosine > -0.999) {
    motion.sine = cross(p, q);
    motion.cosine = cosine;
  }
  return motion;
}

glm::dvec3 moved_eye(const EyeMotion& motion, glm::dvec3 eye, int frames) {
  const glm::dvec3 arm = eye - motion.middle;
  const glm::dvec3 s = frames < 0 ? motion.sine * -1.0 : motion.sine;
  glm::dvec3 towards_eye = normalize(arm);
  for (int i = 0; i < std::abs(frames); ++i) {
    const double share = dot(s, towards_eye) / (1.0 + motion.cosine);
    towards_eye = normalize((towards_eye * motion.cosine + cross(s, towards_eye)) + s * share);
  }
  const double distance = std::sqrt(dot(arm, arm)) + motion.outwards_m * frames;
  return motion.middle + towards_eye * std::fmax(distance, motion.least_m);
}

}  // namespace softfocus
