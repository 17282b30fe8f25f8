// The fragment stage over what is seen of a draw in a tile, and the vertex stage.
//
// A vertex stage in lanes has kVaryings, and is callable as
//     void operator()(Ints index, std::array<Floats, 4>& position,
//                     std::array<Floats, kVaryings>& varyings) const
// A fragment stage in lanes has kInterpolation and kNeedsDerivatives as the scalar one, and
//     template <class Fragment> std::array<Floats, 4> operator()(const Fragment&) const
// where Fragment is a FragmentLanes: what the stage does not ask for is not computed.

namespace {

template <class Stage, class Interpolator, class Point>
struct FragmentLanes {
  const Interpolator& triangles;
  std::size_t provoking;
  Mask front_facing;
  Point here, corner, right, below;

  SOFTFOCUS_INLINE Floats varying(std::size_t i) const { return at(i, here); }
  SOFTFOCUS_INLINE Floats ddx(std::size_t i) const { return at(i, right) - at(i, corner); }
  SOFTFOCUS_INLINE Floats ddy(std::size_t i) const { return at(i, below) - at(i, corner); }

  SOFTFOCUS_INLINE Floats at(std::size_t i, const Point& point) const {
    return triangles.value(i, Stage::kInterpolation[i], provoking, point);
  }
};

// Fragments of a part of a block, which has whole 2x2 pixels. `corners` are those that
// differences are taken between: in the first quarter of the lanes the 2x2 pixels' upper
// left ones, in the second their right neighbours, in the third the lower.
template <class Stage, class Interpolator, class Point>
struct BlockFragmentLanes {
  const Interpolator& triangles;
  std::size_t provoking;
  Mask front_facing;
  Point here, corners;

  SOFTFOCUS_INLINE Floats varying(std::size_t i) const { return at(i, here); }
  SOFTFOCUS_INLINE Floats ddx(std::size_t i) const {
    const Floats values = at(i, corners);
    const Ints quad = quad_of_lane();
    return pick(values, quad + kLanes / 4) - pick(values, quad);
  }
  SOFTFOCUS_INLINE Floats ddy(std::size_t i) const {
    const Floats values = at(i, corners);
    const Ints quad = quad_of_lane();
    return pick(values, quad + kLanes / 2) - pick(values, quad);
  }

  SOFTFOCUS_INLINE Floats at(std::size_t i, const Point& point) const {
    return triangles.value(i, Stage::kInterpolation[i], provoking, point);
  }
};

// The pixels of a tile that show a run, as id - first_id above kPixelBits of pixel number.
inline constexpr int kPixelBits = 12;
static_assert(kTilePixels == 1 << kPixelBits);

struct SeenPixels {
  std::array<std::int32_t, kTilePixels + kLanes> entries;
  int count = 0;
  /// Whole vectors of one triangle, by their first pixel.
  std::array<std::int32_t, kTilePixels / kLanes> whole;
  int whole_count = 0;
};

// Lists the pixels, and fills the last vector up with the last of them.
SOFTFOCUS_INLINE void list_seen(const VisibilityTile& tile, const VisibleRun& run,
                                SeenPixels& seen) {
  int x_begin = tile.area.x_end, y_begin = tile.area.y_end;
  int x_end = tile.area.x_begin, y_end = tile.area.y_begin;
  for (std::int32_t id = run.first_id; id < run.end_id; ++id) {
    const auto& bounds = tile.triangles[static_cast<std::size_t>(id - 1)]->bounds;
    x_begin = std::min<int>(x_begin, bounds[0]);
    y_begin = std::min<int>(y_begin, bounds[1]);
    x_end = std::max<int>(x_end, bounds[2]);
    y_end = std::max<int>(y_end, bounds[3]);
  }
  x_begin = std::max(x_begin, tile.area.x_begin) - tile.area.x_begin;
  y_begin = std::max(y_begin, tile.area.y_begin) - tile.area.y_begin;
  x_end = std::min(x_end, tile.area.x_end) - tile.area.x_begin;
  y_end = std::min(y_end, tile.area.y_end) - tile.area.y_begin;

  for (int block_y = y_begin / kBlockSize; block_y * kBlockSize < y_end; ++block_y) {
    for (int block_x = x_begin / kBlockSize; block_x * kBlockSize < x_end; ++block_x) {
      const int block = block_y * kTileBlocks + block_x;
      for (int part = 0; part < kBlockParts; ++part) {
        const int pixel = block * kBlockPixels + part * kLanes;
        const Ints ids = load(&tile.ids[static_cast<std::size_t>(pixel)]);
        Mask mask = (ids >= run.first_id) & (ids < run.end_id);
        const Ints x = block_x * kBlockSize + lane_x();
        const Ints y = block_y * kBlockSize + part * kPartRows + lane_y();
        mask &= (x < x_end) & (y < y_end);
        if (!any(mask)) continue;
        const Ints entries = (ids - run.first_id) << kPixelBits | (pixel + lane_numbers());
        if (all(mask & (ids == ids[0]))) {
          seen.whole[static_cast<std::size_t>(seen.whole_count++)] = entries[0];
        } else {
          seen.count +=
              compress_store(&seen.entries[static_cast<std::size_t>(seen.count)], entries, mask);
        }
      }
    }
  }
  if (seen.count != 0) {
    const auto count = static_cast<std::size_t>(seen.count);
    store(&seen.entries[count], splat(seen.entries[count - 1]));
  }
}

// Asks for the vertices of the next vector's triangles, which were written long ago.
SOFTFOCUS_INLINE void fetch_vertices(const LaneTriangle* const* triangles,
                                     const std::int32_t* entries) {
  std::int32_t last = -1;
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::int32_t triangle = entries[lane] >> kPixelBits;
    if (triangle == last) continue;
    last = triangle;
    for (const float* row : triangles[triangle]->vertices) __builtin_prefetch(row);
  }
}

