// Colours of 10 bits on the lines of dof/fixed_pictures/fixed_line_kernels.inl, and sums of them.

/// Weight and colours, each times a weight.
template <class Sum>
struct FixedSums {
  Bits weight;
  Sum r, g, b;
};

/// A weight that the table's word holds in two parts.
SOFTFOCUS_INLINE Ints split_weight(Ints word) { return word & kSplitMask; }
SOFTFOCUS_INLINE Bits joined_weight(Ints split) {
  return as_bits(multiply_add_pairs(split, splat(1 << (16 + kSplitBits) | 1)));
}

// Sums of 32 bits, as those of dof/fixed_pictures/fixed_half_colours.inl of 64.

SOFTFOCUS_INLINE Bits kept(Bits sum, Mask mask) { return sum & as_bits(mask); }
SOFTFOCUS_INLINE void load_sum(const std::uint32_t* from, Bits& sum) { sum = load(from); }
SOFTFOCUS_INLINE void store_sum(std::uint32_t* to, Bits sum) { store(to, sum); }

/// floor(sum leak), leak Q1.15, sum below 2^31.
SOFTFOCUS_INLINE Bits leaked(Bits sum, Bits leak) {
  return (sum >> 15) * leak + ((sum & 0x7FFFu) * leak >> 15);
}

/// The three of a pixel in a word, red in the lowest bits.
struct SmallColours {
  static constexpr int kWords = kSmallColourWords;
  static constexpr int kSumVectors = kSmallSumVectors;
  using Sum = Bits;
  using Pixels = Bits;

  SOFTFOCUS_INLINE static Pixels load_pixels(const std::uint32_t* words) { return load(words); }

  /// A colour times a weight, c l + 2^5 c h: 2^5 c has 15 bits.
  SOFTFOCUS_INLINE static Bits times(Bits c, Ints split) {
    return as_bits(multiply_add_pairs(as_ints(c | c << (16 + kSplitBits)), split));
  }
  SOFTFOCUS_INLINE static FixedSums<Bits> weighed(Ints word, Pixels colour) {
    const Ints split = split_weight(word);
    return {joined_weight(split), times(colour & 0x3FFu, split),
            times(colour >> 10 & 0x3FFu, split), times(colour >> 20, split)};
  }

  /// floor(sum / weight) below 1024. The reciprocal is too small by 2^-13 to 7 2^-13 of it, which
  /// is more than floats round away and less than a step: the estimate is right or less by one,
  /// and the remainder tells.
  SOFTFOCUS_INLINE static Bits quotient(Bits sum, Bits weight, Floats reciprocal) {
    const Ints estimate = truncate(to_floats(as_ints(sum)) * reciprocal);
    const Ints rest = as_ints(sum) - estimate * as_ints(weight);
    return as_bits(select(rest >= as_ints(weight), estimate + 1, estimate));
  }

  /// Stores colours of 10 bits, or after the last pass of 8.
  template <bool last>
  SOFTFOCUS_INLINE static void store_quotients(std::uint32_t* words, const FixedSums<Bits>& sums) {
    constexpr int kBits = last ? 8 : 10;
    constexpr int kCut = 10 - kBits;
    const Bits weight = sums.weight;
    const Floats reciprocal = rough_reciprocal(to_floats(as_ints(weight))) * (1.0f - 0x1p-11f);
    const Bits half = last ? weight << 1 : weight >> 1;
    store(words, quotient((sums.r + half) >> kCut, weight, reciprocal) |
                     quotient((sums.g + half) >> kCut, weight, reciprocal) << kBits |
                     quotient((sums.b + half) >> kCut, weight, reciprocal) << 2 * kBits);
  }

  /// What store_quotients() stores of pixels that nothing is added to.
  template <bool last>
  SOFTFOCUS_INLINE static void store_unchanged(std::uint32_t* words, const std::uint32_t* from) {
    const Bits colour = load(from);
    if constexpr (!last) {
      store(words, colour);
    } else {
      const Bits rounded = colour + (2u | 2u << 10 | 2u << 20);  // up to 1022: no carry
      store(words, (rounded >> 2 & 0xFFu) | (rounded >> 4 & 0xFF00u) | (rounded >> 6 & 0xFF0000u));
    }
  }
};
