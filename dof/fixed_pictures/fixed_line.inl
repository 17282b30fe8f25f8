// A pass of the integer filter along lines (fixed_line.h), for colours of either format.

#include "dof/fixed_pictures/fixed_colours.inl"

template <class Sum>
SOFTFOCUS_INLINE FixedSums<Sum> plus(const FixedSums<Sum>& a, const FixedSums<Sum>& b) {
  return {a.weight + b.weight, a.r + b.r, a.g + b.g, a.b + b.b};
}
template <class Sum>
SOFTFOCUS_INLINE FixedSums<Sum> minus(const FixedSums<Sum>& a, const FixedSums<Sum>& b) {
  return {a.weight - b.weight, a.r - b.r, a.g - b.g, a.b - b.b};
}
template <class Sum>
SOFTFOCUS_INLINE FixedSums<Sum> masked(const FixedSums<Sum>& a, Mask mask) {
  return {kept(a.weight, mask), kept(a.r, mask), kept(a.g, mask), kept(a.b, mask)};
}
template <class Sum>
SOFTFOCUS_INLINE FixedSums<Sum> leaked(const FixedSums<Sum>& a, Bits leak) {
  return {leaked(a.weight, leak), leaked(a.r, leak), leaked(a.g, leak), leaked(a.b, leak)};
}

template <class Sum>
SOFTFOCUS_INLINE FixedSums<Sum> load_fixed(const std::uint32_t* from) {
  constexpr int kNext = static_cast<int>(sizeof(Sum) / sizeof(std::uint32_t));
  FixedSums<Sum> sums;
  sums.weight = load(from);
  load_sum(from + kLanes, sums.r);
  load_sum(from + kLanes + kNext, sums.g);
  load_sum(from + kLanes + 2 * kNext, sums.b);
  return sums;
}
template <class Sum>
SOFTFOCUS_INLINE void store_fixed(std::uint32_t* to, const FixedSums<Sum>& sums) {
  constexpr int kNext = static_cast<int>(sizeof(Sum) / sizeof(std::uint32_t));
  store(to, sums.weight);
  store_sum(to + kLanes, sums.r);
  store_sum(to + kLanes + kNext, sums.g);
  store_sum(to + kLanes + 2 * kNext, sums.b);
}

SOFTFOCUS_INLINE Ints key_of(Ints inner) { return inner >> kKeyShift & kKeyMask; }

/// Differences of one side of the focus at a node.
template <class Colours>
SOFTFOCUS_INLINE std::uint32_t* sums_at(const FixedLine& line, int node, int side) {
  const unsigned slot = static_cast<unsigned>(node) & (line.sum_slots - 1);
  return line.sums + (slot * 2u + static_cast<unsigned>(side)) * Colours::kSumVectors * kLanes;
}
SOFTFOCUS_INLINE int node_at(const FixedLine& line, int node) {
  return static_cast<int>(static_cast<unsigned>(node) & (line.node_slots - 1)) * kLanes;
}
template <class Colours>
SOFTFOCUS_INLINE std::uint32_t* colours_at(const FixedLine& line, int node) {
  return line.colours + Colours::kWords * node_at(line, node);
}

template <class Sum>
SOFTFOCUS_INLINE void add_to(std::uint32_t* slot, const FixedSums<Sum>& sums) {
  store_fixed(slot, plus(load_fixed<Sum>(slot), sums));
}
template <class Sum>
SOFTFOCUS_INLINE void subtract_from(std::uint32_t* slot, const FixedSums<Sum>& sums) {
  store_fixed(slot, minus(load_fixed<Sum>(slot), sums));
}

/// Differences of a node's pixels of one key, not yet put down: if pixels of the next node have
/// that key too, their differences go to the same places and are added first.
template <class Colours>
struct PendingNode {
  int key = 0;  ///< reach << 1 | beyond; 0 if there is none
  FixedSums<typename Colours::Sum> inner{}, outer{};
};

