#pragma once
// A walk along a row or a column, in the order compatible with occlusion, that fills the gaps
// between neighbours. Places are floats, or integers of 256ths of a texel; depths are metres in
// floats, or codes.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "scenes/relief/warp/resample.h"

namespace softfocus {

/// Colours of two texels, mixed by 256ths, rounded to nearest: lerp_unorm8() of four channels, two
/// by two.
[[gnu::always_inline]] inline std::uint32_t mix_colours(std::uint32_t a, std::uint32_t b,
                                                        std::uint32_t weight) {
  if (a == b) return a;
  const std::uint32_t even = (a & 0xFF00FFu) * (256 - weight) + (b & 0xFF00FFu) * weight;
  const std::uint32_t odd = (a >> 8 & 0xFF00FFu) * (256 - weight) + (b >> 8 & 0xFF00FFu) * weight;
  return ((even + 0x800080u) >> 8 & 0xFF00FFu) | ((odd + 0x800080u) & 0xFF00FF00u);
}

/// The arithmetic of floats.
struct FloatPlaces {
  using Place = float;
  using Depth = float;
  PreWarp warp;
  float most_m;       ///< the last depth
  float join_texels;  ///< neighbours that come farther apart are not joined

  static int floor(float place) {
    const int whole = static_cast<int>(place);
    return whole - (place < static_cast<float>(whole) ? 1 : 0);
  }
  static int ceil(float place) { return -floor(-place); }
  static float place_of(int texel) { return static_cast<float>(texel); }
  /// How far a texel is on its way from one place to another, 0 to 1.
  static float share(int texel, float from, float to) {
    return (static_cast<float>(texel) - from) / (to - from);
  }
  static std::uint32_t weight(float share) {
    return static_cast<std::uint32_t>(share * 256.0f + 0.5f);
  }
  static float mix(float a, float b, float share) { return a + share * (b - a); }
  float half_texel(float depth) const { return 0.5f / (1.0f + warp.k3 * depth); }
  float place_in_column(int v, float depth) const {
    const WarpedDepth at = warped_depth(warp, depth);
    return (static_cast<float>(v) + at.shift_v) * at.scale;
  }
  float compensated(int v, float place, float otherwise) const {
    const float depth = compensated_depth(warp, static_cast<float>(v), place, otherwise);
    return depth > 0.0f ? std::min(depth, most_m) : 0.0f;
  }
  static float metres(float depth) { return depth; }
};

/// The arithmetic of integers. Shares are 256ths.
struct FixedPlaces {
  using Place = std::int32_t;
  using Depth = std::int32_t;
  const FixedDepth* table;
  std::int32_t last_code;
  float step_m;
  std::int64_t k2, k3;       ///< of a code: 2^-40 and 2^-32
  std::int32_t join_texels;  ///< in 256ths

  static int floor(std::int32_t place) { return place >> 8; }
  static int ceil(std::int32_t place) { return (place + 255) >> 8; }
  static std::int32_t place_of(int texel) { return texel * 256; }
  static std::int32_t share(int texel, std::int32_t from, std::int32_t to) {
    const std::int32_t way = to - from, gone = texel * 256 - from;
    // Up to 16384 texels; a quotient of 64 bits takes several times as long.
    if (way < 1 << 22 && way > -(1 << 22)) return (gone * 256 + way / 2) / way;
    return static_cast<std::int32_t>((std::int64_t{gone} * 256 + way / 2) / way);
  }
  static std::uint32_t weight(std::int32_t share) { return static_cast<std::uint32_t>(share); }
  static std::int32_t mix(std::int32_t a, std::int32_t b, std::int32_t share) {
    return a + static_cast<std::int32_t>((std::int64_t{share} * (b - a) + 128) >> 8);
  }
  std::int32_t half_texel(std::int32_t code) const { return table[code].scale >> 9; }
  std::int32_t place_in_column(int v, std::int32_t code) const {
    return fixed_place(v * 256, table[code].shift_v, table[code].scale);
  }
  /// The code next to compensated_depth().
  std::int32_t compensated(int v, std::int32_t place, std::int32_t otherwise) const {
    const std::int64_t below = k2 - place * k3;
    if (below == 0) return otherwise;
    const std::int64_t code = (std::int64_t{place - v * 256} << 32) / below;
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(code, 0, last_code));
  }
  float metres(std::int32_t code) const { return static_cast<float>(code) * step_m; }
};

/// A texel on its walk.
template <class Numbers>
struct WalkTexel {
  typename Numbers::Place along;   ///< where it comes to lie on the walk's own axis
  typename Numbers::Place across;  ///< in a row's walk: where within its column
  typename Numbers::Depth depth;
  std::uint32_t colour;
};

/// The texels that a walk may write: begin <= x < end.
struct WalkLimits {
  int begin, end;
};

/// The last texel that a step to `place` reaches; `sign` -1 walks towards smaller numbers. A step
/// fills the texels past the last one that the place where it began reaches.
template <class Numbers, int sign, class Place>
[[gnu::always_inline]] inline int last_reached(Place place) {
  return sign > 0 ? Numbers::floor(place) : Numbers::ceil(place);
}

