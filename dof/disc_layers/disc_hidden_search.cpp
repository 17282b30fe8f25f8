#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/disc_layers/disc_hidden_search.h"

#include <cstdlib>
#include <cstring>

#include "raster/numbers/half.h"

#define SOFTFOCUS_KERNELS "dof/disc_layers/disc_hidden_search.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void split_row(const HiddenSearch& search, int y, Isa isa) {
  SOFTFOCUS_KERNEL(isa, split_row)(search, y);
}

void sweep_columns(const HiddenSearch& search, int first, int end, Isa isa) {
  SOFTFOCUS_KERNEL(isa, sweep_columns)(search, first, end);
}

bool sweep_along(const HiddenSearch& search, int y, std::int32_t* left, std::int32_t* right,
                 Isa isa) {
  return SOFTFOCUS_KERNEL(isa, sweep_along)(search, y, left, right);
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

#include "dof/disc_layers/disc_hidden_lanes.inl"

SOFTFOCUS_INLINE Floats scene_radii(const HiddenSearch& in, int x, int y) {
  return split_radius(in.settings,
                      half_to_float(load_repeating(texel_row(in.scene, y), x, in.width).a));
}

// Whether any pixel of a strip may be near.
SOFTFOCUS_INLINE bool may_be_near(const HiddenSearch& in, const std::uint16_t* row, int strip) {
  Mask near = splat(0);
  for (int x = strip * kStrip; x < (strip + 1) * kStrip; x += kLanes) {
    const Bits depth = load_repeating(row, x, in.width).a;
    near |= (depth < in.first_far) | (depth > 0x7FFFu);
  }
  return any(near);
}

// Keeps the radii of a strip.
SOFTFOCUS_INLINE void split_strip(const HiddenSearch& in, int strip, int y) {
  float* to = in.radii_row(y);
  Mask near = splat(0);
  for (int x = strip * kStrip; x < (strip + 1) * kStrip; x += kLanes) {
    const Floats radius = scene_radii(in, x, y);
    store(to + x, radius);
    near |= radius < -1.0f;
  }
  HiddenStrip& known = in.known_row(y)[strip];
  known.near = any(near);
  known.split = 1;
  if (strip == 0) to[-1] = to[0];
  if (strip == in.strips - 1) to[in.strips * kStrip] = to[in.width - 1];
}

// --- along rows ---

// State of a sweep along a row: the source it has met, and near pixels alone since.
struct Way {
  bool open;
  int source_x;
};

// The lanes from `begin` on that a way leads over, up to the next of `resets`. `begin` may be
// the lane before the first.
template <bool upwards>
SOFTFOCUS_INLINE Mask lanes_of_way(int begin, unsigned resets) {
  const Ints lane = lane_numbers();
  if constexpr (upwards) {
    const unsigned beyond = resets >> (begin + 1);
    return (lane >= begin) & (lane < (beyond == 0 ? kLanes : begin + 1 + __builtin_ctz(beyond)));
  } else {
    const unsigned beyond = resets & ((1u << begin) - 1u);
    return (lane <= begin) & (lane > (beyond == 0 ? -1 : 31 - __builtin_clz(beyond)));
  }
}

// Whether a way from lane `begin` on leads to the next vector.
template <bool upwards>
SOFTFOCUS_INLINE bool leads_on(int begin, unsigned resets) {
  return (upwards ? resets >> (begin + 1) : resets & ((1u << begin) - 1u)) == 0;
}

// The distances of a vector of pixels to their sources on one side. Returns whether any has one.
template <bool upwards>
SOFTFOCUS_INLINE bool sweep_vector_along(const HiddenSearch& in, const float* row, int x, int y,
                                         Way& way, std::int32_t* distances) {
  constexpr int kBack = upwards ? -1 : 1, kBefore = upwards ? -1 : kLanes;
  const Floats radius = load(row + x), limit = radius + step_behind(radius);
  const Mask near = radius < -1.0f;
  const unsigned begins = lane_bits(near & (load(row + x + kBack) > limit));
  const int nearest = std::abs(x + kBefore - kBack - way.source_x);
  if (static_cast<float>(nearest) > in.most) way.open = false;  // no circle reaches farther
  if (begins == 0 && !way.open) {
    store(distances + x, splat(0));
    return false;
  }
  const unsigned resets = begins | (~lane_bits(near) & kAllLaneBits);
  Ints source_x = splat(0);
  Floats source = splat(-1e9f);  // behind nothing
  if (way.open) {
    const Mask over = lanes_of_way<upwards>(kBefore, resets);
    source_x = select(over, splat(way.source_x), source_x);
    source = select(over, splat(row[way.source_x]), source);
    way.open = leads_on<upwards>(kBefore, resets);
  }
  for (unsigned left = begins; left != 0; left &= left - 1) {
    const int begin = __builtin_ctz(left), at = x + begin + kBack;
    const Mask over = lanes_of_way<upwards>(begin, resets);
    source_x = select(over, splat(at), source_x);
    source = select(over, splat(row[at]), source);
    if (leads_on<upwards>(begin, resets)) way = {true, at};
    __builtin_prefetch(texel_row(in.from, y) + 4 * at);
  }
  const Ints distance = upwards ? lane_numbers() + x - source_x : source_x - (lane_numbers() + x);
  const Mask found = (to_floats(distance) <= 1.0f - radius) & (source > limit);
  store(distances + x, select(found, distance, splat(0)));
  return any(found);
}

template <bool upwards>
SOFTFOCUS_INLINE bool sweep_row(const HiddenSearch& in, int y, std::int32_t* distances) {
  HiddenStrip* known = in.known_row(y);
  const float* row = in.radii_row(y);
  bool any_found = false;
  Way way{false, 0};
  for (int i = 0; i < in.strips; ++i) {
    const int strip = upwards ? i : in.strips - 1 - i;
    if (known[strip].near == 0) {
      way.open = false;
      continue;
    }
    bool found = false;
    for (int j = 0; j < kVectors; ++j) {
      const int vector = upwards ? j : kVectors - 1 - j;
      found |=
          sweep_vector_along<upwards>(in, row, strip * kStrip + vector * kLanes, y, way, distances);
    }
    if (found) {
      known[strip].ways |= upwards ? kWayLeft : kWayRight;
      const std::uint16_t* texels = texel_row(in.scene, y) + 4 * strip * kStrip;
      __builtin_prefetch(texels);
      __builtin_prefetch(texels + 32);
    }
    any_found |= found;
  }
  return any_found;
}

// --- along columns ---

// The state of a sweep up or down.
struct SweptStrip {
  bool active;  // whether any pixel has a source that it may reach
  Floats sources[kVectors], ways[kVectors];
};

template <bool downwards>
SOFTFOCUS_INLINE void sweep_strip(const HiddenSearch& in, int strip, int y, SweptStrip& swept) {
  constexpr int kBack = downwards ? -1 : 1, kAhead = 8;
  HiddenStrip* known = in.known_row(y) + strip;
  const int y_ahead = y - kAhead * kBack;
  if (y_ahead >= 0 && y_ahead < in.height && known[-kAhead * kBack * in.strips].near != 0) {
    __builtin_prefetch(in.radii_row(y_ahead) + strip * kStrip);
  }
  if (known->near == 0) {
    swept.active = false;
    return;
  }
  // In the second round all sources are hidden pixels.
  if (!swept.active && in.second && known[kBack * in.strips].hidden == 0) return;
  const float* row = in.radii_row(y) + strip * kStrip;
  const float* back = row + kBack * in.stride;
  const bool back_known = known[kBack * in.strips].split != 0;
  const Floats none = splat(1e9f);
  Mask open = splat(0), any_found = splat(0);
  Ints rounded[kVectors];
  for (int i = 0; i < kVectors; ++i) {
    const Floats radius = load(row + i * kLanes);
    const Floats before = back_known ? load(back + i * kLanes)
                                     : scene_radii(in, strip * kStrip + i * kLanes, y + kBack);
    const Floats limit = radius + step_behind(radius);
    const Mask near = radius < -1.0f, begins = near & (before > limit);
    Floats source = before, way = select(begins, splat(1.0f), none);
    if (swept.active) {
      const Floats on = swept.ways[i] + 1.0f;
      const Mask goes_on = near & ~begins & (on <= in.most);
      source = select(goes_on, swept.sources[i], before);
      way = select(goes_on, on, way);
    }
    const Mask found = (way <= 1.0f - radius) & (source > limit);
    rounded[i] = truncate(select(found, way, splat(0.0f)));
    swept.sources[i] = source;
    swept.ways[i] = way;
    open |= way < none;
    any_found |= found;
  }
  swept.active = any(open);
  if (!any(any_found)) return;
  known->ways |= downwards ? kWayAbove : kWayBelow;
  std::uint16_t* distances = (downwards ? in.above : in.below) + y * in.stride + strip * kStrip;
  for (int i = 0; i < kVectors; ++i) store_shorts(distances + i * kLanes, rounded[i]);
}

}  // namespace

