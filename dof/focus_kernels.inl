// What focus_map.cpp does along rows of pixels.

/// Widens, cell by cell, the ranges of depths of the rows so far by another row's. Depths
/// are halves, compared as integers; a cell has kLanes least and kLanes most ones.
void widen_depths(const std::uint16_t* row, int width, std::uint32_t* ranges) {
  for (int x = 0; x < width; x += kCellWidth, ranges += 2 * kLanes) {
    const int end = x + kCellWidth < width ? x + kCellWidth : width;
    Bits least = load(ranges), most = load(ranges + kLanes);
    int at = x;
    for (; at + kLanes <= end; at += kLanes) {
      const Bits depth = load_half_texels(row + 4 * at).a;
      least = select(depth < least, depth, least);
      most = select(depth > most, depth, most);
    }
    for (; at < end; ++at) {
      const Bits depth = splat(std::uint32_t{row[4 * at + 3]});
      least = select(depth < least, depth, least);
      most = select(depth > most, depth, most);
    }
    store(ranges, least);
    store(ranges + kLanes, most);
  }
}

namespace {

/// What a pixel that gathers only itself becomes: a colour is cut to what a half holds.
SOFTFOCUS_INLINE Bits passed_depth(Bits half) {
  return select((half & 0x7FFFu) > kHalfInfinity, splat(std::uint32_t{kHalfNan}), half);
}
SOFTFOCUS_INLINE Bits passed_colour(Bits half) {
  const Bits cut = half - select((half & 0x7FFFu) == kHalfInfinity, splat(1u), splat(0u));
  return passed_depth(cut);
}

SOFTFOCUS_INLINE void pass_vector(const std::uint16_t* from, std::uint16_t* to) {
  const HalfTexels texels = load_half_texels(from);
  store_half_texels(to, {passed_colour(texels.r), passed_colour(texels.g), passed_colour(texels.b),
                         passed_depth(texels.a)});
}

}  // namespace

/// Copies pixels as what they become if they gather only themselves.
void pass_pixels(const std::uint16_t* from, std::uint16_t* to, int count, bool past_caches) {
  int at = 0;
  for (; at + kLanes <= count; at += kLanes, from += 4 * kLanes, to += 4 * kLanes) {
    // Only what has the largest exponent is changed, and next to nothing has.
    TexelWords words;
    std::memcpy(&words.first, from, sizeof words.first);
    std::memcpy(&words.second, from + 2 * kLanes, sizeof words.second);
    const Bits first = words.first, second = words.second;
    const Mask special = ((first & 0x7C00u) == 0x7C00u) | ((first & 0x7C000000u) == 0x7C000000u) |
                         ((second & 0x7C00u) == 0x7C00u) | ((second & 0x7C000000u) == 0x7C000000u);
    if (any(special)) {
      pass_vector(from, to);
    } else if (past_caches) {
      stream_texel_words(to, words);
    } else {
      store_texel_words(to, words);
    }
  }
  if (at < count) {
    const std::size_t bytes = 4 * sizeof *from * static_cast<std::size_t>(count - at);
    std::uint16_t last[4 * kLanes] = {}, passed[4 * kLanes];
    std::memcpy(last, from, bytes);
    pass_vector(last, passed);
    std::memcpy(to, passed, bytes);
  }
  if (past_caches) finish_streaming();
}