/// Cuts a step, from the texel after `from` to `to`, to what may be written.
template <int sign>
[[gnu::always_inline]] inline WalkLimits step_within(int from, int to, const WalkLimits& limits) {
  return sign > 0 ? WalkLimits{std::max(from + 1, limits.begin), std::min(to, limits.end - 1)}
                  : WalkLimits{std::min(from - 1, limits.end - 1), std::max(to, limits.begin)};
}

/// Puts one texel's colour everywhere between two places.
template <class Numbers, int sign, class Place, class Put>
inline void fill_flat(const WalkTexel<Numbers>& texel, Place from, Place to,
                      const WalkLimits& limits, const Put& put) {
  const WalkLimits between =
      step_within<sign>(last_reached<Numbers, sign>(from), last_reached<Numbers, sign>(to), limits);
  for (int x = between.begin; sign * x <= sign * between.end; x += sign) {
    put(x, texel.colour, texel.across, texel.depth, false);
  }
}

/// Fills the way between two neighbours, whose last texels reached are known.
template <class Numbers, int sign, class Put>
[[gnu::always_inline]] inline void fill_between(const WalkTexel<Numbers>& from,
                                                const WalkTexel<Numbers>& to, int from_reached,
                                                int to_reached, const WalkLimits& limits,
                                                const Put& put) {
  const WalkLimits between = step_within<sign>(from_reached, to_reached, limits);
  const bool apart = sign * (to.along - from.along) > Numbers::place_of(kApart);
  for (int x = between.begin; sign * x <= sign * between.end; x += sign) {
    const auto share = Numbers::share(x, from.along, to.along);
    put(x, mix_colours(from.colour, to.colour, Numbers::weight(share)),
        Numbers::mix(from.across, to.across, share), Numbers::mix(from.depth, to.depth, share),
        apart);
  }
}

/// A step from one neighbour to the next. Either may be missing: `is_from`, `is_there`. If the run
/// goes on, the step fills the way; else a run ends half a texel past `from`, and another begins
/// half a texel before `texel`.
template <class Numbers, int sign, class Put>
inline void step(const Numbers& numbers, bool is_from, const WalkTexel<Numbers>& from,
                 bool is_there, const WalkTexel<Numbers>& texel, const WalkLimits& limits,
                 const Put& put) {
  const auto way = sign * (texel.along - from.along);
  if (is_from && is_there && way >= 0 && way <= numbers.join_texels) {
    fill_between<Numbers, sign>(from, texel, last_reached<Numbers, sign>(from.along),
                                last_reached<Numbers, sign>(texel.along), limits, put);
    return;
  }
  if (is_from) {
    const auto half = numbers.half_texel(from.depth);
    fill_flat<Numbers, sign>(from, from.along, from.along + sign * half, limits, put);
  }
  if (is_there) {
    const auto half = numbers.half_texel(texel.depth);
    fill_flat<Numbers, sign>(texel, texel.along - sign * half, texel.along, limits, put);
  }
}

/// Walks from texel `begin` to before `end`. `get(i, texel)` says whether texel i shows something.
template <class Numbers, int sign, class Get, class Put>
inline void walk(const Numbers& numbers, int begin, int end, const WalkLimits& limits,
                 const Get& get, const Put& put) {
  WalkTexel<Numbers> from{}, texel{};
  bool is_from = false;
  for (int i = begin; sign * i < sign * end; i += sign) {
    const bool is_there = get(i, texel);
    step<Numbers, sign>(numbers, is_from, from, is_there, texel, limits, put);
    from = texel;
    is_from = is_there;
  }
  step<Numbers, sign>(numbers, is_from, from, false, texel, limits, put);
}

/// The first texel of a row or a column that is walked from the end: the walks meet before it.
inline int walk_split(int begin, int end, double epipole) {
  const double last = epipole < begin ? begin - 1.0 : (epipole >= end ? end - 1.0 : epipole);
  return static_cast<int>(std::floor(last)) + 1;
}

/// Both walks of a row or a column: from its borders to the epipole, or, if texels move away from
/// it, from the epipole outwards. Each goes from its first texel to before its end, the backward
/// one downwards.
struct HalfWalks {
  WalkLimits forward, backward;
};
inline HalfWalks half_walks(int begin, int end, double epipole, bool outwards) {
  const int split = walk_split(begin, end, epipole);
  if (outwards) return {{split, end}, {split - 1, begin - 1}};
  return {{begin, split}, {end - 1, split - 1}};
}

template <class Numbers, class Get, class Put>
inline void walk_both(const Numbers& numbers, const HalfWalks& walks, const WalkLimits& limits,
                      const Get& get, const Put& put) {
  walk<Numbers, 1>(numbers, walks.forward.begin, walks.forward.end, limits, get, put);
  walk<Numbers, -1>(numbers, walks.backward.begin, walks.backward.end, limits, get, put);
}

}  // namespace softfocus
