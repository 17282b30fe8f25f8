// A pass of the fixed-point filter along lines (dof/fixed_line.h).

/// Weight and colours, each times a weight.
struct FixedSums {
  Bits weight, r, g, b;
};

SOFTFOCUS_INLINE FixedSums plus(const FixedSums& a, const FixedSums& b) {
  return {a.weight + b.weight, a.r + b.r, a.g + b.g, a.b + b.b};
}
SOFTFOCUS_INLINE FixedSums minus(const FixedSums& a, const FixedSums& b) {
  return {a.weight - b.weight, a.r - b.r, a.g - b.g, a.b - b.b};
}
SOFTFOCUS_INLINE FixedSums masked(const FixedSums& a, Mask mask) {
  const Bits kept = as_bits(mask);
  return {a.weight & kept, a.r & kept, a.g & kept, a.b & kept};
}
SOFTFOCUS_INLINE FixedSums load_fixed(const std::uint32_t* from) {
  return {load(from), load(from + kLanes), load(from + 2 * kLanes), load(from + 3 * kLanes)};
}
SOFTFOCUS_INLINE void store_fixed(std::uint32_t* to, const FixedSums& sums) {
  store(to, sums.weight);
  store(to + kLanes, sums.r);
  store(to + 2 * kLanes, sums.g);
  store(to + 3 * kLanes, sums.b);
}

/// A colour of 10 bits times a weight, c l + 2^5 c h: 2^5 c has 15 bits.
SOFTFOCUS_INLINE Bits times(Bits c, Ints split_weight) {
  return as_bits(multiply_add_pairs(as_ints(c | c << (16 + kSplitBits)), split_weight));
}
SOFTFOCUS_INLINE FixedSums weighed(Ints word, Bits colour) {
  const Ints weight = word & kSplitMask;
  return {as_bits((weight >> 16 << kSplitBits) + (weight & 31)), times(colour & 0x3FFu, weight),
          times(colour >> 10 & 0x3FFu, weight), times(colour >> 20, weight)};
}

SOFTFOCUS_INLINE Ints key_of(Ints whole) { return whole >> kKeyShift & kKeyMask; }

/// Differences of one side of the focus at a node.
SOFTFOCUS_INLINE std::uint32_t* sums_at(const FixedLine& line, int node, int side) {
  const unsigned slot = static_cast<unsigned>(node) & (line.sum_slots - 1);
  return line.sums + (slot * 8u + static_cast<unsigned>(side) * 4u) * kLanes;
}
SOFTFOCUS_INLINE int node_at(const FixedLine& line, int node) {
  return static_cast<int>(static_cast<unsigned>(node) & (line.node_slots - 1)) * kLanes;
}

SOFTFOCUS_INLINE void add_to(std::uint32_t* slot, const FixedSums& sums) {
  store_fixed(slot, plus(load_fixed(slot), sums));
}
SOFTFOCUS_INLINE void take_from(std::uint32_t* slot, const FixedSums& sums) {
  store_fixed(slot, minus(load_fixed(slot), sums));
}

/// The differences of a node whose pixels all reach equally far that are still to be put
/// down: the next node's go to the same places if it is like it.
struct PendingNode {
  int key = 0;  ///< reach << 1 | beyond; 0 if there is none
  FixedSums inner{}, outer{};
};

/// `node` is that after the pending one.
SOFTFOCUS_INLINE void put_down(const FixedLine& line, int node, PendingNode& pending) {
  if (pending.key == 0) return;
  const int reach = pending.key >> 1, side = pending.key & 1;
  add_to(sums_at(line, node - reach, side), pending.inner);
  take_from(sums_at(line, node + reach, side), pending.outer);
  pending.key = 0;
}

/// A pixel adds `edge` at its reach and `whole` up to there: a difference of edge (outer)
/// at -reach, whole - edge (inner) one further, the same two back at reach and one past it.
SOFTFOCUS_INLINE void spread_node(FixedLine& line, int node, PendingNode& pending) {
  const int at = node_at(line, node);
  const Ints whole = load(line.wholes + at);
  const Ints key = key_of(whole);
  const int first = key[0];
  const bool alike = all(key == first);
  if (alike && first < 2) {
    put_down(line, node, pending);
    return;
  }
  const Bits colour = load(line.colours + at);
  const FixedSums outer = weighed(load(line.edges + at), colour);
  const FixedSums inner = minus(weighed(whole, colour), outer);
  if (alike) {
    const int reach = first >> 1, side = first & 1;
    if (pending.key == first) {
      add_to(sums_at(line, node - reach, side), plus(outer, pending.inner));
      take_from(sums_at(line, node + reach, side), plus(inner, pending.outer));
    } else {
      put_down(line, node, pending);
      add_to(sums_at(line, node - reach, side), outer);
      take_from(sums_at(line, node + reach, side), inner);
    }
    pending = {first, inner, outer};
    if (node + reach > line.touched[side]) line.touched[side] = node + reach;
    return;
  }
  put_down(line, node, pending);
  std::int32_t keys[kLanes];
  store(keys, key);
  for (unsigned left = lane_bits(key >= 2); left != 0;) {
    const std::int32_t one = keys[__builtin_ctz(left)];
    const Mask same = key == one;
    left &= ~lane_bits(same);
    const int reach = one >> 1, side = one & 1;
    const FixedSums some_outer = masked(outer, same), some_inner = masked(inner, same);
    add_to(sums_at(line, node - reach, side), some_outer);
    add_to(sums_at(line, node - reach + 1, side), some_inner);
    take_from(sums_at(line, node + reach, side), some_inner);
    take_from(sums_at(line, node + reach + 1, side), some_outer);
    if (node + reach > line.touched[side]) line.touched[side] = node + reach;
  }
}

