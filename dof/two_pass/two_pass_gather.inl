// The taps of a line of nodes, in lanes: part of two_pass_strip.cpp.

// Receivers that share their bounds of taps.
constexpr int kBlock = 16;

/// How far taps need which care, for a block of receivers.
struct TapBounds {
  int covered;      ///< up to this distance all taps are whole, at leakage 1
  int covered_all;  ///< up to this distance all taps are whole, at any leakage
  int touched;      ///< past this distance no tap weighs anything
};

SOFTFOCUS_INLINE TapBounds tap_bounds(const GatherNodes& line, int begin, int end, int reach) {
  Ints covered = splat(reach), covered_all = covered, touched = splat(0);
  for (int i = begin - reach; i < end + reach; i += kLanes) {
    // Distance to the nearest receiver. Nodes past the range are too far off to matter.
    const Ints node = lane_numbers() + i;
    const Ints distance = larger(larger(begin - node, node - (end - 1)), splat(1));
    const Ints touches = load(line.touches + i);
    touched = larger(touched, select(touches >= distance, touches, splat(0)));
    covered = smaller(covered, larger(load(line.covers + i), distance - 1));
    covered_all = smaller(covered_all, larger(load(line.covers_all + i), distance - 1));
  }
  TapBounds bounds{reach, reach, 0};
  for (int i = 0; i < kLanes; ++i) {
    bounds.touched = bounds.touched > touched[i] ? bounds.touched : touched[i];
    bounds.covered = bounds.covered < covered[i] ? bounds.covered : covered[i];
    bounds.covered_all = bounds.covered_all < covered_all[i] ? bounds.covered_all : covered_all[i];
  }
  if (bounds.touched > reach) bounds.touched = reach;
  return bounds;
}

/// Adds the tap at a node.
template <bool leaking>
SOFTFOCUS_INLINE void add_tap(const GatherNodes& line, int node, int distance, Floats distance_px,
                              Floats receiver_leakage, Sums& sums) {
  const float* whole = line.whole + node * 4 * kLanes;
  if (distance <= (leaking ? line.covers_all : line.covers)[node]) {
    add_whole(sums, whole, kLanes);
  } else if (distance <= line.touches[node]) {
    const float* part = line.part + node * 4 * kLanes;
    add_part<leaking>(sums, load(part), load(whole), part + kLanes, kLanes, distance_px,
                      receiver_leakage);
  }
}

/// Two receivers at a time: each addition to a sum waits for the one before, and one
/// receiver's four sums would leave the adders half idle.
template <bool leaking>
void gather_pair(const GatherNodes& line, int node, int covered, int touched,
                 const Floats (&leakage_of)[2], Sums (&sums_of)[2]) {
  Sums first = sums_of[0], second = sums_of[1];
  const float* before = line.whole + node * 4 * kLanes;
  const float* after = before;
  int d = 1;
  for (; d <= covered && d <= touched; ++d) {
    before -= 4 * kLanes;
    after += 4 * kLanes;
    add_whole(first, before, kLanes);
    add_whole(second, before + 4 * kLanes, kLanes);
    add_whole(first, after, kLanes);
    add_whole(second, after + 4 * kLanes, kLanes);
  }
  for (; d <= touched; ++d) {
    const Floats distance_px = splat(static_cast<float>(d));
    add_tap<leaking>(line, node - d, d, distance_px, leakage_of[0], first);
    add_tap<leaking>(line, node + 1 - d, d, distance_px, leakage_of[1], second);
    add_tap<leaking>(line, node + d, d, distance_px, leakage_of[0], first);
    add_tap<leaking>(line, node + 1 + d, d, distance_px, leakage_of[1], second);
  }
  sums_of[0] = first;
  sums_of[1] = second;
}

/// Results as two vectors of words: red in the low half and green in the high one; blue.
template <HalfRounding rounding>
struct HalfResults {
  static constexpr int kVectors = 2;
  SOFTFOCUS_INLINE static void put(const Sums& sums, std::uint32_t* to) {
    const HalfColour colour = resolve<rounding>(sums);
    store(to, colour.r | colour.g << 16);
    store(to + kLanes, colour.b);
  }
};
/// Results as three vectors of binary32.
struct FloatResults {
  static constexpr int kVectors = 3;
  SOFTFOCUS_INLINE static void put(const Sums& sums, std::uint32_t* to) {
    const FloatColour colour = resolve(sums);
    store(to, as_bits(colour.r));
    store(to + kLanes, as_bits(colour.g));
    store(to + 2 * kLanes, as_bits(colour.b));
  }
};

/// Filters nodes 0 to count - 1, rounded up to an even number; taps reach `reach` nodes
/// to each side.
template <class Results>
void gather_line(const GatherNodes& line, int count, int reach, float leak,
                 std::uint32_t* gathered) {
  for (int begin = 0; begin < count; begin += kBlock) {
    const int end = begin + kBlock < count ? begin + kBlock : count;
    const TapBounds bounds = tap_bounds(line, begin, end, reach);
    for (int node = begin; node < end; node += 2) {
      Sums sums[2];
      Floats leakages[2];
      Mask leaks = splat(0);
      for (int i = 0; i < 2; ++i) {
        sums[i] = load_sums(line.whole + (node + i) * 4 * kLanes, kLanes);
        leakages[i] = leakage(absolute(load(line.part + (node + i) * 4 * kLanes)), leak);
        leaks = leaks | (leakages[i] < 1.0f);
      }
      if (any(leaks)) {
        gather_pair<true>(line, node, bounds.covered_all, bounds.touched, leakages, sums);
      } else {
        gather_pair<false>(line, node, bounds.covered, bounds.touched, leakages, sums);
      }
      for (int i = 0; i < 2; ++i) {
        Results::put(sums[i], gathered + (node + i) * Results::kVectors * kLanes);
      }
    }
  }
}