SOFTFOCUS_INLINE HalfTexels to_half_texels(const std::array<Floats, 4>& colour,
                                           HalfRounding rounding) {
  if (rounding == HalfRounding::nearest_even) {
    constexpr auto kNearest = HalfRounding::nearest_even;
    return {float_to_half<kNearest>(colour[0]), float_to_half<kNearest>(colour[1]),
            float_to_half<kNearest>(colour[2]), float_to_half<kNearest>(colour[3])};
  }
  constexpr auto kCut = HalfRounding::toward_zero;
  return {float_to_half<kCut>(colour[0]), float_to_half<kCut>(colour[1]),
          float_to_half<kCut>(colour[2]), float_to_half<kCut>(colour[3])};
}

SOFTFOCUS_INLINE void store_texels(const FragmentJob& job, const VisibilityTile& tile,
                                   const std::int32_t* entries, int count,
                                   const std::array<Floats, 4>& colour) {
  alignas(64) std::array<std::uint16_t, 4 * kLanes> halves;
  store_half_texels(halves.data(), to_half_texels(colour, job.profile->half_store));
  std::byte* first = job.target->bytes.data() +
                     static_cast<std::size_t>(tile.area.y_begin) * job.target->stride_bytes +
                     static_cast<std::size_t>(tile.area.x_begin) * sizeof(std::uint64_t);
  for (int lane = 0; lane < count; ++lane) {
    const auto pixel = static_cast<std::uint32_t>(entries[lane]);
    const std::uint32_t x = (pixel >> 4 & (kTileBlocks - 1)) * kBlockSize + (pixel & 3);
    const std::uint32_t y =
        (pixel & (kTilePixels - 1)) / (kBlockPixels * kTileBlocks) * kBlockSize + (pixel >> 2 & 3);
    std::memcpy(first + y * job.target->stride_bytes + x * sizeof(std::uint64_t),
                &halves[static_cast<std::size_t>(4 * lane)], sizeof(std::uint64_t));
  }
}

// Rows of a block, of which a vector holds a whole part.
SOFTFOCUS_INLINE void store_rows(const FragmentJob& job, int x, int y,
                                 const std::array<Floats, 4>& colour) {
  alignas(64) std::array<std::uint16_t, 4 * kLanes> halves;
  store_half_texels(halves.data(), to_half_texels(colour, job.profile->half_store));
  constexpr std::size_t kRowBytes = kBlockSize * sizeof(std::uint64_t);
  std::byte* to = job.target->bytes.data() +
                  static_cast<std::size_t>(y) * job.target->stride_bytes +
                  static_cast<std::size_t>(x) * sizeof(std::uint64_t);
  for (std::size_t row = 0; row < kPartRows; ++row, to += job.target->stride_bytes) {
    std::memcpy(to, &halves[row * 4 * kBlockSize], kRowBytes);
  }
}

