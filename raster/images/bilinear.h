#pragma once
// Shared by the bilinear filters: two texels an axis; along both rows first, then between them.

#include <glm/vec4.hpp>

#include "raster/images/sampler.h"

namespace softfocus {

/// The two texels that a bilinear fetch reads along one axis, and the second's weight.
struct Taps {
  int first;
  int second;
  float weight;
};

/// The standard unit's, along an axis of `size` texels, as sample() says; and the texel that its
/// nearest fetch reads.
Taps standard_taps(float coordinate, int size, Wrap wrap, BilinearWeights weights);
int standard_nearest(float coordinate, int size, Wrap wrap);

/// mix(a, b, t) of each component.
template <class Mix>
glm::vec4 mix_components(glm::vec4 a, glm::vec4 b, float t, const Mix& mix) {
  return {mix(a.x, b.x, t), mix(a.y, b.y, t), mix(a.z, b.z, t), mix(a.w, b.w, t)};
}

/// Mixes the four texels load(x, y): along both rows, then the two results.
template <class Load, class Mix>
glm::vec4 filter_bilinear(const Taps& u, const Taps& v, const Load& load, const Mix& mix) {
  const auto along_row = [&](int y) {
    return mix_components(load(u.first, y), load(u.second, y), u.weight, mix);
  };
  return mix_components(along_row(v.first), along_row(v.second), v.weight, mix);
}

}  // namespace softfocus
