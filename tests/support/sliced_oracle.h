#pragma once
// Arrays, volumes and cubes by the equations of docs/specification.md, slowly, in the standard
// unit's binary32.

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"

namespace softfocus::test {

/// OpenGL 4.6, table 8.19: sc, tc and |ma| of a direction on a face.
template <class Number>
std::array<Number, 3> on_cube_face(int face, Number x, Number y, Number z) {
  switch (face) {
    case 0: return {-z, -y, x};
    case 1: return {z, -y, -x};
    case 2: return {x, z, y};
    case 3: return {x, -z, -y};
    case 4: return {x, -y, z};
    default: return {-x, -y, -z};
  }
}

/// The face whose |ma| is the greatest; of those that are equal z before y before x. Not of zeros.
template <class Number>
int oracle_face(Number x, Number y, Number z) {
  int found = 4;
  Number most = -1;
  for (const int face : {4, 5, 2, 3, 0, 1}) {
    const Number ma = on_cube_face(face, x, y, z)[2];
    if (ma <= most) continue;
    most = ma;
    found = face;
  }
  return found;
}

/// The texel of the face that the direction through its centre meets: texel (x, y) of a face, or
/// one beyond an edge in the face's plane.
inline CubeTexel oracle_cube_texel(const CubeTexel& at, int size) {
  const double s = (2.0 * at.x + 1.0) / size - 1.0, t = (2.0 * at.y + 1.0) / size - 1.0;
  // on_cube_face() turned round, by trial.
  for (const double a : {-1.0, 1.0, s, t, -s, -t}) {
    for (const double b : {-1.0, 1.0, s, t, -s, -t}) {
      for (const double c : {-1.0, 1.0, s, t, -s, -t}) {
        if (on_cube_face(at.face, a, b, c) != std::array{s, t, 1.0}) continue;
        const int face = oracle_face(a, b, c);
        const std::array<double, 3> place = on_cube_face(face, a, b, c);
        const auto index = [&](double part) {
          return static_cast<int>(std::floor((part / place[2] + 1.0) / 2.0 * size));
        };
        return {face, index(place[0]), index(place[1])};
      }
    }
  }
  return {-1, 0, 0};
}

inline int oracle_wrap(int i, int size, Wrap wrap) {
  if (wrap == Wrap::clamp_to_edge) return i < 0 ? 0 : i >= size ? size - 1 : i;
  const int period = wrap == Wrap::repeat ? size : 2 * size;
  while (i < 0) i += period;
  while (i >= period) i -= period;
  return i < size ? i : period - 1 - i;
}

struct SlicedOracle {
  const Texture& texture;
  const Sampler& sampler;
  bool has_fixed_weights = false;

  float rounded(float weight) const {
    return has_fixed_weights ? std::nearbyint(weight * 256.0f) / 256.0f : weight;
  }
  static glm::vec4 mix(glm::vec4 a, glm::vec4 b, float t) { return a + t * (b - a); }

  glm::vec4 of_volume(glm::vec3 at, std::size_t level) const {
    const Image& image = texture.levels[level];
    const std::array size{image.width, image.height, slice_count(texture, level)};
    const std::array wraps{sampler.wrap_u, sampler.wrap_v, sampler.wrap_w};
    std::array<std::array<int, 2>, 3> index{};
    std::array<float, 3> weight{};
    const bool is_nearest = sampler.filter == Filter::nearest;
    for (std::size_t i = 0; i < 3; ++i) {
      const float p = at[static_cast<int>(i)] * static_cast<float>(size[i]);
      const float q = is_nearest ? p : rounded(p - 0.5f);
      const int first = static_cast<int>(std::floor(q));
      weight[i] = is_nearest ? 0.0f : q - std::floor(q);
      for (const int k : {0, 1}) {
        index[i][static_cast<std::size_t>(k)] = oracle_wrap(first + k, size[i], wraps[i]);
      }
    }
    const auto texel = [&](std::size_t i, std::size_t j, std::size_t k) {
      return load_texel(slice_level(texture, index[2][k], level), index[0][i], index[1][j]);
    };
    if (is_nearest) return texel(0, 0, 0);
    std::array<glm::vec4, 2> slices{};
    for (std::size_t k = 0; k < 2; ++k) {
      slices[k] = mix(mix(texel(0, 0, k), texel(1, 0, k), weight[0]),
                      mix(texel(0, 1, k), texel(1, 1, k), weight[0]), weight[1]);
    }
    return mix(slices[0], slices[1], weight[2]);
  }

  glm::vec4 of_cube(glm::vec3 at, std::size_t level) const {
    const int size = texture.levels[level].width;
    const auto length = static_cast<float>(size);
    const int face = oracle_face(at.x, at.y, at.z);
    const auto [sc, tc, ma] = on_cube_face(face, at.x, at.y, at.z);
    const float h = 0.5f / ma;
    const float s = sc * h + 0.5f, t = tc * h + 0.5f;
    const auto texel = [&](int x, int y) {
      const CubeTexel where = oracle_cube_texel({face, x, y}, size);
      return load_texel(slice_level(texture, where.face, level), where.x, where.y);
    };
    if (sampler.filter == Filter::nearest) {
      const auto index = [&](float p) { return std::min(static_cast<int>(p * length), size - 1); };
      return texel(index(s), index(t));
    }
    const float p = rounded(s * length - 0.5f), q = rounded(t * length - 0.5f);
    const int x = static_cast<int>(std::floor(p)), y = static_cast<int>(std::floor(q));
    std::array<glm::vec4, 4> of{};
    std::array<bool, 4> is_corner{};
    for (int i = 0; i < 4; ++i) {
      const int column = x + i % 2, row = y + i / 2;
      const bool beside = column < 0 || column >= size, above = row < 0 || row >= size;
      is_corner[static_cast<std::size_t>(i)] = beside && above;
      if (!beside || !above) of[static_cast<std::size_t>(i)] = texel(column, row);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      if (!is_corner[i]) continue;
      std::array<glm::vec4, 3> others{};
      std::size_t n = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        if (k != i) others[n++] = of[k];
      }
      of[i] = ((others[0] + others[1]) + others[2]) * (1.0f / 3.0f);
    }
    return mix(mix(of[0], of[1], p - std::floor(p)), mix(of[2], of[3], p - std::floor(p)),
               q - std::floor(q));
  }

  glm::vec4 sampled(glm::vec3 at, float lod) const {
    const auto one = [&](std::size_t level) {
      return texture.shape == TextureShape::cube ? of_cube(at, level) : of_volume(at, level);
    };
    const float last = static_cast<float>(texture.levels.size() - 1);
    lod = std::clamp(lod, 0.0f, last);
    if (sampler.filter != Filter::trilinear) {
      return one(static_cast<std::size_t>(std::floor(lod + 0.5f)));
    }
    const float base = std::floor(lod), weight = rounded(lod - base);
    const glm::vec4 fine = one(static_cast<std::size_t>(base));
    return weight == 0.0f ? fine : mix(fine, one(static_cast<std::size_t>(base) + 1), weight);
  }
};

}  // namespace softfocus::test