/// Puts the pending differences down; `node` is the node after theirs.
template <class Colours>
SOFTFOCUS_INLINE void put_down(const FixedLine& line, int node, PendingNode<Colours>& pending) {
  if (pending.key == 0) return;
  const int reach = pending.key >> 1, side = pending.key & 1;
  add_to(sums_at<Colours>(line, node - reach, side), pending.inner);
  subtract_from(sums_at<Colours>(line, node + reach, side), pending.outer);
  pending.key = 0;
}

SOFTFOCUS_INLINE void touch(FixedLine& line, int last, int side) {
  if (last > line.touched[side]) line.touched[side] = last;
}

/// A pixel adds `edge` at its reach and `whole` at lesser distances. As differences along the
/// line, with outer = edge and inner = whole - edge:
///   node - reach  + outer      node - reach + 1  + inner
///   node + reach  - inner      node + reach + 1  - outer
template <class Colours>
SOFTFOCUS_INLINE void spread_node(FixedLine& line, int node, PendingNode<Colours>& pending) {
  const int at = node_at(line, node);
  const Ints inner_word = load(line.inners + at);
  const Ints key = key_of(inner_word);
  int chosen = key[0];
  const bool alike = equal_lane_bits(key, splat(chosen)) == kAllLaneBits;
  unsigned left = alike ? static_cast<unsigned>(chosen >= 2) : lane_bits(key >= 2);
  if (left == 0) {
    put_down(line, node, pending);
    return;
  }
  const auto colour = Colours::load_pixels(colours_at<Colours>(line, node));
  auto outer = Colours::weighed(load(line.edges + at), colour);
  auto inner = Colours::weighed(inner_word, colour);
  if (!alike) {
    // Pixels of one key are chosen for the way below; the others are put down here.
    std::int32_t keys[kLanes];
    store(keys, key);
    const unsigned like_pending = equal_lane_bits(key, splat(pending.key)) & left;
    chosen = like_pending != 0 ? pending.key : keys[__builtin_ctz(left)];
    for (left &= ~equal_lane_bits(key, splat(chosen)); left != 0;) {
      const std::int32_t one = keys[__builtin_ctz(left)];
      const Mask same = key == one;
      left &= ~equal_lane_bits(key, splat(one));
      const int reach = one >> 1, side = one & 1;
      const auto some_outer = masked(outer, same), some_inner = masked(inner, same);
      add_to(sums_at<Colours>(line, node - reach, side), some_outer);
      add_to(sums_at<Colours>(line, node - reach + 1, side), some_inner);
      subtract_from(sums_at<Colours>(line, node + reach, side), some_inner);
      subtract_from(sums_at<Colours>(line, node + reach + 1, side), some_outer);
      touch(line, node + reach, side);
    }
    const Mask same = key == chosen;
    outer = masked(outer, same);
    inner = masked(inner, same);
  }
  const int reach = chosen >> 1, side = chosen & 1;
  std::uint32_t* const before = sums_at<Colours>(line, node - reach, side);
  std::uint32_t* const after = sums_at<Colours>(line, node + reach, side);
  if (pending.key == chosen) {
    add_to(before, plus(outer, pending.inner));
    subtract_from(after, plus(inner, pending.outer));
  } else {
    put_down(line, node, pending);
    add_to(before, outer);
    subtract_from(after, inner);
  }
  pending = {chosen, inner, outer};
  touch(line, node + reach, side);
}

template <class Sum>
SOFTFOCUS_INLINE void run_over(std::uint32_t* slot, FixedSums<Sum>& running) {
  running = plus(running, load_fixed<Sum>(slot));
  store_fixed(slot, FixedSums<Sum>{});
}

