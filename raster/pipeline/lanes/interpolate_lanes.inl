// Varyings at the pixels of kQuads quads. Each quad shows a triangle of its own. The scalar form
// is interpolate.h and planes.h.

namespace {

/// The triangle that each quad shows.
using QuadTriangles = std::array<const LaneTriangle*, kQuads>;

template <const auto& kinds>
inline constexpr bool kAllPerspective = std::count(kinds.begin(), kinds.end(),
                                                   Interpolation::perspective) == std::ssize(kinds);

/// The rows of one vertex of each quad's triangle.
using VertexRows = std::array<const float*, kQuads>;

/// Room for N varyings, which are loaded four by four.
template <std::size_t N>
using VaryingLanes = std::array<Floats, (N + 3) / 4 * 4>;

SOFTFOCUS_INLINE void spread_four(Floats four, Floats* to) {
  to[0] = spread<0>(four);
  to[1] = spread<1>(four);
  to[2] = spread<2>(four);
  to[3] = spread<3>(four);
}

/// The varyings from `i` on that lie in the same four lanes of a vertex's row.
SOFTFOCUS_INLINE void load_four_varyings(const VertexRows& rows, std::size_t i, Floats* varyings) {
  spread_four(load_fours(rows.data(), kVertexVaryings + i), varyings);
}

/// What a triangle's varyings are loaded with. `varyings`: how many the draw has.
struct LoadJob {
  std::size_t provoking;
  std::size_t varyings;
  Contraction contraction;  ///< of planes
  float centre = 0.0f;      ///< PlanesFromOrigin's
};

/// The weights of vertices 1 and 2 at a pixel.
struct Weights {
  Floats linear1, linear2, perspective1, perspective2;
};

/// As BarycentricInterpolator. Draws with `usual` varyings are the quickest.
template <const auto& kinds, std::size_t usual = kinds.size()>
struct BarycentricLanes {
  using Point = Weights;
  static constexpr std::size_t N = kinds.size();
  /// At vertex 0, the differences of the others to it, and at the provoking vertex.
  VaryingLanes<N> first, to_second, to_third, flat;
  std::array<Floats, 3> inverse_w{};
  std::array<Ints, 3> edge{}, slopes{};
  Ints origin{};
  Floats inverse_area{};
  const QuadTriangles* of_quads = nullptr;
  bool any_large = false;

  /// Keeps a pointer to the triangles.
  SOFTFOCUS_INLINE void load(const QuadTriangles& triangles, const LoadJob& job) {
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
    if (N == usual || job.varyings == usual) {
#pragma GCC unroll 4
      for (std::size_t i = 0; i < usual; i += 4) load_four(rows_of, i, job.provoking);
    } else {
#pragma GCC unroll 4
      for (std::size_t i = 0; i < N; i += 4) {
        if (i >= job.varyings) break;
        load_four(rows_of, i, job.provoking);
      }
    }
    std::array<const float*, kQuads> numbers;
#pragma GCC unroll 4
    for (std::size_t quad = 0; quad < kQuads; ++quad) {
      numbers[quad] = reinterpret_cast<const float*>(triangles[quad]);
    }
    const Ints edges = as_ints(load_fours(numbers.data(), 0));
    const Ints packed = as_ints(load_fours(numbers.data(), 4));
    edge = {spread<0>(edges), spread<1>(edges), spread<2>(edges)};
    origin = spread<3>(edges);
    slopes = {spread<0>(packed), spread<1>(packed), spread<2>(packed)};
    inverse_area = as_floats(as_bits(spread<3>(packed)));
    of_quads = &triangles;
    for (const LaneTriangle* t : triangles) any_large = any_large || t->is_large;
    if (any_large) load_wide();
  }

