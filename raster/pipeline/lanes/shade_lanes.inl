// The fragment stage, over the pixels of a tile that show a draw.
//
// A fragment stage in lanes has two steps, the first on quads, the second on the pixels that are
// seen:
//     static constexpr auto kInterpolation   // as the scalar stage's
//     std::size_t varying_count() const      // as there
//     static constexpr std::size_t kInputs   // numbers that go from step to step
//     template <class Quads, class Put> void inputs(const Quads&, const Put& put) const
//     void shade(const FragmentBatch<kInputs>&, std::array<Floats, 4>* colours) const
// `inputs` gets QuadFragments and calls put(i, Floats) for each input. Each step takes many
// vectors: while one waits for a long chain of operations, or for memory, the CPU works on the
// others, which it could not see past a whole fragment stage.

namespace {

/// Quads of 2x2 pixels, each of one triangle.
template <class Interpolator>
struct QuadFragments {
  const Interpolator& interpolator;
  typename Interpolator::Point point;
  const QuadTriangles& of_quads;

  SOFTFOCUS_INLINE Floats varying(std::size_t i) const { return interpolator.value(i, point); }
  // Along the quad's upper row and left column.
  SOFTFOCUS_INLINE Floats ddx(std::size_t i) const {
    const Floats values = varying(i);
    return spread<1>(values) - spread<0>(values);
  }
  SOFTFOCUS_INLINE Floats ddy(std::size_t i) const {
    const Floats values = varying(i);
    return spread<2>(values) - spread<0>(values);
  }
  SOFTFOCUS_INLINE Mask front_facing() const {
    std::int32_t lanes = 0;
    for (std::size_t quad = 0; quad < kQuads; ++quad) {
      lanes |= of_quads[quad]->front_facing ? 0xF << (quad * kQuadPixels) : 0;
    }
    return (lanes >> lane_numbers() & 1) != 0;
  }
};

/// Pixels between the two steps.
template <std::size_t kInputs>
struct FragmentBatch {
  static constexpr int kMost = 8 * kLanes;
  alignas(64) std::array<std::array<float, kMost>, kInputs> inputs;
  alignas(64) std::array<std::int32_t, kMost> offsets;  ///< in bytes from the tile's first pixel
  int count = 0;

  SOFTFOCUS_INLINE int vectors() const { return (count + kLanes - 1) / kLanes; }
  SOFTFOCUS_INLINE Floats input(std::size_t i, int vector) const {
    return load(&inputs[i][static_cast<std::size_t>(vector * kLanes)]);
  }
  SOFTFOCUS_INLINE bool has_room() const { return count <= kMost - kLanes; }

  /// Stores whole vectors from a place on.
  struct PutAll {
    float* first;
    SOFTFOCUS_INLINE void operator()(std::size_t i, Floats v) const { store(first + i * kMost, v); }
  };
  /// Packs the seen lanes first.
  struct PutSeen {
    float* first;
    const Compression& kept;
    SOFTFOCUS_INLINE void operator()(std::size_t i, Floats v) const {
      store(first + i * kMost, compress(v, kept));
    }
  };

