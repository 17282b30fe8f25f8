// The vertex stage runs twice: for the positions of all vertices, then in full for the vertices
// of triangles that are drawn. Most triangles of a scene are not: they face away, or lie beside
// the picture or between the pixels' centres.
//
// A vertex stage in lanes has kVaryings, and
//     void position(Ints index, std::array<Floats, 4>& position) const
//     void operator()(Ints index, std::array<Floats, 4>& position,
//                     std::array<Floats, kVaryings>& varyings) const
// with the same bits for the position. A stage whose number of varyings is known at run time
// alone has kVaryings at most, and std::size_t varying_count() const.

namespace {

SOFTFOCUS_INLINE Mask is_finite(Floats v) { return (as_bits(v) & 0x7F800000u) != 0x7F800000u; }

// clip_code().
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

// snap() of setup.cpp.
SOFTFOCUS_INLINE Ints snapped(Floats window, Mask drawable, int bits, int samples) {
  const float from = samples == 1 ? 0.5f : 0.0f;
  const Floats steps = nearest((window - from) * static_cast<float>(1 << bits));
  return (truncate(select(drawable, steps, splat(0.0f))) << (kSubpixelBits - bits)) -
         (samples == 1 ? 0 : kSubpixelOne / 2);
}

/// WindowVertex.
struct WindowLanes {
  Floats x, y, depth, inverse_w;
};

// to_window().
SOFTFOCUS_INLINE WindowLanes window_lanes(const std::array<Floats, 4>& position,
                                          const VertexJob& job) {
  const Contraction contraction = job.profile->viewport;
  const Floats inverse_w = 1.0f / position[3];
  return {
      to_window_lanes(position[0] * inverse_w, static_cast<float>(job.width) * 0.5f, contraction),
      to_window_lanes(position[1] * inverse_w, static_cast<float>(job.height) * 0.5f, contraction),
      to_window_lanes(position[2] * inverse_w, 0.5f, contraction), inverse_w};
}

// Returns the bits that the clip codes of all vertices share.
template <class Stage>
unsigned place_vertices(const Stage& stage, const VertexJob& job) {
  const Profile& profile = *job.profile;
  const VertexStore& to = job.store;
  Ints common = ~Ints{};
  for (std::uint32_t begin = job.begin; begin < job.end; begin += kLanes) {
    // Lanes past the last vertex repeat it; the store has room for them.
    const Ints index = smaller(static_cast<std::int32_t>(begin) + lane_numbers(),
                               splat(static_cast<std::int32_t>(job.end) - 1));
    std::array<Floats, 4> position;
    stage.position(index, position);
    const WindowLanes window = window_lanes(position, job);
    // is_drawable() of setup.cpp.
    const Mask drawable = (absolute(window.x) < kLargestPosition) &
                          (absolute(window.y) < kLargestPosition) & is_finite(window.depth) &
                          is_finite(window.inverse_w) & (window.inverse_w > 0.0f);
    const Ints codes = clip_codes(position, profile.guard_band) |
                       (~drawable & static_cast<std::int32_t>(kNotDrawable));
    common &= codes;
    store(to.codes + begin, codes);
    store(to.snapped_x + begin, snapped(window.x, drawable, profile.subpixel_bits, job.samples));
    store(to.snapped_y + begin, snapped(window.y, drawable, profile.subpixel_bits, job.samples));
    store(to.x + begin, window.x);
    store(to.y + begin, window.y);
    store(to.depth + begin, window.depth);
  }
  alignas(64) std::array<std::int32_t, kLanes> lanes;
  store(lanes.data(), common);
  std::int32_t of_all = ~0;
  for (const std::int32_t of_lane : lanes) of_all &= of_lane;
  return static_cast<unsigned>(of_all) & ~kNotDrawable;
}

template <class Stage>
SOFTFOCUS_INLINE std::size_t varying_count(const Stage& stage) {
  if constexpr (requires { stage.varying_count(); }) return stage.varying_count();
  return Stage::kVaryings;
}

// The rows of kLanes vertices.
template <class Stage>
SOFTFOCUS_INLINE void shade_rows(const Stage& stage, const VertexJob& job,
                                 const std::int32_t* numbers) {
  const std::size_t varyings_of_stage = varying_count(stage);
  std::array<Floats, 4> position;
  std::array<Floats, Stage::kVaryings> varyings;
  stage(load(numbers), position, varyings);
  const WindowLanes window = window_lanes(position, job);
  std::array<Floats, vertex_row_size(Stage::kVaryings)> quantities{};
  quantities[kVertexX] = window.x;
  quantities[kVertexY] = window.y;
  quantities[kVertexDepth] = window.depth;
  quantities[kVertexInverseW] = window.inverse_w;
  for (std::size_t i = 0; i < varyings_of_stage; ++i) quantities[kVertexVaryings + i] = varyings[i];
  for (std::size_t k = 0; k < vertex_row_size(varyings_of_stage); k += 4) {
    Floats* four = &quantities[k];
    transpose_fours(four[0], four[1], four[2], four[3]);
    // Vector i has vertices i, i + 4, i + 8 ...
    for (std::size_t vertex = 0; vertex < kLanes; ++vertex) {
      std::memcpy(job.store.rows + static_cast<std::size_t>(numbers[vertex]) * job.store.stride + k,
                  reinterpret_cast<const float*>(&four[vertex % 4]) + vertex / 4 * 4,
                  4 * sizeof(float));
    }
  }
}

SOFTFOCUS_INLINE std::size_t place_in_list(int i) { return static_cast<std::size_t>(i); }

// Shades the marked vertices and clears their marks.
template <class Stage>
void shade_vertices(const Stage& stage, const VertexJob& job) {
  constexpr std::uint32_t kMarks = sizeof(std::uint64_t);
  alignas(64) std::array<std::int32_t, kLanes + kMarks> numbers;
  int count = 0;
  for (std::uint32_t begin = job.begin; begin < job.end; begin += kMarks) {
    std::uint64_t marks;
    std::memcpy(&marks, job.store.used + begin, sizeof marks);
    if (marks == 0) continue;
    for (std::uint32_t i = 0; i < kMarks; ++i) {
      numbers[place_in_list(count)] = static_cast<std::int32_t>(begin + i);
      count += job.store.used[begin + i];
    }
    std::memset(job.store.used + begin, 0, kMarks);
    int done = 0;
    for (; count - done >= kLanes; done += kLanes)
      shade_rows(stage, job, &numbers[place_in_list(done)]);
    count -= done;
    for (int i = 0; done > 0 && i < count; ++i)
      numbers[place_in_list(i)] = numbers[place_in_list(done + i)];
  }
  if (count == 0) return;
  for (int i = count; i < kLanes; ++i) numbers[place_in_list(i)] = numbers[0];
  shade_rows(stage, job, numbers.data());
}

}  // namespace