  /// `pixels`: packed_pixel() of the target.
  SOFTFOCUS_INLINE Weights weights(Ints pixels) const {
    std::array<Floats, 3> l;
    const Ints steps = subtract_pairs(pixels, origin);
#pragma GCC unroll 3
    for (std::size_t i = 0; i < 3; ++i) {
      l[i] = to_floats(edge[i] + (multiply_add_pairs(steps, slopes[i]) << 8));
    }
    if (any_large) weigh_large(pixels & 0xFFFF, pixels >> 16, Ints{}, l);
    return weights_of(l);
  }

  /// At places from the pixels' centres, packed_pixel() in 1/256 pixel.
  SOFTFOCUS_INLINE Weights weights_at(Ints pixels, Ints shift) const {
    std::array<Floats, 3> l;
    const Ints steps = subtract_pairs(pixels, origin);
#pragma GCC unroll 3
    for (std::size_t i = 0; i < 3; ++i) {
      l[i] = to_floats(edge[i] + (multiply_add_pairs(steps, slopes[i]) << 8) +
                       multiply_add_pairs(shift, slopes[i]));
    }
    if (any_large) weigh_large(pixels & 0xFFFF, pixels >> 16, shift, l);
    return weights_of(l);
  }

  SOFTFOCUS_INLINE Weights weights_of(std::array<Floats, 3> l) const {
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
  bool any_huge = false;

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
        along_x[quad] = t.large != nullptr ? t.large->per_x[i] : slope_x(t.slopes[i]);
        along_y[quad] = t.large != nullptr ? t.large->per_y[i] : slope_y(t.slopes[i]);
      }
      wide[i] = {wide_repeat(at_origin), wide_repeat(along_x), wide_repeat(along_y)};
    }
  }

  SOFTFOCUS_INLINE void weigh_large(Ints x, Ints y, Ints shift, std::array<Floats, 3>& l) const {
    // Edge functions are multiples of 256 along a pixel, so that products with 1/256 are exact.
    const WideLanes part = wide_splat(1.0 / 256.0);
    const WideLanes dx = widen(x - (origin & 0xFFFF)) + widen(shift << 16 >> 16) * part;
    const WideLanes dy = widen(y - (origin >> 16)) + widen(shift >> 16) * part;
#pragma GCC unroll 3
    for (std::size_t i = 0; i < 3; ++i) {
      l[i] = narrow(wide[i].at_origin + (dx * wide[i].per_x + dy * wide[i].per_y));
    }
    if (any_huge) weigh_huge(x, y, shift, l);
  }

  void weigh_huge(const Ints& x, const Ints& y, const Ints& shift, std::array<Floats, 3>& l) const {
    for (int lane = 0; lane < kLanes; ++lane) {
      const LaneTriangle& t = *(*of_quads)[static_cast<std::size_t>(lane / kQuadPixels)];
      if (t.large == nullptr) continue;
#pragma GCC unroll 3
      for (std::size_t i = 0; i < 3; ++i) {
        const glm::ivec2 place{static_cast<std::int16_t>(shift[lane]), shift[lane] >> 16};
        l[i][lane] = static_cast<float>(edge_at(t.large->exact.edges[i], x[lane], y[lane], place));
      }
    }
  }

  SOFTFOCUS_INLINE Floats value(std::size_t varying, const Weights& w) const {
    switch (kinds[varying]) {
      case Interpolation::perspective: return blend(varying, w.perspective1, w.perspective2);
      case Interpolation::linear: return blend(varying, w.linear1, w.linear2);
      case Interpolation::flat: break;
    }
    return flat[varying];
  }

 private:
  SOFTFOCUS_INLINE void load_four(const std::array<VertexRows, 3>& rows_of, std::size_t i,
                                  std::size_t provoking) {
    // Subtracted before they are spread: one step for four.
    const Floats at_first = load_fours(rows_of[0].data(), kVertexVaryings + i);
    const Floats at_third = load_fours(rows_of[2].data(), kVertexVaryings + i);
    spread_four(at_first, &first[i]);
    spread_four(load_fours(rows_of[1].data(), kVertexVaryings + i) - at_first, &to_second[i]);
    spread_four(at_third - at_first, &to_third[i]);
    if constexpr (!kAllPerspective<kinds>) {
      spread_four(provoking == 0 ? at_first : at_third, &flat[i]);
    }
  }
  SOFTFOCUS_INLINE Floats blend(std::size_t varying, Floats weight1, Floats weight2) const {
    return (first[varying] + weight1 * to_second[varying]) + weight2 * to_third[varying];
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
template <const auto& kinds>
struct PlaneLanes {
  using Point = PlanePoint;
  static constexpr std::size_t N = kinds.size();
  bool fused = false;
  float centre = 0.0f;
  PlaneOfLanes inverse_w{};
  std::array<PlaneOfLanes, N> planes;  // a flat varying's value is at_origin

  SOFTFOCUS_INLINE void load(const QuadTriangles& triangles, const LoadJob& job) {
    fused = job.contraction == Contraction::fused;
    centre = job.centre;
    const std::size_t provoking = job.provoking;
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
    const Slopes slopes{x - (0.5f - centre),  y - (0.5f - centre),  dx01 * one_over_area,
                        dy01 * one_over_area, dx20 * one_over_area, dy20 * one_over_area};
    const Floats w0 = spread<kVertexInverseW>(window[0]);
    const Floats w1 = spread<kVertexInverseW>(window[1]);
    const Floats w2 = spread<kVertexInverseW>(window[2]);
    inverse_w = slopes.plane(w0, w1, w2);
    VaryingLanes<N> at_first, at_second, at_third;
#pragma GCC unroll 4
    for (std::size_t i = 0; i < N; i += 4) {
      if (i >= job.varyings) break;
      load_four_varyings(rows_of[0], i, &at_first[i]);
      load_four_varyings(rows_of[1], i, &at_second[i]);
      load_four_varyings(rows_of[2], i, &at_third[i]);
    }
    for (std::size_t i = 0; i < std::min(N, job.varyings); ++i) {
      const Floats a0 = at_first[i], a1 = at_second[i], a2 = at_third[i];
      switch (kinds[i]) {
        case Interpolation::perspective: planes[i] = slopes.plane(a0 * w0, a1 * w1, a2 * w2); break;
        case Interpolation::linear: planes[i] = slopes.plane(a0, a1, a2); break;
        case Interpolation::flat:
          // What swapping put elsewhere: vertex 2 if that is provoking, else vertex 0, stays.
          planes[i].at_origin = provoking == 0 ? a0 : a2;
          break;
      }
    }
  }

  SOFTFOCUS_INLINE PlanePoint weights(Ints pixels) const {
    const Floats column = to_floats(pixels & 0xFFFF) + centre;
    const Floats row = to_floats(pixels >> 16) + centre;
    return {column, row, 1.0f / at(inverse_w, column, row)};
  }

  /// As BarycentricLanes::weights_at(); w is the centre's, as llvmpipe has it.
  SOFTFOCUS_INLINE PlanePoint weights_at(Ints pixels, Ints shift) const {
    PlanePoint point = weights(pixels);
    const auto from_corner = [&](Ints pixel, Ints along) {
      return to_floats(pixel) + (centre + to_floats(along) * (1.0f / 256.0f));
    };
    point.x = from_corner(pixels & 0xFFFF, shift << 16 >> 16);
    point.y = from_corner(pixels >> 16, shift >> 16);
    return point;
  }

  SOFTFOCUS_INLINE Floats value(std::size_t varying, const PlanePoint& point) const {
    const PlaneOfLanes& plane = planes[varying];
    if (kinds[varying] == Interpolation::flat) return plane.at_origin;
    const Floats value = at(plane, point.x, point.y);
    return kinds[varying] == Interpolation::linear ? value : value * point.w;
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

  SOFTFOCUS_INLINE Floats at(const PlaneOfLanes& plane, Floats x, Floats y) const {
    if (fused) {
      return fused_multiply_add(plane.per_y, y,
                                fused_multiply_add(plane.per_x, x, plane.at_origin));
    }
    return plane.per_y * y + (plane.per_x * x + plane.at_origin);
  }
};

}  // namespace
