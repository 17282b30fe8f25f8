// Each function of lanes.inl over a vector of arguments, for lane_functions_test.cpp.

void lanes_half_to_float(const std::uint32_t* a, float* to) { store(to, half_to_float(load(a))); }
void lanes_load_halves(const std::uint16_t* a, float* to) { store(to, load_halves(a)); }
void lanes_to_half_nearest(const float* a, std::uint32_t* to) {
  store(to, float_to_half<HalfRounding::nearest_even>(load(a)));
}
void lanes_to_half_toward_zero(const float* a, std::uint32_t* to) {
  store(to, float_to_half<HalfRounding::toward_zero>(load(a)));
}

void lanes_floor(const float* a, float* to) { store(to, floor(load(a))); }
void lanes_nearest(const float* a, float* to) { store(to, nearest(load(a))); }
void lanes_square_root(const float* a, float* to) { store(to, square_root(load(a))); }
void lanes_absolute(const float* a, float* to) { store(to, absolute(load(a))); }
void lanes_splat(const float* a, float* to) { store(to, splat(*a)); }
void lanes_truncate_to_int(const float* a, std::int32_t* to) {
  store(to, truncate_to_int(load(a)));
}
void lanes_round_to_int(const float* a, std::int32_t* to) { store(to, round_to_int(load(a))); }

void lanes_smaller(const float* a, const float* b, float* to) {
  store(to, smaller(load(a), load(b)));
}
void lanes_larger(const float* a, const float* b, float* to) {
  store(to, larger(load(a), load(b)));
}
void lanes_select_less(const float* a, const float* b, float* to) {
  const Floats x = load(a), y = load(b);
  store(to, select(x < y, x, y * 2.0f));
}
void lanes_fused_multiply_add(const float* a, const float* b, const float* c, float* to) {
  store(to, fused_multiply_add(load(a), load(b), load(c)));
}

void lanes_multiply_add_pairs(const std::int32_t* a, const std::int32_t* b, std::int32_t* to) {
  store(to, multiply_add_pairs(load(a), load(b)));
}
void lanes_gather_pairs(const std::int32_t* base, const std::int32_t* index, std::int32_t* first,
                        std::int32_t* second) {
  const IntPairs pairs = gather_pairs(base, load(index));
  store(first, pairs.first);
  store(second, pairs.second);
}
void lanes_rough_reciprocal(const float* a, float* to) { store(to, rough_reciprocal(load(a))); }

unsigned lanes_positive_bits(const std::int32_t* a) { return lane_bits(load(a) > 0); }
unsigned lanes_sign_bits(const std::int32_t* a) { return sign_bits(load(a)); }
bool lanes_any_positive(const std::int32_t* a) { return any(load(a) > 0); }
bool lanes_all_positive(const std::int32_t* a) { return all(load(a) > 0); }
unsigned lanes_first(int count) { return lane_bits(first_lanes(count)); }

/// base[index] where the index is not negative.
void lanes_gather_ints(const std::int32_t* base, const std::int32_t* index, std::int32_t* to) {
  const Ints i = load(index);
  store(to, gather(base, i, i >= 0));
}
void lanes_gather_floats(const float* base, const std::int32_t* index, float* to) {
  const Ints i = load(index);
  store(to, gather(base, i, i >= 0));
}
int lanes_compress_positive(const std::int32_t* a, std::int32_t* to) {
  const Ints v = load(a);
  const Compression kept = compression(v > 0);
  store(to, compress(v, kept));
  const Floats floats = compress(to_floats(v), kept);
  return all(truncate(floats) == load(to)) ? __builtin_popcount(lane_bits(v > 0)) : -1;
}
void lanes_transpose(const float* rows, float* to) {
  Floats v[kLanes];
  for (int i = 0; i < kLanes; ++i) v[i] = load(rows + i * kLanes);
  transpose(v);
  for (int i = 0; i < kLanes; ++i) store(to + i * kLanes, v[i]);
}

/// The channels, one after the other.
void lanes_load_texels(const std::uint16_t* from, std::uint32_t* to) {
  const HalfTexels texels = load_half_texels(from);
  store(to, texels.r);
  store(to + kLanes, texels.g);
  store(to + 2 * kLanes, texels.b);
  store(to + 3 * kLanes, texels.a);
}
void lanes_store_texels(const std::uint32_t* from, std::uint16_t* to) {
  store_half_texels(
      to, {load(from), load(from + kLanes), load(from + 2 * kLanes), load(from + 3 * kLanes)});
}
