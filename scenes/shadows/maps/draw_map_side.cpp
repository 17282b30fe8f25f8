#include "scenes/shadows/maps/draw_map_side.h"

#include <algorithm>
#include <limits>

#include "raster/pipeline/setup.h"
#include "scenes/shadows/light_grid.h"

namespace softfocus {
namespace {

double inside_by(const SideCuts& cuts, glm::dvec3 p, int side) {
  const double w = cuts.is_directional ? 1.0 : p.z;
  switch (side) {
    case 0: return p.z - cuts.least_z;
    case 1: return p.x - cuts.low.x * w;
    case 2: return cuts.high.x * w - p.x;
    case 3: return p.y - cuts.low.y * w;
    default: return cuts.high.y * w - p.y;
  }
}

// Casters of a part, which a task cuts, for tasks that each draw some rows.
constexpr std::size_t kCastersOfPart = 1024;
constexpr int kRowsOfBand = 32;

class CasterCutter {
 public:
  CasterCutter(const ShadowLight& light, const MapSide& side, int size, double least_z)
      : side_(side), size_(size) {
    // A texel's room around the centres, so that no cut runs between them.
    cuts_.low = side.low - 1.0 / side.texels;
    cuts_.high = side.low + (size + 1.0) / side.texels;
    cuts_.least_z = least_z;
    cuts_.is_directional = light.w == 0.0;
  }

  void add(const Facet& facet, const FacetPlane& plane, CutCasters& part) const {
    MapPolygon polygon;
    for (const glm::dvec3& corner : facet.corners) {
      const glm::dvec3 q = corner - side_.origin;
      polygon.corners[polygon.count++] = {dot(q, side_.axes[0]), dot(q, side_.axes[1]),
                                          dot(q, side_.axes[2])};
    }
    cut_to_side(polygon, cuts_);
    if (polygon.count < 3) return;
    MapTriangle triangle = over_places(plane);
    triangle.least = std::numeric_limits<double>::infinity();
    triangle.most = -triangle.least;
    std::array<WindowVertex, 9> window{};
    CutCasters::Rows rows{size_, 0};
    for (std::size_t i = 0; i < polygon.count; ++i) {
      const glm::dvec3& p = polygon.corners[i];
      const double w = cuts_.is_directional ? 1.0 : p.z;
      const double nearness = cuts_.is_directional ? -p.z : 1.0 / p.z;
      triangle.least = std::min(triangle.least, nearness);
      triangle.most = std::max(triangle.most, nearness);
      const double u = (p.x / w - side_.low.x) * side_.texels.x;
      const double v = (p.y / w - side_.low.y) * side_.texels.y;
      window[i] = {static_cast<float>(u), static_cast<float>(v), 0.0f, 1.0f};
      // Between -1 and size + 1 but for rounding.
      const int row = static_cast<int>(std::clamp(v, 0.0, static_cast<double>(size_)));
      rows.begin = std::min(rows.begin, row - 1);
      rows.end = std::max(rows.end, row + 2);
    }
    for (std::size_t i = 2; i < polygon.count; ++i) {
      triangle.window = {window[0], window[i - 1], window[i]};
      part.triangles.push_back(triangle);
      part.rows.push_back(rows);
    }
  }

 private:
  // With the plane (n_x, n_y, n_z) . (x, y, z) = d: directional -z = ((n_x x + n_y y) - d) / n_z,
  // point light 1 / z = ((n_x x/z + n_y y/z) + n_z) / d.
  MapTriangle over_places(const FacetPlane& plane) const {
    const double n_x = dot(plane.normal, side_.axes[0]), n_y = dot(plane.normal, side_.axes[1]);
    const double n_z = dot(plane.normal, side_.axes[2]);
    const double d = plane.offset - dot(plane.normal, side_.origin);
    const double divisor = cuts_.is_directional ? n_z : d;
    const double last = cuts_.is_directional ? -d : n_z;
    MapTriangle triangle{};
    triangle.over_u = n_x / (divisor * side_.texels.x);
    triangle.over_v = n_y / (divisor * side_.texels.y);
    triangle.at_origin = ((n_x * side_.low.x + n_y * side_.low.y) + last) / divisor;
    return triangle;
  }

