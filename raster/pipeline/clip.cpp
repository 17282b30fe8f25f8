#include "raster/pipeline/clip.h"

#include <cmath>

namespace softfocus {
namespace {

constexpr int kPlanes = 6;

// Positive inside.
float plane_distance(int plane, const glm::vec4& p, float guard_band) {
  switch (plane) {
    case 0: return guard_band * p.w - p.x;
    case 1: return guard_band * p.w + p.x;
    case 2: return guard_band * p.w - p.y;
    case 3: return guard_band * p.w + p.y;
    case 4: return p.w + p.z;
    default: return p.w - p.z;
  }
}

float window_fraction_by_image(const glm::vec4& from, const glm::vec4& to, const glm::vec4& cut,
                               float t) {
  for (int i = 0; i < 2; ++i) {
    if (from[i] == to[i]) continue;
    const float image_from = from[i] / from.w;
    return (cut[i] / cut.w - image_from) / (to[i] / to.w - image_from);
  }
  return t;
}

ClipVertex cut_edge(const ClipVertex& inside, const ClipVertex& outside, float inside_distance,
                    float outside_distance, std::span<const Interpolation> varyings,
                    bool by_image) {
  const bool from_outside = -outside_distance < inside_distance;
  const ClipVertex& from = from_outside ? outside : inside;
  const ClipVertex& to = from_outside ? inside : outside;
  const float t = from_outside ? outside_distance / (outside_distance - inside_distance)
                               : inside_distance / (inside_distance - outside_distance);
  ClipVertex cut{};
  cut.is_new = true;
  cut.position = from.position + (to.position - from.position) * t;
  const float t_window = by_image
                             ? window_fraction_by_image(from.position, to.position, cut.position, t)
                             : t * to.position.w / cut.position.w;
  for (std::size_t i = 0; i < varyings.size(); ++i) {
    const float difference = to.varyings[i] - from.varyings[i];
    switch (varyings[i]) {
      case Interpolation::perspective: cut.varyings[i] = from.varyings[i] + t * difference; break;
      case Interpolation::linear: cut.varyings[i] = from.varyings[i] + t_window * difference; break;
      case Interpolation::flat: cut.varyings[i] = inside.varyings[i]; break;
    }
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

void clip_polygon(ClipPolygon& polygon, unsigned planes, std::span<const Interpolation> varyings,
                  const Profile& profile) {
  const float guard_band = profile.guard_band;
  const bool by_image = profile.clipping == Clipping::mesa;
  for (int plane = 0; plane < kPlanes; ++plane) {
    if ((planes >> plane & 1u) == 0) continue;
    ClipPolygon kept;
    for (std::size_t i = 0; i < polygon.count; ++i) {
      const ClipVertex& from = polygon.vertices[i];
      const ClipVertex& to = polygon.vertices[(i + 1) % polygon.count];
      const float d_from = plane_distance(plane, from.position, guard_band);
      const float d_to = plane_distance(plane, to.position, guard_band);
      if (!std::isfinite(d_from)) {
        polygon.count = 0;
        return;
      }
      if (d_from >= 0.0f) kept.vertices[kept.count++] = from;
      if (d_from >= 0.0f && d_to < 0.0f) {
        kept.vertices[kept.count++] = cut_edge(from, to, d_from, d_to, varyings, by_image);
      } else if (d_from < 0.0f && d_to >= 0.0f) {
        kept.vertices[kept.count++] = cut_edge(to, from, d_to, d_from, varyings, by_image);
      }
    }
    polygon = kept;
    if (polygon.count < 3) polygon.count = 0;
  }
}

}  // namespace softfocus
