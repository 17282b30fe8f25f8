// Varyings at the pixels of kQuads quads. Each quad shows a triangle of its own. The scalar form
// is interpolate.h and planes.h.

namespace {

/// The triangle that each quad shows.
using QuadTriangles = std::array<const LaneTriangle*, kQuads>;

template <const auto& kinds>
inline constexpr bool kAllPerspective = std::count(kinds.begin(), kinds.end(),
                                                   Interpolation::perspective) == std::ssize(kinds);

/// Lanes j of each four for which varying 4 `four` + j is of the kind.
template <const auto& kinds>
SOFTFOCUS_INLINE Mask lanes_of_kind(Interpolation kind, std::size_t four) {
  Mask mask{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::size_t varying = 4 * four + static_cast<std::size_t>(lane % 4);
    if (varying < kinds.size() && kinds[varying] == kind) mask[lane] = -1;
  }
  return mask;
}

// Varyings come four at a time: the lanes of a quad hold four varyings of a vertex or a plane,
// as they lie in its row, and for each of the quad's pixels four values are computed. The last
// step, a transposition, gives each varying the lanes of the pixels.

/// Each pixel's number in all lanes of its quad.
using OfPixels = std::array<Floats, kQuadPixels>;
SOFTFOCUS_INLINE OfPixels of_pixels(Floats v) {
  return {spread<0>(v), spread<1>(v), spread<2>(v), spread<3>(v)};
}

/// The rows of one vertex of each quad's triangle.
using VertexRows = std::array<const float*, kQuads>;

SOFTFOCUS_INLINE Floats load_varyings(const VertexRows& rows, std::size_t four) {
  return load_fours(rows.data(), kVertexVaryings + 4 * four);
}

/// The weights of vertices 1 and 2 at a pixel.
struct Weights {
  Floats linear1, linear2, perspective1, perspective2;
};

/// As BarycentricInterpolator.
template <const auto& kinds>
struct BarycentricLanes {
  using Point = Weights;
  /// At vertex 0, the differences of the others to it, and at the provoking vertex.
  struct Four {
    Floats first, to_second, to_third, flat;
  };
  std::array<Four, (kinds.size() + 3) / 4> fours;
  std::array<Floats, 3> inverse_w;
  std::array<Ints, 3> edge, per_x, per_y;
  Ints x_origin, y_origin;
  Floats inverse_area;
  const QuadTriangles* of_quads;
  bool any_large;

  /// Keeps a pointer to the triangles.
  SOFTFOCUS_INLINE void load(const QuadTriangles& triangles, std::size_t provoking,
                             std::size_t varyings) {
    any_large = false;
    std::array<VertexRows, 3> rows_of;
#pragma GCC unroll 3
    for (std::size_t vertex = 0; vertex < 3; ++vertex) {
#pragma GCC unroll 4
      for (std::size_t quad = 0; quad < kQuads; ++quad) {
        rows_of[vertex][quad] = triangles[quad]->vertices[vertex];
      }
      inverse_w[vertex] = spread<kVertexInverseW>(load_fours(rows_of[vertex].data(), 0));
    }
    for (std::size_t four = 0; four < (varyings + 3) / 4; ++four) {
      const Floats first = load_varyings(rows_of[0], four);
      fours[four].first = first;
      fours[four].to_second = load_varyings(rows_of[1], four) - first;
      fours[four].to_third = load_varyings(rows_of[2], four) - first;
      if constexpr (!kAllPerspective<kinds>) {
        fours[four].flat = load_varyings(rows_of[provoking], four);
      }
    }
    std::array<const float*, kQuads> numbers;
#pragma GCC unroll 4
    for (std::size_t quad = 0; quad < kQuads; ++quad) {
      numbers[quad] = reinterpret_cast<const float*>(triangles[quad]);
    }
    const Ints edges = as_ints(load_fours(numbers.data(), 0));
    const Ints columns = as_ints(load_fours(numbers.data(), 4));
    const Floats rows = load_fours(numbers.data(), 8);
    edge = {spread<0>(edges), spread<1>(edges), spread<2>(edges)};
    x_origin = spread<3>(edges);
    per_x = {spread<0>(columns), spread<1>(columns), spread<2>(columns)};
    y_origin = spread<3>(columns);
    per_y = {spread<0>(as_ints(rows)), spread<1>(as_ints(rows)), spread<2>(as_ints(rows))};
    inverse_area = spread<3>(rows);
    of_quads = &triangles;
    for (const LaneTriangle* t : triangles) any_large = any_large || t->large != nullptr;
    if (any_large) load_wide();
  }

