#pragma once
// Linear interpolation, in which drivers differ most.

#include <cmath>

#include "raster/numbers/fused.h"
#include "raster/numbers/profile.h"

namespace softfocus {

/// a b + c, rounded once when fused and after each operation when not.
inline float multiply_add(float a, float b, float c, Contraction contraction) {
  return contraction == Contraction::fused ? fused_multiply_add(a, b, c) : a * b + c;
}

/// a + t (b - a); the difference is always rounded by itself.
inline float lerp(float a, float b, float t, Contraction contraction) {
  return multiply_add(t, b - a, a, contraction);
}

/// `value`, or a zero of its sign where the profile flushes subnormals.
inline float flush_denormal(float value, Denormals denormals) {
  const bool flushed = denormals == Denormals::flush && std::fabs(value) < 0x1p-126f;
  return flushed ? std::copysign(0.0f, value) : value;
}

/// a + t (b - a) as a shader of the profile computes it: with its contraction, and with operands
/// and results flushed if it flushes.
inline float lerp(float a, float b, float t, const Profile& profile) {
  const auto flush = [&](float value) { return flush_denormal(value, profile.denormals); };
  a = flush(a);
  t = flush(t);
  const float difference = flush(flush(b) - a);
  if (profile.lerp == Contraction::fused) return flush(fused_multiply_add(t, difference, a));
  return flush(flush(t * difference) + a);
}

}  // namespace softfocus