  const MapSide& side_;
  int size_;
  SideCuts cuts_;
};

void fill(const MapTriangle& triangle, const Rectangle& band, const Profile& profile,
          MapSide& side) {
  const auto setup =
      set_up_triangle(triangle.window, Cull::none, FrontFace::counter_clockwise, band, profile);
  if (!setup) return;
  const Rectangle& bounds = setup->bounds;
  for (int y = bounds.y_begin; y < bounds.y_end; ++y) {
    const Span span = covered_span(*setup, y, bounds.x_begin, bounds.x_end);
    float* row =
        side.nearness.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(band.x_end);
    const double at_row = triangle.over_v * (y + 0.5) + triangle.at_origin;
    for (int x = span.x_begin; x < span.x_end; ++x) {
      const double plain = triangle.over_u * (x + 0.5) + at_row;
      const double kept = std::min(std::max(plain, triangle.least), triangle.most);
      const auto nearness = static_cast<float>(kept);
      // Not a number stays out.
      if (nearness > row[x]) row[x] = nearness;
    }
  }
}

}  // namespace

void cut_to_side(MapPolygon& polygon, const SideCuts& cuts) {
  for (int side = cuts.is_directional ? 1 : 0; side < 5 && polygon.count > 0; ++side) {
    MapPolygon kept;
    const auto put = [&](glm::dvec3 p) {
      if (kept.count < kept.corners.size()) kept.corners[kept.count++] = p;
    };
    for (std::size_t i = 0; i < polygon.count; ++i) {
      const glm::dvec3 a = polygon.corners[i], b = polygon.corners[(i + 1) % polygon.count];
      const double d_a = inside_by(cuts, a, side), d_b = inside_by(cuts, b, side);
      if (d_a >= 0.0) put(a);
      if ((d_a < 0.0) == (d_b < 0.0)) continue;
      put(d_a < 0.0 ? b + (a - b) * (d_b / (d_b - d_a)) : a + (b - a) * (d_a / (d_a - d_b)));
    }
    polygon = kept;
  }
}

std::vector<CutCasters> cut_casters(const Facets& facets, const ShadowLight& light, int size,
                                    const MapSide& side, ThreadPool& pool) {
  const std::size_t count = facets.facets.size();
  std::vector<CutCasters> parts((count + kCastersOfPart - 1) / kCastersOfPart);
  const CasterCutter cutter{light, side, size, facets.epsilon_m};
  pool.for_each(static_cast<int>(parts.size()), [&](int number) {
    const std::size_t begin = static_cast<std::size_t>(number) * kCastersOfPart;
    for (std::size_t i = begin; i < std::min(begin + kCastersOfPart, count); ++i) {
      if (!stops_light(facets.facets[i], facets.planes[i], light)) continue;
      cutter.add(facets.facets[i], facets.planes[i], parts[static_cast<std::size_t>(number)]);
    }
  });
  return parts;
}

void draw_casters(std::span<const CutCasters> casters, int size, const Profile& profile,
                  MapSide& side, ThreadPool& pool) {
  side.nearness.clear();
  if (std::all_of(casters.begin(), casters.end(),
                  [](const CutCasters& part) { return part.triangles.empty(); })) {
    return;
  }
  side.nearness.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  pool.for_each((size + kRowsOfBand - 1) / kRowsOfBand, [&](int number) {
    const int begin = number * kRowsOfBand;
    const Rectangle band{0, begin, size, std::min(begin + kRowsOfBand, size)};
    const auto texel = [&](int y) {
      return side.nearness.begin() + static_cast<std::ptrdiff_t>(y) * size;
    };
    std::fill(texel(band.y_begin), texel(band.y_end), -std::numeric_limits<float>::infinity());
    for (const CutCasters& part : casters) {
      for (std::size_t i = 0; i < part.rows.size(); ++i) {
        if (part.rows[i].begin >= band.y_end || part.rows[i].end <= band.y_begin) continue;
        fill(part.triangles[i], band, profile, side);
      }
    }
  });
}

void draw_map_side(const Facets& facets, const ShadowLight& light, int size, const Profile& profile,
                   MapSide& side, ThreadPool& pool) {
  draw_casters(cut_casters(facets, light, size, side, pool), size, profile, side, pool);
}

}  // namespace softfocus
