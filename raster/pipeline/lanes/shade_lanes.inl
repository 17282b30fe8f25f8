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
  }
};

// A quad that shows a triangle of a run, in 32 bits. From the top: the triangle's id less the
// run's first; the quad's number; a bit for each pixel that shows the triangle.
inline constexpr int kQuadBits = 10;
static_assert(kTilePixels / kQuadPixels == 1 << kQuadBits);
static_assert(kMostVisible >> (32 - kQuadBits - kQuadPixels) == 0);

// Vertices are prefetched this many vectors ahead: a few hundred cycles.
inline constexpr int kQuadsAhead = 3;

struct SeenQuads {
  std::array<std::uint32_t, kTilePixels + (kQuadsAhead + 1) * kLanes> entries;
  int count = 0;
};

SOFTFOCUS_INLINE std::uint32_t triangle_of(std::uint32_t entry) {
  return entry >> (kQuadBits + kQuadPixels);
}

// The triangles of kQuads entries, each in the lanes of its quad.
SOFTFOCUS_INLINE Ints triangles_of(const std::uint32_t* entries) {
  return as_ints(as_bits(repeat_by_four(as_ints(load(entries)))) >> (kQuadBits + kQuadPixels));
}

SOFTFOCUS_INLINE std::uint32_t quad_entry(const VisibleRun& run, std::int32_t id, int quad,
                                          unsigned pixels) {
  const auto triangle = static_cast<std::uint32_t>(id - run.first_id);
  return (triangle << kQuadBits | static_cast<unsigned>(quad)) << kQuadPixels | pixels;
}

// Lists the quads of the vector that begins with `quad`. Returns the new count.
SOFTFOCUS_INLINE int list_quads(const TileLayer& layer, const VisibleRun& run, int quad,
                                Mask in_area, std::uint32_t* entries, int count) {
  const std::int32_t* first_id = &layer.ids[static_cast<std::size_t>(quad * kQuadPixels)];
  const Ints ids = load(first_id);
  const unsigned seen = lane_bits((ids >= run.first_id) & (ids < run.end_id) & in_area);
  if (seen == 0) return count;
  if (seen == kAllLaneBits && all(ids == ids[0])) {
    store(entries + count,
          quad_entry(run, ids[0], quad, 0xFu) + as_bits(lane_numbers() << kQuadPixels));
    return count + kQuads;
  }
  // First the triangle that each quad's first pixel shows, then the others.
  const unsigned as_first = lane_bits(ids == spread<0>(ids)) & seen;
  for (int i = 0; i < kQuads; ++i) {
    const unsigned pixels = as_first >> (i * kQuadPixels) & 0xFu;
    entries[count] = quad_entry(run, first_id[i * kQuadPixels], quad + i, pixels);
    count += pixels != 0 ? 1 : 0;
  }
  for (unsigned rest = seen & ~as_first; rest != 0;) {
    const int lane = __builtin_ctz(rest);
    const int i = lane / kQuadPixels;
    const unsigned same = lane_bits(ids == first_id[lane]) & rest & 0xFu << (i * kQuadPixels);
    rest &= ~same;
    entries[count++] = quad_entry(run, first_id[lane], quad + i, same >> (i * kQuadPixels));
  }
  return count;
}

// Not inlined: one copy for all stages.
[[gnu::noinline]] inline void list_seen(const VisibilityTile& tile, const TileLayer& layer,
                                        const VisibleRun& run, SeenQuads& seen) {
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

  int count = 0;
  for (int y = y_begin & -kBlockSize; y < y_end; y += kBlockSize) {
    for (int x = x_begin & -kBlockSize; x < x_end; x += kBlockSize) {
      for (int part = 0; part < kBlockParts; ++part) {
        const int left = x + part * kPartColumns % kBlockSize;
        const int top = y + part * kPartColumns / kBlockSize * kPartRows;
        const Mask in_area = (left + lane_x() < x_end) & (top + lane_y() < y_end);
        const int quad = static_cast<int>(place_of_pixel(left, top)) / kQuadPixels;
        count = list_quads(layer, run, quad, in_area, seen.entries.data(), count);
      }
    }
  }
  seen.count = count;
  // Quads without a pixel fill up the last vector and those that are prefetched.
  if (seen.count == 0) return;
  const auto end = static_cast<std::size_t>(seen.count);
  for (std::size_t i = 0; i < (kQuadsAhead + 1) * kQuads; ++i) {
    seen.entries[end + i] = seen.entries[end - 1] >> kQuadPixels << kQuadPixels;
  }
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

template <HalfRounding rounding>
SOFTFOCUS_INLINE HalfTexels to_half_texels(const std::array<Floats, 4>& colour) {
  return {float_to_half<rounding>(colour[0]), float_to_half<rounding>(colour[1]),
          float_to_half<rounding>(colour[2]), float_to_half<rounding>(colour[3])};
}

SOFTFOCUS_INLINE HalfTexels to_half_texels(const std::array<Floats, 4>& colour,
                                           HalfRounding rounding) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return to_half_texels<nearest_even>(colour);
    case toward_zero: return to_half_texels<toward_zero>(colour);
    case swiftshader: break;
  }
  return to_half_texels<swiftshader>(colour);
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
  std::byte* first = tile.layer(job.layer).texels;
  for (int vector = 0; vector < batch.vectors(); ++vector) {
    alignas(64) std::array<std::uint16_t, 4 * kLanes> halves;
    store_half_texels(halves.data(), to_half_texels(colours[static_cast<std::size_t>(vector)],
                                                    job.profile->half_store));
    const int begin = vector * kLanes;
    const int count = std::min(batch.count - begin, kLanes);
    for (int lane = 0; lane < count; ++lane) {
      std::memcpy(first + batch.offsets[static_cast<std::size_t>(begin + lane)],
                  &halves[static_cast<std::size_t>(4 * lane)], sizeof(std::uint64_t));
    }
  }
  batch.count = 0;
}

