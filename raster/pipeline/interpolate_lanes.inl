// Varyings at the pixels of kLanes lanes, each of a triangle of its own: interpolate.h and
// planes.h, lane by lane.

namespace {

/// The triangles of a vector's lanes: `count` different ones, and which lanes are of each.
struct LaneSources {
  int count = 0;
  std::array<const LaneTriangle*, kLanes> triangles;
  std::array<LaneMask, kLanes> masks;
  std::array<std::array<const float*, kLanes>, 3> rows;  ///< their vertices
};

SOFTFOCUS_INLINE void add_source(LaneSources& sources, const LaneTriangle& triangle, Mask lanes,
                                 const std::array<const float*, 3>& rows) {
  const auto d = static_cast<std::size_t>(sources.count++);
  sources.triangles[d] = &triangle;
  sources.masks[d] = to_lane_mask(lanes);
  for (std::size_t v = 0; v < 3; ++v) sources.rows[v][d] = rows[v];
}

/// What lanes read of their triangles' vertices: the floats kFirst <= k < kEnd of the rows.
template <std::size_t kFirst, std::size_t kEnd>
struct VertexLanes {
  std::array<std::array<Floats, kEnd - kFirst>, 3> values;

  SOFTFOCUS_INLINE Floats at(std::size_t vertex, std::size_t k) const {
    return values[vertex][k - kFirst];
  }
  SOFTFOCUS_INLINE void load(const LaneSources& sources) {
    const auto count = static_cast<std::size_t>(sources.count);
    for (std::size_t v = 0; v < 3; ++v) {
      const auto& rows = sources.rows[v];
      for (std::size_t k = kFirst; k < kEnd; ++k) {
        Floats value = splat(rows[0][k]);
        for (std::size_t d = 1; d < count; ++d) {
          value = splat_where(sources.masks[d], rows[d][k], value);
        }
        values[v][k - kFirst] = value;
      }
    }
  }
};

/// One value of each lane's triangle.
template <class Value>
SOFTFOCUS_INLINE auto of_sources(const LaneSources& sources, Value LaneTriangle::*field) {
  auto value = splat(sources.triangles[0]->*field);
  for (std::size_t d = 1; d < static_cast<std::size_t>(sources.count); ++d) {
    value = splat_where(sources.masks[d], sources.triangles[d]->*field, value);
  }
  return value;
}
SOFTFOCUS_INLINE Ints of_sources(const LaneSources& sources,
                                 std::array<std::int32_t, 3> LaneTriangle::*field, std::size_t i) {
  Ints value = splat((sources.triangles[0]->*field)[i]);
  for (std::size_t d = 1; d < static_cast<std::size_t>(sources.count); ++d) {
    value = splat_where(sources.masks[d], (sources.triangles[d]->*field)[i], value);
  }
  return value;
}

/// Triangles by lane.
struct TrianglesOfLanes {
  const LaneTriangle* const* triangles;
  Ints index;

  SOFTFOCUS_INLINE const LaneTriangle& operator[](int lane) const {
    return *triangles[index[lane]];
  }
};

/// The weights of vertices 1 and 2 at a pixel.
struct Weights {
  Floats linear1, linear2, perspective1, perspective2;
};

/// As BarycentricInterpolator.
template <std::size_t N>
struct BarycentricLanes {
  VertexLanes<kVertexInverseW, kVertexVaryings + N> vertices;
  std::array<Ints, 3> edge, per_x, per_y;
  Ints x_origin, y_origin;
  Floats inverse_area;
  unsigned large_lanes;

  SOFTFOCUS_INLINE static std::array<const float*, 3> rows(const LaneTriangle& t, std::size_t) {
    return t.vertices;
  }
  SOFTFOCUS_INLINE void load(const LaneSources& sources) {
    vertices.load(sources);
    for (std::size_t i = 0; i < 3; ++i) {
      edge[i] = of_sources(sources, &LaneTriangle::edge, i);
      per_x[i] = of_sources(sources, &LaneTriangle::per_x, i);
      per_y[i] = of_sources(sources, &LaneTriangle::per_y, i);
    }
    x_origin = of_sources(sources, &LaneTriangle::x_origin);
    y_origin = of_sources(sources, &LaneTriangle::y_origin);
    inverse_area = of_sources(sources, &LaneTriangle::inverse_area);
    large_lanes = lane_bits(of_sources(sources, &LaneTriangle::is_large) != 0);
  }

  SOFTFOCUS_INLINE Weights weights(Ints x, Ints y, const TrianglesOfLanes& triangles) const {
    std::array<Floats, 3> l;
    const Ints dx = x - x_origin;
    const Ints dy = y - y_origin;
    for (std::size_t i = 0; i < 3; ++i) {
      l[i] = to_floats(edge[i] + (dx * per_x[i] + dy * per_y[i]));
    }
    for (unsigned rest = large_lanes; rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      for (std::size_t i = 0; i < 3; ++i) {
        l[i][lane] = static_cast<float>(edge_at(triangles[lane].large->edges[i], x[lane], y[lane]));
      }
    }
    for (std::size_t i = 0; i < 3; ++i) l[i] *= inverse_area;
    const Floats p0 = l[0] * vertices.at(0, kVertexInverseW);
    const Floats p1 = l[1] * vertices.at(1, kVertexInverseW);
    const Floats p2 = l[2] * vertices.at(2, kVertexInverseW);
    const Floats reciprocal = 1.0f / ((p0 + p1) + p2);
    return {l[1], l[2], p1 * reciprocal, p2 * reciprocal};
  }