/// Finds a row's near strips, and keeps the radii of those and of strips beside them.
void split_row(const HiddenSearch& search, int y) {
  const HiddenSearch in = search;  // bytes are stored, which might change it
  const std::uint16_t* row = texel_row(in.scene, y);
  bool before = false, here = may_be_near(in, row, 0);
  for (int strip = 0; strip < in.strips; ++strip) {
    const bool next = strip + 1 < in.strips && may_be_near(in, row, strip + 1);
    if (before || here || next) split_strip(in, strip, y);
    before = here;
    here = next;
  }
}

/// Looks up and down strips side by side.
void sweep_columns(const HiddenSearch& search, int first, int end) {
  const HiddenSearch in = search;  // bytes are stored, which might change it
  SweptStrip swept[kSweptStrips] = {};
  for (int y = 1; y < in.height; ++y) {
    for (int strip = first; strip < end; ++strip) {
      sweep_strip<true>(in, strip, y, swept[strip - first]);
    }
  }
  for (SweptStrip& strip : swept) strip.active = false;
  for (int y = in.height - 2; y >= 0; --y) {
    for (int strip = first; strip < end; ++strip) {
      sweep_strip<false>(in, strip, y, swept[strip - first]);
    }
  }
}

/// Looks along a row. Returns whether any pixel has a source, above and below too.
bool sweep_along(const HiddenSearch& search, int y, std::int32_t* left, std::int32_t* right) {
  const HiddenSearch in = search;  // bytes are stored, which might change it
  const HiddenStrip* known = in.known_row(y);
  bool any_hidden = !in.second, any_found = false;
  for (int strip = 0; strip < in.strips; ++strip) {
    any_hidden |= known[strip].hidden != 0;
    any_found |= known[strip].ways != 0;
  }
  if (!any_hidden) return any_found;
  any_found |= sweep_row<true>(in, y, left);
  any_found |= sweep_row<false>(in, y, right);
  return any_found;
}

#endif