/// floor(sum / weight) below 1024. The reciprocal is too small by 2^-12 to 3 2^-12 of it: the
/// estimate is right or less by one, and the remainder tells.
SOFTFOCUS_INLINE Bits exact_quotient(Bits sum, Bits weight, Floats reciprocal) {
  const Ints estimate = truncate(to_floats(as_ints(sum)) * reciprocal);
  const Ints rest = as_ints(sum) - estimate * as_ints(weight);
  return as_bits(estimate - (rest >= as_ints(weight)));
}

/// Colours of 10 bits in a word, or of 8.
template <int bits>
SOFTFOCUS_INLINE Bits quotients(const FixedSums& sums) {
  const Bits weight = sums.weight;
  const Floats reciprocal = rough_reciprocal(to_floats(as_ints(weight))) * (1.0f - 0x1p-11f);
  const Bits half = bits == 10 ? weight >> 1 : weight << 1;
  constexpr int kCut = 10 - bits;
  return exact_quotient((sums.r + half) >> kCut, weight, reciprocal) |
         exact_quotient((sums.g + half) >> kCut, weight, reciprocal) << bits |
         exact_quotient((sums.b + half) >> kCut, weight, reciprocal) << 2 * bits;
}

/// What `quotients` gives of a pixel that nothing is added to.
template <int bits>
SOFTFOCUS_INLINE Bits unchanged(Bits colour) {
  if constexpr (bits == 10) return colour;
  const Bits rounded = colour + (2u | 2u << 10 | 2u << 20);  // up to 1022: no carry
  return (rounded >> 2 & 0xFFu) | (rounded >> 4 & 0xFF00u) | (rounded >> 6 & 0xFF0000u);
}

/// floor(sum leak), sum below 2^31.
SOFTFOCUS_INLINE Bits leaked(Bits sum, Bits leak) {
  return (sum >> 15) * leak + ((sum & 0x7FFFu) * leak >> 15);
}

SOFTFOCUS_INLINE void run_over(std::uint32_t* slot, FixedSums& running) {
  running = plus(running, load_fixed(slot));
  store_fixed(slot, {splat(0u), splat(0u), splat(0u), splat(0u)});
}

/// What comes out at a node.
template <int bits>
SOFTFOCUS_INLINE Bits receive(const FixedLine& line, int node, FixedSums near_side,
                              FixedSums beyond_side, bool any_beyond) {
  const int at = node_at(line, node);
  const Ints whole = load(line.wholes + at);
  const Ints key = key_of(whole);
  // Its own share is among the sums of its side already if it reaches anything.
  const Mask in_beyond = (key >= 2) & ((key & 1) != 0);
  const Mask to_add = (key < 2) | in_beyond;
  if (any(to_add)) {
    const FixedSums own = weighed(whole, load(line.colours + at));
    near_side = plus(near_side, masked(own, to_add));
    beyond_side = minus(beyond_side, masked(own, in_beyond));
  }
  if (any_beyond) {
    const Ints edge = load(line.edges + at);
    if (any((edge < 0) & (beyond_side.weight != 0u))) {
      const Ints below_one = (edge >> kLeakShift & ((1 << kLeakBitsThere) - 1)) |
                             (whole >> (kKeyShift + 7) & 15) << kLeakBitsThere;
      const Bits leak = as_bits(select(edge < 0, below_one, splat(1 << 15)));
      beyond_side = {leaked(beyond_side.weight, leak), leaked(beyond_side.r, leak),
                     leaked(beyond_side.g, leak), leaked(beyond_side.b, leak)};
    }
    near_side = plus(near_side, beyond_side);
  }
  return quotients<bits>(near_side);
}

SOFTFOCUS_INLINE void begin_line(FixedLine& line) {
  std::memset(line.sums, 0, sizeof(std::uint32_t) * line.sum_slots * 8 * kLanes);
  std::memset(line.running, 0, sizeof(std::uint32_t) * 8 * kLanes);
  line.touched[0] = line.touched[1] = INT32_MIN;
}

/// Takes kLanes nodes from `node`, which lie in the line, and stores what comes out at the
/// kLanes nodes from `node` - reach; only from node `wanted` on is it computed.
template <int bits>
void filter_nodes(FixedLine& line, int node, int wanted, std::uint32_t* out) {
  FixedSums running[2] = {load_fixed(line.running), load_fixed(line.running + 4 * kLanes)};
  PendingNode pending;
  for (int i = 0; i < kLanes; ++i) {
    spread_node(line, node + i, pending);
    const int done = node + i - line.reach;
    // The differences of a pixel end one past its reach.
    const bool any_near = done - 1 <= line.touched[0];
    const bool any_beyond = done - 1 <= line.touched[1];
    if (any_near) run_over(sums_at(line, done, 0), running[0]);
    if (any_beyond) run_over(sums_at(line, done, 1), running[1]);
    if (done < wanted) continue;
    const Bits colour = any_near || any_beyond
                            ? receive<bits>(line, done, running[0], running[1], any_beyond)
                            : unchanged<bits>(load(line.colours + node_at(line, done)));
    store(out + i * kLanes, colour);
  }
  put_down(line, node + kLanes, pending);
  store_fixed(line.running, running[0]);
  store_fixed(line.running + 4 * kLanes, running[1]);
}