  SOFTFOCUS_INLINE Floats blend(std::size_t varying, Floats weight1, Floats weight2) const {
    const Floats a0 = vertices.at(0, kVertexVaryings + varying);
    const Floats a1 = vertices.at(1, kVertexVaryings + varying);
    const Floats a2 = vertices.at(2, kVertexVaryings + varying);
    return (a0 + weight1 * (a1 - a0)) + weight2 * (a2 - a0);
  }

  SOFTFOCUS_INLINE Floats value(std::size_t varying, Interpolation kind, std::size_t provoking,
                                const Weights& w) const {
    switch (kind) {
      case Interpolation::perspective: return blend(varying, w.perspective1, w.perspective2);
      case Interpolation::linear: return blend(varying, w.linear1, w.linear2);
      case Interpolation::flat: break;
    }
    return vertices.at(provoking, kVertexVaryings + varying);
  }
};

/// The window position of a pixel and 1 / (1 / w) there.
struct PlanePoint {
  Floats x, y, w;
};

/// As PlaneInterpolator with PlanesFromOrigin. The vertices are in the planes' order.
template <std::size_t N, Contraction contraction>
struct PlaneLanes {
  VertexLanes<kVertexX, kVertexVaryings + N> vertices;
  Floats x0, y0, dx01_over_area, dy01_over_area, dx20_over_area, dy20_over_area;

  SOFTFOCUS_INLINE static std::array<const float*, 3> rows(const LaneTriangle& t,
                                                           std::size_t provoking) {
    std::array<const float*, 3> ordered = t.vertices;
    if (t.clockwise) std::swap(ordered[1], ordered[provoking == 0 ? 2 : 0]);
    return ordered;
  }
  SOFTFOCUS_INLINE void load(const LaneSources& sources) {
    vertices.load(sources);
    const Floats x = vertices.at(0, kVertexX);
    const Floats y = vertices.at(0, kVertexY);
    const Floats dx01 = x - vertices.at(1, kVertexX);
    const Floats dy01 = y - vertices.at(1, kVertexY);
    const Floats dx20 = vertices.at(2, kVertexX) - x;
    const Floats dy20 = vertices.at(2, kVertexY) - y;
    const Floats one_over_area = 1.0f / (dx01 * dy20 - dx20 * dy01);
    x0 = x - 0.5f;
    y0 = y - 0.5f;
    dx01_over_area = dx01 * one_over_area;
    dy01_over_area = dy01 * one_over_area;
    dx20_over_area = dx20 * one_over_area;
    dy20_over_area = dy20 * one_over_area;
  }

  SOFTFOCUS_INLINE static Floats multiply_add(Floats a, Floats b, Floats c) {
    if constexpr (contraction == Contraction::fused) return fused_multiply_add(a, b, c);
    return a * b + c;
  }

  SOFTFOCUS_INLINE Floats plane_at(Floats a0, Floats a1, Floats a2, Floats x, Floats y) const {
    const Floats da01 = a0 - a1;
    const Floats da20 = a2 - a0;
    const Floats per_x = da01 * dy20_over_area - da20 * dy01_over_area;
    const Floats per_y = da20 * dx01_over_area - da01 * dx20_over_area;
    const Floats at_origin = a0 - (per_x * x0 + per_y * y0);
    return multiply_add(per_y, y, multiply_add(per_x, x, at_origin));
  }

  SOFTFOCUS_INLINE PlanePoint weights(Ints x, Ints y, const TrianglesOfLanes&) const {
    const Floats column = to_floats(x);
    const Floats row = to_floats(y);
    const Floats inverse_w =
        plane_at(vertices.at(0, kVertexInverseW), vertices.at(1, kVertexInverseW),
                 vertices.at(2, kVertexInverseW), column, row);
    return {column, row, 1.0f / inverse_w};
  }

  SOFTFOCUS_INLINE Floats value(std::size_t varying, Interpolation kind, std::size_t provoking,
                                const PlanePoint& point) const {
    const std::size_t k = kVertexVaryings + varying;
    Floats a0 = vertices.at(0, k);
    Floats a1 = vertices.at(1, k);
    Floats a2 = vertices.at(2, k);
    if (kind == Interpolation::flat) {
      // What swapping put elsewhere: vertex 2 if that is provoking, else vertex 0, stays.
      return provoking == 0 ? a0 : a2;
    }
    if (kind == Interpolation::linear) return plane_at(a0, a1, a2, point.x, point.y);
    a0 *= vertices.at(0, kVertexInverseW);
    a1 *= vertices.at(1, kVertexInverseW);
    a2 *= vertices.at(2, kVertexInverseW);
    return plane_at(a0, a1, a2, point.x, point.y) * point.w;
  }
};

}  // namespace