  /// Appends the pixels of the mask.
  template <class Stage, class Quads>
  SOFTFOCUS_INLINE void append(const Stage& stage, const Quads& fragments, Ints pixel_offsets,
                               Mask seen) {
    const auto at = static_cast<std::size_t>(count);
    const unsigned bits = lane_bits(seen);
    if (bits == kAllLaneBits) {
      stage.inputs(fragments, PutAll{&inputs[0][at]});
      store(&offsets[at], pixel_offsets);
    } else {
      const Compression kept = compression(seen);
      stage.inputs(fragments, PutSeen{&inputs[0][at], kept});
      store(&offsets[at], compress(pixel_offsets, kept));
    }
    count += __builtin_popcount(bits);
  }
  /// Fills the last vector up with its first pixel.
  SOFTFOCUS_INLINE void fill_up() {
    const int last = (vectors() - 1) * kLanes;
    const Mask present = first_lanes(count - last);
    for (std::size_t i = 0; i < kInputs; ++i) {
      float* from = &inputs[i][static_cast<std::size_t>(last)];
      store(from, select(present, load(from), splat(from[0])));
    }
    std::int32_t* from = &offsets[static_cast<std::size_t>(last)];
    store(from, select(present, load(from), splat(from[0])));
  }
};

// A quad that shows a triangle of a run, in 32 bits. From the top: the triangle's id less the
// run's first; the quad's row and its column; a bit for each pixel that shows the triangle.
inline constexpr int kColumnBits = 5;
inline constexpr int kQuadBits = 2 * kColumnBits;
static_assert(kTileSize / 2 == 1 << kColumnBits);
static_assert(kMostVisible >> (32 - kQuadBits - kQuadPixels) == 0);

// Vertices are prefetched this many vectors ahead: a few hundred cycles.
inline constexpr int kQuadsAhead = 3;

// Triangle after triangle, so that each is loaded once.
struct SeenQuads {
  static constexpr std::size_t kRoom = kTilePixels + (kQuadsAhead + 1) * kLanes;
  std::array<std::uint32_t, kRoom> entries;
  // Of FurtherQuad: where its sample's texels are, in bytes from sample 0's, and its shift.
  std::array<std::int32_t, kRoom> sample_offsets, shifts;
  int count = 0;
};

SOFTFOCUS_INLINE std::uint32_t triangle_of(std::uint32_t entry) {
  return entry >> (kQuadBits + kQuadPixels);
}

// The bits of a part's pixels with x < x_end and y < y_end, counted from the tile's first. `place`
// is that of the part's first pixel.
[[gnu::noinline]] inline unsigned pixels_before(std::size_t place, int x_end, int y_end) {
  const auto block = static_cast<int>(place / kBlockPixels);
  const auto part = static_cast<int>(place % kBlockPixels) / kLanes;
  const int x = block % kTileBlocks * kBlockSize + part * kPartColumns % kBlockSize;
  const int y = block / kTileBlocks * kBlockSize + part * kPartColumns / kBlockSize * kPartRows;
  return lane_bits((x + lane_x() < x_end) & (y + lane_y() < y_end));
}

// Which triangles of a run are seen.
[[gnu::noinline]] inline std::vector<bool> find_seen(const TileLayer& layer,
                                                     const VisibleRun& run) {
  std::vector<bool> is_seen(static_cast<std::size_t>(run.end_id - run.first_id));
  for (const std::int32_t id : layer.ids) {
    if (id >= run.first_id && id < run.end_id) {
      is_seen[static_cast<std::size_t>(id - run.first_id)] = true;
    }
  }
  return is_seen;
}

// Quads without a pixel fill up the last vector and those that are prefetched.
SOFTFOCUS_INLINE void fill_up(SeenQuads& seen) {
  if (seen.count == 0) return;
  std::uint32_t* end = &seen.entries[static_cast<std::size_t>(seen.count)];
  for (std::size_t i = 0; i < (kQuadsAhead + 1) * kQuads; ++i) {
    end[i] = end[-1] >> kQuadPixels << kQuadPixels;
  }
}

// Not inlined: one copy for all stages.
[[gnu::noinline]] inline void list_seen(const VisibilityTile& tile, const TileLayer& layer,
                                        const VisibleRun& run, SeenQuads& seen) {
  const int width = tile.area.x_end - tile.area.x_begin;
  const int height = tile.area.y_end - tile.area.y_begin;
  const bool is_cut = width < kTileSize || height < kTileSize;
  std::uint32_t* to = seen.entries.data();
  // Of large triangles behind each other few are seen: then the others are not looked for.
  constexpr int kMostLooks = 4 * kTilePixels;
  int looks = 0;
  std::vector<bool> is_seen;
  for (std::int32_t id = run.first_id; id < run.end_id; ++id) {
    if (looks > kMostLooks && is_seen.empty()) is_seen = find_seen(layer, run);
    if (!is_seen.empty() && !is_seen[static_cast<std::size_t>(id - run.first_id)]) continue;
    const auto& bounds = tile.triangles[static_cast<std::size_t>(id - 1)]->bounds;
    const int x_begin = std::max<int>(bounds[0] - tile.area.x_begin, 0) & -kPartColumns;
    const int y_begin = std::max<int>(bounds[1] - tile.area.y_begin, 0) & -kPartRows;
    const int x_end = std::min<int>(bounds[2] - tile.area.x_begin, width);
    const int y_end = std::min<int>(bounds[3] - tile.area.y_begin, height);
    const auto triangle = static_cast<std::uint32_t>(id - run.first_id) << kQuadBits;
    const Ints own = splat(id);
    looks += (x_end - x_begin) * (y_end - y_begin);
    for (int y = y_begin; y < y_end; y += kPartRows) {
      const auto row = static_cast<std::uint32_t>(y / 2) << kColumnBits;
      std::size_t place = place_of_pixel(x_begin, y);
      for (int x = x_begin; x < x_end; x += kPartColumns, place = next_part_place(place)) {
        unsigned pixels = equal_lane_bits(load(&layer.ids[place]), own);
        if (pixels == 0) continue;
        if (is_cut) pixels &= pixels_before(place, width, height);
        const auto quad = (triangle | row | static_cast<std::uint32_t>(x / 2)) << kQuadPixels;
#pragma GCC unroll 4
        for (unsigned i = 0; i < kQuads; ++i) {
          const unsigned of_quad = pixels >> (i * kQuadPixels) & 0xFu;
          *to = quad + (((i & 1) + (i >> 1 << kColumnBits)) << kQuadPixels) + of_quad;
          to += of_quad != 0 ? 1 : 0;
        }
      }
    }
  }
  seen.count = static_cast<int>(to - seen.entries.data());
  fill_up(seen);
}

// The layer of sample 0 of further quads.
SOFTFOCUS_INLINE std::size_t first_further(const VisibilityTile& tile) {
  return tile.has_samples ? 0 : tile.layers;
}

// Takes as many of a run's further quads as there is room for. Returns how many.
[[gnu::noinline]] inline std::size_t take_further(const VisibilityTile& tile, const VisibleRun& run,
                                                  std::size_t from, SeenQuads& seen) {
  const std::size_t count = std::min<std::size_t>(run.further_end - from, kTilePixels);
  const std::byte* first_texels = tile.layer(first_further(tile)).texels;
  for (std::size_t i = 0; i < count; ++i) {
    const FurtherQuad& quad = tile.further[from + i];
    const std::uint32_t block = quad.number / 4u;
    const std::uint32_t row = block / kTileBlocks * 2 + (quad.number >> 1 & 1u);
    const std::uint32_t column = block % kTileBlocks * 2 + (quad.number & 1u);
    const auto triangle = static_cast<std::uint32_t>(quad.id - run.first_id);
    seen.entries[i] =
        ((triangle << kQuadBits | row << kColumnBits | column) << kQuadPixels) + quad.pixels;
    seen.sample_offsets[i] = static_cast<std::int32_t>(
        tile.layer(first_further(tile) + quad.sample).texels - first_texels);
    seen.shifts[i] = quad.shift;
  }
  const auto end = static_cast<std::ptrdiff_t>(count);
  std::fill_n(seen.sample_offsets.begin() + end, kLanes, 0);
  std::fill_n(seen.shifts.begin() + end, kLanes, 0);
  seen.count = static_cast<int>(count);
  fill_up(seen);
  return count;
}

// Prefetches the vertices of quads to come, which were written long ago.
SOFTFOCUS_INLINE void fetch_vertices(const LaneTriangle* const* triangles,
                                     const std::uint32_t* entries) {
  for (int quad = 0; quad < kQuads; ++quad) {
    for (const float* row : triangles[triangle_of(entries[quad])]->vertices) {
      __builtin_prefetch(row);
    }
  }
}

// Stores kLanes colours, each at its offset.
template <HalfRounding rounding>
SOFTFOCUS_INLINE void store_colours(const std::array<Floats, 4>& colour, std::byte* first,
                                    const std::int32_t* offsets) {
  constexpr std::size_t kTexelBytes = sizeof(std::uint64_t);
#if SOFTFOCUS_LANES >= 8
  if constexpr (rounding != HalfRounding::swiftshader) {
    // Texels are put together before they are converted: half as many steps.
    std::array<Floats, 4> texels;
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 4; ++i) texels[i] = with_plain_nan(colour[i]);
    transpose_fours(texels[0], texels[1], texels[2], texels[3]);
#pragma GCC unroll 4
    for (std::size_t i = 0; i < 4; ++i) {
      const HalfVector halves = to_halves<rounding>(texels[i]);
#pragma GCC unroll 4
      for (std::size_t four = 0; four < kLanes / 4; ++four) {
        const std::uint64_t texel = halves[four];
        std::memcpy(first + offsets[4 * four + i], &texel, kTexelBytes);
      }
    }
    return;
  }
#endif
  alignas(64) std::array<std::uint16_t, 4 * kLanes> halves;
  store_half_texels(halves.data(),
                    {float_to_half<rounding>(colour[0]), float_to_half<rounding>(colour[1]),
                     float_to_half<rounding>(colour[2]), float_to_half<rounding>(colour[3])});
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    std::memcpy(first + offsets[lane], &halves[4 * lane], kTexelBytes);
  }
}

