#pragma once
// From a triangle in clip space to the triangles in the window that clipping leaves of it.

#include <algorithm>
#include <array>
#include <cstddef>

#include "raster/pipeline/clip.h"
#include "raster/pipeline/setup.h"
#include "raster/pipeline/stages.h"
#include "raster/pipeline/state.h"

namespace softfocus {

inline std::size_t provoking_index(ProvokingVertex provoking) {
  return provoking == ProvokingVertex::last ? 2 : 0;
}
inline std::size_t provoking_index(const DrawState& state) {
  return provoking_index(state.provoking_vertex);
}

// Clipped polygons are fans about vertex 0, which is the provoking one.
inline std::array<std::size_t, 3> fan_triangle(std::size_t i, ProvokingVertex provoking) {
  return provoking == ProvokingVertex::last ? std::array<std::size_t, 3>{i - 1, i, 0}
                                            : std::array<std::size_t, 3>{0, i - 1, i};
}

/// Calls add(window vertices, varyings) for each triangle that clipping leaves: the triangle
/// itself if all of it is inside.
template <std::size_t N, class Add>
void to_window_triangles(const std::array<VertexOutput<N>, 3>& corners,
                         const std::array<Interpolation, N>& kinds, ProvokingVertex provoking,
                         const Rectangle& viewport, const Profile& profile, const Add& add) {
  unsigned outside_any = 0;
  unsigned outside_all = ~0u;
  for (const VertexOutput<N>& corner : corners) {
    const unsigned code = clip_code(corner.position, profile.guard_band);
    outside_any |= code;
    outside_all &= code;
  }
  if (outside_all != 0 || (outside_any & kNotFinite) != 0) return;
  const auto in_window = [&](const glm::vec4& position, Contraction contraction) {
    return to_window(position, viewport.x_end - viewport.x_begin, viewport.y_end - viewport.y_begin,
                     contraction, viewport.x_begin, viewport.y_begin);
  };
  std::array<WindowVertex, 3> window{};
  std::array<Varyings<N>, 3> varyings{};
  if (outside_any == 0) {
    for (std::size_t i = 0; i < 3; ++i) {
      window[i] = in_window(corners[i].position, profile.viewport);
      varyings[i] = corners[i].varyings;
    }
    add(window, varyings);
    return;
  }

  ClipPolygon polygon;
  polygon.count = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    polygon.vertices[i].position = corners[i].position;
    for (std::size_t k = 0; k < N; ++k) {
      // Triangles of the fan below have other provoking vertices: all get the flat values.
      const bool is_flat = kinds[k] == Interpolation::flat;
      polygon.vertices[i].varyings[k] =
          corners[is_flat ? provoking_index(provoking) : i].varyings[k];
    }
  }
  clip_polygon(polygon, outside_any, kinds, profile);
  for (std::size_t i = 2; i < polygon.count; ++i) {
    const auto corner_numbers = fan_triangle(i, provoking);
    for (std::size_t k = 0; k < 3; ++k) {
      const ClipVertex& corner = polygon.vertices[corner_numbers[k]];
      window[k] =
          in_window(corner.position, corner.is_new ? Contraction::unfused : profile.viewport);
      std::copy_n(corner.varyings.begin(), N, varyings[k].begin());
    }
    add(window, varyings);
  }
}

}  // namespace softfocus