  SOFTFOCUS_INLINE Weights weights(Ints x, Ints y) const {
    std::array<Floats, 3> l;
    const Ints dx = x - x_origin;
    const Ints dy = y - y_origin;
#pragma GCC unroll 3
    for (std::size_t i = 0; i < 3; ++i) {
      l[i] = to_floats(edge[i] + (dx * per_x[i] + dy * per_y[i]));
    }
    if (any_large) weigh_large(x, y, l);
#pragma GCC unroll 3
    for (std::size_t i = 0; i < 3; ++i) l[i] *= inverse_area;
    const Floats p0 = l[0] * inverse_w[0];
    const Floats p1 = l[1] * inverse_w[1];
    const Floats p2 = l[2] * inverse_w[2];
    const Floats reciprocal = 1.0f / ((p0 + p1) + p2);
    return {l[1], l[2], p1 * reciprocal, p2 * reciprocal};
  }

  // Edge functions of all quads, if 32 bits do not hold those of one.
  struct WideEdge {
    WideLanes at_origin, per_x, per_y;
  };
  std::array<WideEdge, 3> wide;
  bool any_huge;

  SOFTFOCUS_INLINE void load_wide() {
    any_huge = false;
    for (const LaneTriangle* t : *of_quads) {
      any_huge = any_huge || (t->large != nullptr && !t->large->fits_doubles);
    }
#pragma GCC unroll 3
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<double, kQuads> at_origin, along_x, along_y;
#pragma GCC unroll 4
      for (std::size_t quad = 0; quad < kQuads; ++quad) {
        const LaneTriangle& t = *(*of_quads)[quad];
        at_origin[quad] = t.large != nullptr ? t.large->edge[i] : t.edge[i];
        along_x[quad] = t.large != nullptr ? t.large->per_x[i] : t.per_x[i];
        along_y[quad] = t.large != nullptr ? t.large->per_y[i] : t.per_y[i];
      }
      wide[i] = {wide_repeat(at_origin), wide_repeat(along_x), wide_repeat(along_y)};
    }
  }

  SOFTFOCUS_INLINE void weigh_large(Ints x, Ints y, std::array<Floats, 3>& l) const {
    const WideLanes dx = widen(x - x_origin);
    const WideLanes dy = widen(y - y_origin);
#pragma GCC unroll 3
    for (std::size_t i = 0; i < 3; ++i) {
      l[i] = narrow(wide[i].at_origin + (dx * wide[i].per_x + dy * wide[i].per_y));
    }
    if (any_huge) weigh_huge(x, y, l);
  }

  void weigh_huge(const Ints& x, const Ints& y, std::array<Floats, 3>& l) const {
    for (int lane = 0; lane < kLanes; ++lane) {
      const LaneTriangle& t = *(*of_quads)[static_cast<std::size_t>(lane / kQuadPixels)];
      if (t.large == nullptr) continue;
#pragma GCC unroll 3
      for (std::size_t i = 0; i < 3; ++i) {
        l[i][lane] = static_cast<float>(edge_at(t.large->exact.edges[i], x[lane], y[lane]));
      }
    }
  }

  /// The values of varyings at pixels, up to a multiple of four.
  SOFTFOCUS_INLINE void values(const Weights& w, std::size_t varyings, Floats* to) const {
    const OfPixels second = of_pixels(w.perspective1);
    const OfPixels third = of_pixels(w.perspective2);
    for (std::size_t four = 0; four < (varyings + 3) / 4; ++four) {
      const Four& of = fours[four];
      OfPixels value;
#pragma GCC unroll 4
      for (std::size_t i = 0; i < kQuadPixels; ++i) {
        value[i] = (of.first + second[i] * of.to_second) + third[i] * of.to_third;
      }
      if constexpr (!kAllPerspective<kinds>) {
        const OfPixels linear2 = of_pixels(w.linear1);
        const OfPixels linear3 = of_pixels(w.linear2);
        const Mask linear = lanes_of_kind<kinds>(Interpolation::linear, four);
        const Mask flat = lanes_of_kind<kinds>(Interpolation::flat, four);
        for (std::size_t i = 0; i < kQuadPixels; ++i) {
          value[i] = select(
              linear, (of.first + linear2[i] * of.to_second) + linear3[i] * of.to_third, value[i]);
          value[i] = select(flat, of.flat, value[i]);
        }
      }
      transpose_fours(value[0], value[1], value[2], value[3]);
#pragma GCC unroll 4
      for (std::size_t i = 0; i < 4; ++i) to[4 * four + i] = value[i];
    }
  }
};

/// A pixel, and w there as 1 / (1 / w).
struct PlanePoint {
  Floats x, y, w;
};

/// Plane in lanes.
struct PlaneOfLanes {
  Floats at_origin, per_x, per_y;
};

/// PlaneInterpolator with PlanesFromOrigin in lanes, for varyings of these kinds.
template <const auto& kinds, Contraction contraction>
struct PlaneLanes {
  using Point = PlanePoint;
  PlaneOfLanes inverse_w{};
  std::array<PlaneOfLanes, (kinds.size() + 3) / 4> fours;  // a flat varying's value is at_origin