template <class Stage>
SOFTFOCUS_INLINE LoadJob load_job_of(const Stage& stage, const FragmentJob& job) {
  std::size_t varyings = Stage::kInterpolation.size();
  if constexpr (requires { stage.varying_count(); }) varyings = stage.varying_count();
  return {job.provoking, varyings, job.profile->interpolation};
}

template <class Stage>
constexpr std::size_t usual_varyings() {
  if constexpr (requires { Stage::kUsualVaryings; }) return Stage::kUsualVaryings;
  return Stage::kInterpolation.size();
}

template <class Interpolator, class Stage>
void shade_seen(const Stage& stage, const FragmentJob& job, const VisibilityTile& tile,
                const VisibleRun& run) {
  const TileLayer& layer = tile.layer(job.layer);
  SeenQuads seen;
  list_seen(tile, layer, run, seen);
  const LaneTriangle* const* triangles =
      &tile.triangles[static_cast<std::size_t>(run.first_id - 1)];
  const auto stride = static_cast<std::int32_t>(layer.stride_bytes);
  const std::byte* first = layer.texels;
  const bool in_picture = layer.stride_bytes > kTileSize * sizeof(std::uint64_t);
  const Ints own_pixel = splat(1) << (lane_numbers() & (kQuadPixels - 1));

  FragmentBatch<Stage::kInputs> batch;
  Interpolator interpolator{};
  const LoadJob load_job = load_job_of(stage, job);
  QuadTriangles of_quads{};
  Ints loaded = splat(-1);
  for (int i = 0; i < seen.count; i += kQuads) {
    const std::uint32_t* entries = &seen.entries[static_cast<std::size_t>(i)];
    const Ints entry = repeat_by_four(as_ints(load(entries)));
    const Ints triangle = triangles_of(entries);
    const std::uint32_t* ahead = entries + kQuadsAhead * kQuads;
    if (!all(triangles_of(ahead) == triangles_of(ahead - kQuads))) fetch_vertices(triangles, ahead);
    if (!all(triangle == loaded)) {
#pragma GCC unroll 4
      for (std::size_t quad = 0; quad < kQuads; ++quad) {
        of_quads[quad] = triangles[triangle_of(entries[quad])];
      }
      interpolator.load(of_quads, load_job);
      loaded = triangle;
    }
    const Ints quad = entry >> kQuadPixels;
    const Ints block = quad >> 2;
    static_assert(kTileBlocks == 16 && kBlockPixels / kQuadPixels == 4);
    const Ints x = (block & 15) * kBlockSize + (quad & 1) * 2 + (lane_numbers() & 1);
    const Ints y = (block >> 4 & 15) * kBlockSize + (quad & 2) + (lane_numbers() >> 1 & 1);

    const QuadFragments<Interpolator> fragments{
        interpolator, interpolator.weights(tile.area.x_begin + x, tile.area.y_begin + y), of_quads};
    const std::int32_t* offsets = &batch.offsets[static_cast<std::size_t>(batch.count)];
    batch.append(stage, fragments,
                 y * stride + x * static_cast<std::int32_t>(sizeof(std::uint64_t)),
                 (entry & own_pixel) != 0);
    // The second step writes there. A tile apart from the picture is in the cache anyway.
    for (int lane = 0; in_picture && lane < kLanes; lane += lane % 8 == 0 ? 2 : 6) {
      __builtin_prefetch(first + offsets[lane], 1);
    }
    if (!batch.has_room()) shade_batch(stage, job, tile, batch);
  }
  shade_batch(stage, job, tile, batch);
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
      interpolator, interpolator.weights(x + lane_x(), y + lane_y()), of_quads};
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