SOFTFOCUS_INLINE void store_colours(const std::array<Floats, 4>& colour, HalfRounding rounding,
                                    std::byte* first, const std::int32_t* offsets) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return store_colours<nearest_even>(colour, first, offsets);
    case toward_zero: return store_colours<toward_zero>(colour, first, offsets);
    case swiftshader: break;
  }
  store_colours<swiftshader>(colour, first, offsets);
}

// The second step. Not inlined: all interpolators share it.
template <class Stage>
[[gnu::noinline]] void shade_batch(const Stage& stage, const FragmentJob& job,
                                   const VisibilityTile& tile,
                                   FragmentBatch<Stage::kInputs>& batch) {
  if (batch.count == 0) return;
  batch.fill_up();
  std::array<std::array<Floats, 4>, 8> colours;
  stage.shade(batch, colours.data());
  std::byte* first = tile.layer(job.layer == kFurther ? first_further(tile) : job.layer).texels;
  for (int vector = 0; vector < batch.vectors(); ++vector) {
    store_colours(colours[static_cast<std::size_t>(vector)], job.profile->half_store, first,
                  &batch.offsets[static_cast<std::size_t>(vector * kLanes)]);
  }
  batch.count = 0;
}

template <class Stage>
SOFTFOCUS_INLINE LoadJob load_job_of(const Stage& stage, const FragmentJob& job) {
  std::size_t varyings = Stage::kInterpolation.size();
  if constexpr (requires { stage.varying_count(); }) varyings = stage.varying_count();
  return {job.provoking, varyings, job.profile->interpolation, job.samples == 1 ? 0.0f : 0.5f};
}