// A vector of pixels by what triangles they show, as they come.
template <class Interpolator, class Stage>
SOFTFOCUS_INLINE void shade_mixed_lanes(const Stage& stage, const FragmentJob& job,
                                        const VisibilityTile& tile,
                                        const LaneTriangle* const* triangles,
                                        const SeenPixels& seen) {
  Interpolator interpolator;
  for (int i = 0; i < seen.count; i += kLanes) {
    const std::int32_t* list = &seen.entries[static_cast<std::size_t>(i)];
    const Ints entries = load(list);
    if (i + 2 * kLanes <= seen.count) fetch_vertices(triangles, list + kLanes);
    const Ints pixel = entries & (kTilePixels - 1);
    const Ints triangle = entries >> kPixelBits;
    const Ints block = pixel >> 4;
    const Ints x = tile.area.x_begin + (block & (kTileBlocks - 1)) * kBlockSize + (pixel & 3);
    const Ints y = tile.area.y_begin + (block >> 4) * kBlockSize + (pixel >> 2 & 3);
    static_assert(kTileBlocks == 16);

    LaneSources sources;
    for (unsigned rest = kAllLaneBits; rest != 0;) {
      const Mask mask = triangle == triangle[__builtin_ctz(rest)];
      const LaneTriangle& t = *triangles[list[__builtin_ctz(rest)] >> kPixelBits];
      add_source(sources, t, mask, Interpolator::rows(t, job.provoking));
      rest &= ~lane_bits(mask);
    }
    interpolator.load(sources);

    const TrianglesOfLanes of_lanes{triangles, triangle};
    using Point = decltype(interpolator.weights(x, y, of_lanes));
    FragmentLanes<Stage, Interpolator, Point> fragment{
        interpolator,
        job.provoking,
        of_sources(sources, &LaneTriangle::is_front_facing) != 0,
        interpolator.weights(x, y, of_lanes),
        {},
        {},
        {}};
    if constexpr (Stage::kNeedsDerivatives) {
      const Ints x0 = x & ~1;
      const Ints y0 = y & ~1;
      fragment.corner = interpolator.weights(x0, y0, of_lanes);
      fragment.right = interpolator.weights(x0 + 1, y0, of_lanes);
      fragment.below = interpolator.weights(x0, y0 + 1, of_lanes);
    }
    store_texels(job, tile, list, std::min(seen.count - i, kLanes), stage(fragment));
  }
}

// Vectors that one triangle fills: its constants are set once for all that follow each
// other, and differences are taken once for each 2x2 pixels.
template <class Interpolator, class Stage>
SOFTFOCUS_INLINE void shade_whole_lanes(const Stage& stage, const FragmentJob& job,
                                        const VisibilityTile& tile,
                                        const LaneTriangle* const* triangles,
                                        const SeenPixels& seen) {
  Interpolator interpolator;
  std::int32_t loaded = -1;
  for (int i = 0; i < seen.whole_count; ++i) {
    const std::int32_t entry = seen.whole[static_cast<std::size_t>(i)];
    const std::int32_t number = entry >> kPixelBits;
    const LaneTriangle& t = *triangles[number];
    if (number != loaded) {
      LaneSources sources;
      add_source(sources, t, ~Mask{}, Interpolator::rows(t, job.provoking));
      interpolator.load(sources);
      loaded = number;
    }
    const std::int32_t block = (entry & (kTilePixels - 1)) / kBlockPixels;
    const int left = tile.area.x_begin + block % kTileBlocks * kBlockSize;
    const int top = tile.area.y_begin + block / kTileBlocks * kBlockSize + (entry >> 2 & 3);
    const Ints x = left + lane_x();
    const Ints y = top + lane_y();

    const TrianglesOfLanes of_lanes{triangles, splat(number)};
    using Point = decltype(interpolator.weights(x, y, of_lanes));
    if constexpr (Stage::kNeedsDerivatives && kLanes >= 8) {
      const BlockFragmentLanes<Stage, Interpolator, Point> fragment{
          interpolator, job.provoking, splat(-t.is_front_facing),
          interpolator.weights(x, y, of_lanes),
          interpolator.weights(left + block_corner_x(), top + block_corner_y(), of_lanes)};
      store_rows(job, left, top, stage(fragment));
    } else {
      FragmentLanes<Stage, Interpolator, Point> fragment{interpolator,
                                                         job.provoking,
                                                         splat(-t.is_front_facing),
                                                         interpolator.weights(x, y, of_lanes),
                                                         {},
                                                         {},
                                                         {}};
      if constexpr (Stage::kNeedsDerivatives) {
        const Ints x0 = x & ~1;
        const Ints y0 = y & ~1;
        fragment.corner = interpolator.weights(x0, y0, of_lanes);
        fragment.right = interpolator.weights(x0 + 1, y0, of_lanes);
        fragment.below = interpolator.weights(x0, y0 + 1, of_lanes);
      }
      store_rows(job, left, top, stage(fragment));
    }
  }
}

template <class Interpolator, class Stage>
void shade_seen(const Stage& stage, const FragmentJob& job, const VisibilityTile& tile,
                const VisibleRun& run) {
  SeenPixels seen;
  list_seen(tile, run, seen);
  const LaneTriangle* const* triangles =
      &tile.triangles[static_cast<std::size_t>(run.first_id - 1)];
  shade_whole_lanes<Interpolator>(stage, job, tile, triangles, seen);
  shade_mixed_lanes<Interpolator>(stage, job, tile, triangles, seen);
}