  SOFTFOCUS_INLINE void load(const QuadTriangles& triangles, std::size_t provoking,
                             std::size_t varyings) {
    std::array<VertexRows, 3> rows_of;
    std::array<Floats, 3> window;
#pragma GCC unroll 3
    for (std::size_t vertex = 0; vertex < 3; ++vertex) {
      // A clockwise triangle's vertices 1 and `other` change places.
      const std::size_t other = provoking == 0 ? 2 : 0;
      const std::size_t swapped = vertex == 1 ? other : vertex == other ? 1 : vertex;
#pragma GCC unroll 4
      for (std::size_t quad = 0; quad < kQuads; ++quad) {
        const LaneTriangle& t = *triangles[quad];
        rows_of[vertex][quad] = t.vertices[t.clockwise ? swapped : vertex];
      }
      window[vertex] = load_fours(rows_of[vertex].data(), 0);
    }
    const Floats x = spread<kVertexX>(window[0]);
    const Floats y = spread<kVertexY>(window[0]);
    const Floats dx01 = x - spread<kVertexX>(window[1]);
    const Floats dy01 = y - spread<kVertexY>(window[1]);
    const Floats dx20 = spread<kVertexX>(window[2]) - x;
    const Floats dy20 = spread<kVertexY>(window[2]) - y;
    const Floats one_over_area = 1.0f / (dx01 * dy20 - dx20 * dy01);
    const Slopes slopes{x - 0.5f,
                        y - 0.5f,
                        dx01 * one_over_area,
                        dy01 * one_over_area,
                        dx20 * one_over_area,
                        dy20 * one_over_area};
    const Floats w0 = spread<kVertexInverseW>(window[0]);
    const Floats w1 = spread<kVertexInverseW>(window[1]);
    const Floats w2 = spread<kVertexInverseW>(window[2]);
    inverse_w = slopes.plane(w0, w1, w2);
    for (std::size_t four = 0; four < (varyings + 3) / 4; ++four) {
      const Floats a0 = load_varyings(rows_of[0], four);
      const Floats a1 = load_varyings(rows_of[1], four);
      const Floats a2 = load_varyings(rows_of[2], four);
      if constexpr (kAllPerspective<kinds>) {
        fours[four] = slopes.plane(a0 * w0, a1 * w1, a2 * w2);
      } else {
        // Times 1: the number itself.
        const Mask perspective = lanes_of_kind<kinds>(Interpolation::perspective, four);
        const Floats one = splat(1.0f);
        fours[four] =
            slopes.plane(a0 * select(perspective, w0, one), a1 * select(perspective, w1, one),
                         a2 * select(perspective, w2, one));
        // What swapping put elsewhere: vertex 2 if that is provoking, else vertex 0, stays.
        fours[four].at_origin = select(lanes_of_kind<kinds>(Interpolation::flat, four),
                                       provoking == 0 ? a0 : a2, fours[four].at_origin);
      }
    }
  }

  SOFTFOCUS_INLINE PlanePoint weights(Ints x, Ints y) const {
    const Floats column = to_floats(x);
    const Floats row = to_floats(y);
    return {column, row, 1.0f / at(inverse_w, column, row)};
  }

  /// As BarycentricLanes.
  SOFTFOCUS_INLINE void values(const PlanePoint& point, std::size_t varyings, Floats* to) const {
    const OfPixels x = of_pixels(point.x), y = of_pixels(point.y), w = of_pixels(point.w);
    for (std::size_t four = 0; four < (varyings + 3) / 4; ++four) {
      OfPixels value;
#pragma GCC unroll 4
      for (std::size_t i = 0; i < kQuadPixels; ++i) {
        const Floats linear = at(fours[four], x[i], y[i]);
        value[i] = linear * w[i];
        if constexpr (!kAllPerspective<kinds>) {
          value[i] = select(lanes_of_kind<kinds>(Interpolation::linear, four), linear, value[i]);
          value[i] = select(lanes_of_kind<kinds>(Interpolation::flat, four), fours[four].at_origin,
                            value[i]);
        }
      }
      transpose_fours(value[0], value[1], value[2], value[3]);
#pragma GCC unroll 4
      for (std::size_t i = 0; i < 4; ++i) to[4 * four + i] = value[i];
    }
  }

 private:
  struct Slopes {
    Floats x0, y0, dx01_over_area, dy01_over_area, dx20_over_area, dy20_over_area;

    SOFTFOCUS_INLINE PlaneOfLanes plane(Floats a0, Floats a1, Floats a2) const {
      const Floats da01 = a0 - a1;
      const Floats da20 = a2 - a0;
      const Floats per_x = da01 * dy20_over_area - da20 * dy01_over_area;
      const Floats per_y = da20 * dx01_over_area - da01 * dx20_over_area;
      return {a0 - (per_x * x0 + per_y * y0), per_x, per_y};
    }
  };

  SOFTFOCUS_INLINE static Floats at(const PlaneOfLanes& plane, Floats x, Floats y) {
    return multiply_add(plane.per_y, y, multiply_add(plane.per_x, x, plane.at_origin));
  }
  SOFTFOCUS_INLINE static Floats multiply_add(Floats a, Floats b, Floats c) {
    if constexpr (contraction == Contraction::fused) return fused_multiply_add(a, b, c);
    return a * b + c;
  }
};

}  // namespace