template <class Stage>
constexpr std::size_t usual_varyings() {
  if constexpr (requires { Stage::kUsualVaryings; }) return Stage::kUsualVaryings;
  return Stage::kInterpolation.size();
}

template <class Interpolator, class Stage>
void shade_quads(const Stage& stage, const FragmentJob& job, const VisibilityTile& tile,
                 const VisibleRun& run, const SeenQuads& seen) {
  const bool is_further = job.layer == kFurther;
  const TileLayer& layer = tile.layer(is_further ? first_further(tile) : job.layer);
  const LaneTriangle* const* triangles =
      &tile.triangles[static_cast<std::size_t>(run.first_id - 1)];
  constexpr int kTexelBytes = sizeof(std::uint64_t);
  const int row_texels = static_cast<int>(layer.stride_bytes) / kTexelBytes;
  const Ints per_place = splat(packed_pixel(1, row_texels));
  const bool rows_are_long = row_texels > 0x7FFF;  // with the rows of samples between them
  const std::byte* first = layer.texels;
  const bool in_picture = layer.stride_bytes > kTileSize * sizeof(std::uint64_t);
  const Ints own_pixel = splat(1) << (lane_numbers() & (kQuadPixels - 1));
  const Ints own_place = (lane_numbers() & 1) | (lane_numbers() >> 1 & 1) << 16;
  const Ints origin = splat(packed_pixel(tile.area.x_begin, tile.area.y_begin));

  FragmentBatch<Stage::kInputs> batch;
  Interpolator interpolator{};
  const LoadJob load_job = load_job_of(stage, job);
  QuadTriangles of_quads{};
  std::uint32_t loaded = ~0u;  // the triangle of all quads, if it is one
  for (int i = 0; i < seen.count; i += kQuads) {
    const std::uint32_t* entries = &seen.entries[static_cast<std::size_t>(i)];
    const Ints entry = repeat_by_four(as_ints(load(entries)));
    const std::uint32_t* ahead = entries + kQuadsAhead * kQuads;
    if (triangle_of(ahead[kQuads - 1]) != triangle_of(ahead[-1])) fetch_vertices(triangles, ahead);
    const std::uint32_t first_triangle = triangle_of(entries[0]);
    // Further quads of one triangle need not follow each other.
    bool is_one = true;
#pragma GCC unroll 4
    for (std::size_t quad = 1; quad < kQuads; ++quad) {
      is_one &= first_triangle == triangle_of(entries[quad]);
    }
    if (!is_one || first_triangle != loaded) {
#pragma GCC unroll 4
      for (std::size_t quad = 0; quad < kQuads; ++quad) {
        of_quads[quad] = triangles[triangle_of(entries[quad])];
      }
      interpolator.load(of_quads, load_job);
      loaded = is_one ? first_triangle : ~0u;
    }
    // As packed_pixel(), in the tile. A quad's column and row count two pixels.
    constexpr int kInColumns = (1 << (kColumnBits + 1)) - 2;
    constexpr int kToRows = 17 - kColumnBits - kQuadPixels;
    const Ints places = (entry >> (kQuadPixels - 1) & kInColumns) +
                        (entry << kToRows & kInColumns << 16) + own_place;
    QuadFragments<Interpolator> fragments{interpolator, interpolator.weights(places + origin),
                                          of_quads};
    if (is_further) {
      // A quad is shifted as a whole, so that differences within it are as without.
      const Ints shift = repeat_by_four(load(&seen.shifts[static_cast<std::size_t>(i)]));
      if (any(~(shift == 0))) fragments.point = interpolator.weights_at(places + origin, shift);
    }
    const std::int32_t* offsets = &batch.offsets[static_cast<std::size_t>(batch.count)];
    Ints pixel_offsets = multiply_add_pairs(places, per_place) * kTexelBytes;
    if (rows_are_long)
      pixel_offsets = ((places & 0xFFFF) + (places >> 16) * row_texels) * kTexelBytes;
    if (is_further) {
      pixel_offsets += repeat_by_four(load(&seen.sample_offsets[static_cast<std::size_t>(i)]));
    }
    batch.append(stage, fragments, pixel_offsets, (entry & own_pixel) != 0);
    // The second step writes there. A tile apart from the picture is in the cache anyway.
    for (int lane = 0; in_picture && lane < kLanes; lane += lane % 8 == 0 ? 2 : 6) {
      __builtin_prefetch(first + offsets[lane], 1);
    }
    if (!batch.has_room()) shade_batch(stage, job, tile, batch);
  }
  shade_batch(stage, job, tile, batch);
}

