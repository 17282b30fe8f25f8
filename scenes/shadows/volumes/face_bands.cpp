#include "scenes/shadows/volumes/face_bands.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softfocus {
namespace {

double size_of(glm::dvec3 v) { return (std::fabs(v.x) + std::fabs(v.y)) + std::fabs(v.z); }

// Directions that are all but opposite: what lies between them can be anywhere.
bool is_opposite(glm::dvec3 a, glm::dvec3 b) {
  return size_of(a / size_of(a) + b / size_of(b)) < 0x1p-16;
}

}  // namespace

std::vector<glm::dvec3> corners_in_pixels(const PixelSpace& space, const JoinedFacets& joined,
                                          const ShadowLight& light, ThreadPool& pool) {
  const std::size_t count = joined.corners.size();
  std::vector<glm::dvec3> all(light.w == 0.0 ? count + 1 : 2 * count);
  if (light.w == 0.0) all[count] = to_pixels(space, -light.place);
  constexpr std::size_t kCornersATask = 4096;
  pool.for_each(static_cast<int>((count + kCornersATask - 1) / kCornersATask), [&](int task) {
    const std::size_t begin = static_cast<std::size_t>(task) * kCornersATask;
    for (std::size_t i = begin; i < std::min(begin + kCornersATask, count); ++i) {
      all[i] = to_pixels(space, joined.corners[i] - space.eye);
      if (light.w != 0.0) all[count + i] = to_pixels(space, joined.corners[i] - light.place);
    }
  });
  return all;
}

// Cut where rays are not as deep as samples, which only faces behind the samples may be. Corners
// at infinity are deep if they are before the camera. The whole picture where a cut would be too
// far away to compute with.
Outline outline_of(const VolumeFace& face, const SeenFaces& of, VolumeCount count,
                   const PixelSpace& space, const ShadowView& view) {
  const double width = view.width, height = view.height;
  const Outline whole{{glm::dvec2{0.0}, {width, 0.0}, {width, height}, {0.0, height}}, 4};
  const std::array<glm::dvec3, 3> v = corners_of(face, of);
  if (v[0].z <= 0.0 && v[1].z <= 0.0 && v[2].z <= 0.0) return {};
  std::array<double, 3> inside_by{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    const bool is_far = face.corners[i] >= of.first_far;
    const double least = is_far ? size_of(v[i]) / (width + height) * 0x1p-24 : space.least_w;
    inside_by[i] = v[i].z - least;
    if (count == VolumeCount::z_pass) {
      if (inside_by[i] < 0.0) return whole;
    } else if (is_far && face.corners[next] >= of.first_far && is_opposite(v[i], v[next])) {
      return whole;
    }
  }
  Outline outline;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    if (inside_by[i] >= 0.0) outline.corners[outline.count++] = glm::dvec2{v[i]} / v[i].z;
    if ((inside_by[i] >= 0.0) != (inside_by[next] >= 0.0)) {
      const glm::dvec3 cut =
          v[i] + (v[next] - v[i]) * (inside_by[i] / (inside_by[i] - inside_by[next]));
      outline.corners[outline.count++] = glm::dvec2{cut} / cut.z;
    }
  }
  return outline;
}

Extremes rows_of(const Outline& outline) {
  Extremes range;
  for (std::size_t i = 0; i < outline.count; ++i) widen(range, outline.corners[i].y);
  return range;
}

Extremes columns_of(const Outline& outline, double y_low, double y_high) {
  Extremes range;
  for (std::size_t i = 0; i < outline.count; ++i) {
    glm::dvec2 a = outline.corners[i], b = outline.corners[(i + 1) % outline.count];
    if (a.y > b.y) std::swap(a, b);
    if (b.y < y_low || a.y > y_high) continue;
    const double per_y = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
    widen(range, a.y < y_low ? a.x + (y_low - a.y) * per_y : a.x);
    widen(range, b.y > y_high ? b.x + (y_high - b.y) * per_y : b.x);
  }
  return range;
}

Cells cells_within(double low, double high, int size, int most) {
  if (!(low <= high)) return {0, 0};
  const double begin = std::floor(low / size), end = std::floor(high / size) + 1.0;
  return {begin > 0.0 ? static_cast<int>(std::min<double>(begin, most)) : 0,
          end > 0.0 ? static_cast<int>(std::min<double>(end, most)) : 0};
}

Bands sort_into_bands(const SeenFaces& of, VolumeCount count, const PixelSpace& space,
                      const ShadowView& view, ThreadPool& pool) {
  const std::span<const VolumeFace> faces = of.faces;
  const int bands_down = (view.height + kBandRows - 1) / kBandRows;
  std::vector<Cells> of_faces(faces.size(), {0, 0});
  constexpr std::size_t kFacesATask = 4096;
  pool.for_each(static_cast<int>((faces.size() + kFacesATask - 1) / kFacesATask), [&](int task) {
    const std::size_t begin = static_cast<std::size_t>(task) * kFacesATask;
    for (std::size_t i = begin; i < std::min(begin + kFacesATask, faces.size()); ++i) {
      const Outline outline = outline_of(faces[i], of, count, space, view);
      const Extremes rows = rows_of(outline), columns = columns_of(outline, 0.0, view.height);
      if (columns.high < -kReach || columns.low > view.width + kReach) continue;
      of_faces[i] = cells_within(rows.low - kReach, rows.high + kReach, kBandRows, bands_down);
    }
  });
  Bands bands;
  bands.begins.assign(static_cast<std::size_t>(bands_down) + 1, 0);
  for (const Cells& cells : of_faces) {
    for (int band = cells.begin; band < cells.end; ++band) {
      ++bands.begins[static_cast<std::size_t>(band) + 1];
    }
  }
  for (std::size_t i = 1; i < bands.begins.size(); ++i) bands.begins[i] += bands.begins[i - 1];
  bands.faces.resize(bands.begins.back());
  std::vector<std::size_t> next = bands.begins;
  for (std::uint32_t i = 0; i < of_faces.size(); ++i) {
    for (int band = of_faces[i].begin; band < of_faces[i].end; ++band) {
      bands.faces[next[static_cast<std::size_t>(band)]++] = i;
    }
  }
  return bands;
}

}  // namespace softfocus