/// Corrects the sums of a node with nearly sharp pixels. A pixel that reaches nothing is not
/// among the sums yet: it is added. A pixel with a leakage below 1 takes less from beyond the
/// focus, except of itself.
template <class Colours>
SOFTFOCUS_INLINE void nearly_sharp_sums(const FixedLine& line, int node, Ints edge,
                                        FixedSums<typename Colours::Sum>& near_side,
                                        FixedSums<typename Colours::Sum>& beyond_side) {
  const Ints inner = load(line.inners + node_at(line, node));
  const Ints key = key_of(inner);
  const Mask reaches_nothing = key < 2;
  const Mask in_beyond = (edge < 0) & (key >= 2) & ((key & 1) != 0);
  const auto colour = Colours::load_pixels(colours_at<Colours>(line, node));
  const auto own = plus(Colours::weighed(inner, colour), Colours::weighed(edge, colour));
  near_side = plus(near_side, masked(own, reaches_nothing | in_beyond));
  beyond_side = minus(beyond_side, masked(own, in_beyond));
  if (any((edge < 0) & (beyond_side.weight != 0u))) {
    const Ints below_one = (edge >> kLeakShift & ((1 << kLeakBitsThere) - 1)) |
                           (inner >> (kKeyShift + 7) & 15) << kLeakBitsThere;
    beyond_side = leaked(beyond_side, as_bits(select(inner < 0, splat(1 << 15), below_one)));
  }
}

/// Stores what comes out at a node.
template <class Colours, bool last>
SOFTFOCUS_INLINE void receive(const FixedLine& line, int node,
                              FixedSums<typename Colours::Sum> near_side,
                              FixedSums<typename Colours::Sum> beyond_side, bool any_beyond,
                              std::uint32_t* out) {
  const Ints edge = load(line.edges + node_at(line, node));
  if (sign_bits(edge) != 0) {
    nearly_sharp_sums<Colours>(line, node, edge, near_side, beyond_side);
  }
  if (any_beyond) near_side = plus(near_side, beyond_side);
  Colours::template store_quotients<last>(out, near_side);
}

template <class Colours>
SOFTFOCUS_INLINE void begin_line(FixedLine& line) {
  constexpr std::size_t kSlot =
      sizeof(std::uint32_t) * 2 * static_cast<std::size_t>(Colours::kSumVectors) * kLanes;
  std::memset(line.sums, 0, kSlot * line.sum_slots);
  std::memset(line.running, 0, kSlot);
  line.touched[0] = line.touched[1] = INT32_MIN;
}

/// Adds the kLanes nodes from `node` on, whose pixels already lie in the line, and stores the
/// filtered colours of the kLanes nodes from `node` - reach on. Nodes before `wanted` are left
/// out. `last`: this is the second pass.
template <class Colours, bool last>
void filter_nodes(FixedLine& line, int node, int wanted, std::uint32_t* out) {
  using Sums = FixedSums<typename Colours::Sum>;
  std::uint32_t* const beyond_running = line.running + Colours::kSumVectors * kLanes;
  Sums running[2] = {load_fixed<typename Colours::Sum>(line.running),
                     load_fixed<typename Colours::Sum>(beyond_running)};
  PendingNode<Colours> pending;
  for (int i = 0; i < kLanes; ++i) {
    spread_node(line, node + i, pending);
    const int done = node + i - line.reach;
    // The differences of a pixel end one past its reach.
    const bool any_near = done - 1 <= line.touched[0];
    const bool any_beyond = done - 1 <= line.touched[1];
    if (any_near) run_over(sums_at<Colours>(line, done, 0), running[0]);
    if (any_beyond) run_over(sums_at<Colours>(line, done, 1), running[1]);
    if (done < wanted) continue;
    std::uint32_t* const to = out + i * Colours::kWords * kLanes;
    if (any_near || any_beyond) {
      receive<Colours, last>(line, done, running[0], running[1], any_beyond, to);
    } else {
      Colours::template store_unchanged<last>(to, colours_at<Colours>(line, done));
    }
  }
  put_down(line, node + kLanes, pending);
  store_fixed(line.running, running[0]);
  store_fixed(beyond_running, running[1]);
}