template <class Interpolator, class Stage>
void shade_seen(const Stage& stage, const FragmentJob& job, const VisibilityTile& tile,
                const VisibleRun& run) {
  SeenQuads seen;
  if (job.layer != kFurther) {
    list_seen(tile, tile.layer(job.layer), run, seen);
    shade_quads<Interpolator>(stage, job, tile, run, seen);
    return;
  }
  for (std::size_t from = run.further_begin; from < run.further_end;) {
    from += take_further(tile, run, from, seen);
    shade_quads<Interpolator>(stage, job, tile, run, seen);
  }
}

// A stage that discards has, beside kInterpolation,
//     template <class Quads> Mask keeps(const Quads&) const
template <class Interpolator, class Stage>
unsigned keep_of_part(const Stage& stage, const FragmentJob& job, const LaneTriangle& triangle,
                      int x, int y, unsigned pixels) {
  QuadTriangles of_quads;
  of_quads.fill(&triangle);
  Interpolator interpolator{};
  interpolator.load(of_quads, load_job_of(stage, job));
  const QuadFragments<Interpolator> fragments{
      interpolator, interpolator.weights((x + lane_x()) | (y + lane_y()) << 16), of_quads};
  return lane_bits(stage.keeps(fragments)) & pixels;
}

template <class Stage>
unsigned keep_fragments(const Stage& stage, const FragmentJob& job, const LaneTriangle& triangle,
                        int x, int y, unsigned pixels) {
  if (job.profile->attributes == AttributeSetup::exact_barycentric) {
    return keep_of_part<BarycentricLanes<Stage::kInterpolation>>(stage, job, triangle, x, y,
                                                                 pixels);
  }
  return keep_of_part<PlaneLanes<Stage::kInterpolation>>(stage, job, triangle, x, y, pixels);
}

template <class Stage>
void shade_fragments(const Stage& stage, const FragmentJob& job, const VisibilityTile& tile,
                     const VisibleRun& run) {
  if (job.profile->attributes == AttributeSetup::exact_barycentric) {
    shade_seen<BarycentricLanes<Stage::kInterpolation, usual_varyings<Stage>()>>(stage, job, tile,
                                                                                 run);
  } else {
    shade_seen<PlaneLanes<Stage::kInterpolation>>(stage, job, tile, run);
  }
}

}  // namespace