template <class Stage>
void shade_fragments(const Stage& stage, const FragmentJob& job, const VisibilityTile& tile,
                     const VisibleRun& run) {
  constexpr std::size_t N = Stage::kInterpolation.size();
  if (job.profile->attributes == AttributeSetup::exact_barycentric) {
    shade_seen<BarycentricLanes<N>>(stage, job, tile, run);
  } else if (job.profile->interpolation == Contraction::fused) {
    shade_seen<PlaneLanes<N, Contraction::fused>>(stage, job, tile, run);
  } else {
    shade_seen<PlaneLanes<N, Contraction::unfused>>(stage, job, tile, run);
  }
}

SOFTFOCUS_INLINE Mask is_finite(Floats v) { return (as_bits(v) & 0x7F800000u) != 0x7F800000u; }

// As clip_code().
SOFTFOCUS_INLINE Ints clip_codes(const std::array<Floats, 4>& position, float guard_band) {
  const Floats edge = guard_band * position[3];
  const std::array<Floats, 6> distances{edge - position[0],        edge + position[0],
                                        edge - position[1],        edge + position[1],
                                        position[3] + position[2], position[3] - position[2]};
  Ints codes{};
  for (std::size_t plane = 0; plane < 6; ++plane) {
    codes |= (distances[plane] < 0.0f) & splat(1 << plane);
  }
  const Mask finite = is_finite(position[0]) & is_finite(position[1]) & is_finite(position[2]) &
                      is_finite(position[3]);
  return select(finite, codes, splat(static_cast<std::int32_t>(kNotFinite)));
}

SOFTFOCUS_INLINE Floats to_window_lanes(Floats ndc, float half_size, Contraction contraction) {
  const Floats half = splat(half_size);
  return contraction == Contraction::fused ? fused_multiply_add(ndc, half, half)
                                           : ndc * half + half;
}

SOFTFOCUS_INLINE Ints snapped(Floats window, Mask drawable, int bits) {
  const Floats steps = nearest((window - 0.5f) * static_cast<float>(1 << bits));
  return truncate(select(drawable, steps, splat(0.0f))) << (kSubpixelBits - bits);
}

template <class Stage>
void shade_vertices(const Stage& stage, const VertexJob& job) {
  constexpr std::size_t kQuantities = kVertexVaryings + Stage::kVaryings;
  const Profile& profile = *job.profile;
  const float half_width = static_cast<float>(job.width) * 0.5f;
  const float half_height = static_cast<float>(job.height) * 0.5f;
  for (std::uint32_t begin = job.begin; begin < job.end; begin += kLanes) {
    // Lanes past the last vertex do it once more; there is room for them.
    const Ints index = smaller(static_cast<std::int32_t>(begin) + lane_numbers(),
                               splat(static_cast<std::int32_t>(job.end) - 1));
    std::array<Floats, 4> position;
    std::array<Floats, Stage::kVaryings> varyings;
    stage(index, position, varyings);

    // As to_window() and setup.cpp's is_drawable().
    const Floats inverse_w = 1.0f / position[3];
    const Floats x = to_window_lanes(position[0] * inverse_w, half_width, profile.viewport);
    const Floats y = to_window_lanes(position[1] * inverse_w, half_height, profile.viewport);
    const Floats depth = to_window_lanes(position[2] * inverse_w, 0.5f, profile.viewport);
    const Mask drawable = (absolute(x) < kLargestPosition) & (absolute(y) < kLargestPosition) &
                          is_finite(depth) & is_finite(inverse_w) & (inverse_w > 0.0f);
    const Ints codes = clip_codes(position, profile.guard_band) |
                       (~drawable & static_cast<std::int32_t>(kNotDrawable));
    store(job.store.codes + begin, codes);
    store(job.store.snapped_x + begin, snapped(x, drawable, profile.subpixel_bits));
    store(job.store.snapped_y + begin, snapped(y, drawable, profile.subpixel_bits));

    alignas(64) std::array<std::array<float, kLanes>, kQuantities> columns;
    store(columns[kVertexX].data(), x);
    store(columns[kVertexY].data(), y);
    store(columns[kVertexDepth].data(), depth);
    store(columns[kVertexInverseW].data(), inverse_w);
    for (std::size_t i = 0; i < Stage::kVaryings; ++i) {
      store(columns[kVertexVaryings + i].data(), varyings[i]);
    }
    float* row = job.store.rows + begin * job.store.stride;
    for (std::size_t lane = 0; lane < kLanes; ++lane, row += job.store.stride) {
      for (std::size_t k = 0; k < kQuantities; ++k) row[k] = columns[k][lane];
    }
  }
}

}  // namespace
