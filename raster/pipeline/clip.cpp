#include "raster/pipeline/clip.h"

#include <cmath>

namespace softfocus {
namespace {

constexpr int kPlanes = 6;

// Positive inside.
float plane_distance(int plane, const glm::vec4& p, float guard_band) {
  switch (plane) {
    case 0: return p.w + p.z;
    case 1: return p.w - p.z;
    case 2: return guard_band * p.w + p.x;
    case 3: return guard_band * p.w - p.x;
    case 4: return guard_band * p.w + p.y;
    default: return guard_band * p.w - p.y;
  }
}

ClipVertex cut_edge(const ClipVertex& inside, const ClipVertex& outside, float inside_distance,
                    float outside_distance, std::span<const Interpolation> varyings) {
  const float t = inside_distance / (inside_distance - outside_distance);
  ClipVertex cut{};
  cut.position = inside.position + (outside.position - inside.position) * t;
  // Where the cut lies between the two points' images in the window.
  const float t_window = t * outside.position.w / cut.position.w;
  for (std::size_t i = 0; i < varyings.size(); ++i) {
    const float along = varyings[i] == Interpolation::linear ? t_window : t;
    cut.varyings[i] = inside.varyings[i] + along * (outside.varyings[i] - inside.varyings[i]);
  }
  return cut;
}

}  // namespace

unsigned clip_code(const glm::vec4& position, float guard_band) {
  for (int i = 0; i < 4; ++i) {
    if (!std::isfinite(position[i])) return kNotFinite;
  }
  unsigned code = 0;
  for (int plane = 0; plane < kPlanes; ++plane) {
    if (plane_distance(plane, position, guard_band) < 0.0f) code |= 1u << plane;
  }
  return code;
}

void clip_polygon(ClipPolygon& polygon, unsigned planes, float guard_band,
                  std::span<const Interpolation> varyings) {
  for (int plane = 0; plane < kPlanes; ++plane) {
    if ((planes >> plane & 1u) == 0 || polygon.count == 0) continue;
    ClipPolygon kept;
    for (std::size_t i = 0; i < polygon.count; ++i) {
      const ClipVertex& from = polygon.vertices[i];
      const ClipVertex& to = polygon.vertices[(i + 1) % polygon.count];
      const float d_from = plane_distance(plane, from.position, guard_band);
      const float d_to = plane_distance(plane, to.position, guard_band);
      if (d_from >= 0.0f) kept.vertices[kept.count++] = from;
      if (d_from >= 0.0f && d_to < 0.0f) {
        kept.vertices[kept.count++] = cut_edge(from, to, d_from, d_to, varyings);
      } else if (d_from < 0.0f && d_to >= 0.0f) {
        kept.vertices[kept.count++] = cut_edge(to, from, d_to, d_from, varyings);
      }
    }
    polygon = kept;
  }
}

}  // namespace softfocus
