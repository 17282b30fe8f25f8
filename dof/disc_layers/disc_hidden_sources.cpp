#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include <cstring>

#include "dof/disc_layers/disc_hidden_search.h"
#include "raster/numbers/half.h"

#define SOFTFOCUS_KERNELS "dof/disc_layers/disc_hidden_sources.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void hide_row(const HiddenSearch& search, int y, const std::int32_t* left,
              const std::int32_t* right, const ImageView& made, HiddenPicture& hidden, Isa isa) {
  SOFTFOCUS_KERNEL(isa, hide_row)(search, y, left, right, made, hidden);
}

void find_in_row(const HiddenSearch& search, int y, const std::int32_t* left,
                 const std::int32_t* right, std::vector<HiddenTexels>& list, Isa isa) {
  SOFTFOCUS_KERNEL(isa, find_in_row)(search, y, left, right, list);
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

#include "dof/disc_layers/disc_hidden_lanes.inl"

// A vector of a row's pixels: their sources one way, or what they hide.
struct HiddenLanes {
  Ints distance;  // 0: none
  HalfTexels texels;
  Floats radius;
};

SOFTFOCUS_INLINE HalfTexels select_texels(Mask mask, const HalfTexels& yes, const HalfTexels& no) {
  return {select(mask, yes.r, no.r), select(mask, yes.g, no.g), select(mask, yes.b, no.b),
          select(mask, yes.a, no.a)};
}

inline constexpr std::uint16_t kNoTexel[4] = {};
SOFTFOCUS_INLINE HalfTexels splat_texel(const std::uint16_t* from) {
  return {splat(std::uint32_t{from[0]}), splat(std::uint32_t{from[1]}),
          splat(std::uint32_t{from[2]}), splat(std::uint32_t{from[3]})};
}

// The texels at sources in the same row, and the distances to their own. Neighbours share them.
SOFTFOCUS_INLINE void load_along(const HiddenSearch& in, int x, int y, bool leftwards,
                                 HiddenLanes& sources, Ints& own) {
  const std::uint16_t* row = texel_row(in.from, y);
  const Ints place = lane_numbers() + x;
  const Ints source_x = leftwards ? place - sources.distance : place + sources.distance;
  const Mask found = sources.distance != 0;
  alignas(64) std::int32_t places[kLanes];
  store(places, source_x);
  for (unsigned left = lane_bits(found); left != 0;) {
    const int at = places[__builtin_ctz(left)];
    const Mask here = found & (source_x == at);
    sources.texels = select_texels(here, splat_texel(row + 4 * at), sources.texels);
    if (in.second) own = select(here, splat(std::int32_t{in.own[y * in.stride + at]}), own);
    left &= ~lane_bits(here);
  }
}

// Those in the same column.
SOFTFOCUS_INLINE void load_across(const HiddenSearch& in, int x, int y, bool upwards,
                                  HiddenLanes& sources, Ints& own) {
  alignas(64) std::int32_t distances[kLanes];
  store(distances, sources.distance);
  for (unsigned left = lane_bits(sources.distance != 0); left != 0;) {
    const int distance = distances[__builtin_ctz(left)];
    const int from_y = upwards ? y - distance : y + distance;
    const Mask here = sources.distance == distance;
    sources.texels = select_texels(here, load_repeating(texel_row(in.from, from_y), x, in.width),
                                   sources.texels);
    if (in.second) own = select(here, load_shorts(in.own + from_y * in.stride + x), own);
    left &= ~lane_bits(here);
  }
}

// The texels at the sources of a row's pixels from x on, and their radii.
SOFTFOCUS_INLINE void load_sources(const HiddenSearch& in, int x, int y, std::size_t way,
                                   HiddenLanes& sources) {
  sources.texels = splat_texel(kNoTexel);
  Ints own = splat(0);
  if (way < 2) {
    load_along(in, x, y, way == 0, sources, own);
  } else {
    load_across(in, x, y, way == 2, sources, own);
  }
  sources.radius = split_radius(in.settings, half_to_float(sources.texels.a));
  if (!in.second) return;
  // Leaves out those to which the way by their own source is longer than the circle reaches.
  sources.radius = larger(sources.radius, splat(-1.0f));
  const Floats here = to_floats(sources.distance), beyond = to_floats(own);
  const Floats reach = 1.0f - load(in.radii_row(y) + x);
  const Mask far = here * here + beyond * beyond > reach * reach;
  sources.distance = select(far, splat(0), sources.distance);
}

// The mean of those sources of each pixel that have about the depth of the nearest, for pixels
// that have several.
SOFTFOCUS_INLINE void mix_sources(const HiddenLanes* sources, HiddenLanes& hidden) {
  const Floats step = step_behind(hidden.radius);
  Floats sums[3] = {splat(0.0f), splat(0.0f), splat(0.0f)}, weights = splat(0.0f);
  Ints count = splat(0);
  for (std::size_t way = 0; way < kHiddenWays; ++way) {
    const HiddenLanes& source = sources[way];
    if (!any(source.distance != 0)) continue;
    const Mask counts = (source.distance != 0) & ~(absolute(source.radius - hidden.radius) > step);
    const Ints square = select(counts, source.distance * source.distance, splat(1));
    const Floats weight = select(counts, 1.0f / to_floats(square), splat(0.0f));
    sums[0] += finite_colour(source.texels.r) * weight;
    sums[1] += finite_colour(source.texels.g) * weight;
    sums[2] += finite_colour(source.texels.b) * weight;
    weights += weight;
    count -= counts;
  }
  const Mask several = count > 1;
  const Floats whole = select(several, weights, splat(1.0f));
  constexpr HalfRounding kRounding = HalfRounding::nearest_even;
  hidden.texels.r = select(several, float_to_half<kRounding>(sums[0] / whole), hidden.texels.r);
  hidden.texels.g = select(several, float_to_half<kRounding>(sums[1] / whole), hidden.texels.g);
  hidden.texels.b = select(several, float_to_half<kRounding>(sums[2] / whole), hidden.texels.b);
}

SOFTFOCUS_INLINE Ints load_distances(const HiddenSearch& in, std::size_t way, int x, int y,
                                     const std::int32_t* left, const std::int32_t* right) {
  const std::ptrdiff_t at = y * in.stride + x;
  if (way == 0) return load(left + x);
  if (way == 1) return load(right + x);
  return load_shorts((way == 2 ? in.above : in.below) + at);
}

// Blends the light that pixels from x on hide. Returns whether they hide anything.
SOFTFOCUS_INLINE bool blend_sources(const HiddenSearch& in, int x, int y, const std::int32_t* left,
                                    const std::int32_t* right, HiddenLanes& hidden) {
  const unsigned ways = in.known_row(y)[x / kStrip].ways;
  const Mask inside = lane_numbers() < in.width - x;
  HiddenLanes sources[kHiddenWays];
  const Ints none = splat(1 << 30);
  hidden.distance = none;
  hidden.radius = splat(0.0f);
  hidden.texels = splat_texel(kNoTexel);
  Mask several = splat(0);
  for (std::size_t way = 0; way < kHiddenWays; ++way) {
    HiddenLanes& source = sources[way];
    source.distance = splat(0);
    if ((ways >> way & 1u) == 0) continue;
    source.distance = load_distances(in, way, x, y, left, right) & inside;
    if (!any(source.distance != 0)) continue;
    load_sources(in, x, y, way, source);
    const Mask found = source.distance != 0;
    several |= found & (hidden.distance != none);
    const Mask first = found & (source.distance < hidden.distance);
    hidden.texels = select_texels(first, source.texels, hidden.texels);
    hidden.radius = select(first, source.radius, hidden.radius);
    hidden.distance = select(first, source.distance, hidden.distance);
  }
  const Mask found = hidden.distance != none;
  hidden.distance &= found;
  if (any(several)) mix_sources(sources, hidden);
  hidden.radius = larger(hidden.radius, splat(-1.0f));
  return any(found);
}

// Hides what a vector of pixels has found. Returns where.
SOFTFOCUS_INLINE Mask hide_vector(const HiddenSearch& in, int x, int y, const HiddenLanes& lanes,
                                  const ImageView& made) {
  const Mask found = lanes.distance != 0;
  const HalfTexels old = load_repeating(texel_row(in.scene, y), x, in.width);
  auto* to = reinterpret_cast<std::uint16_t*>(made.texels + y * made.stride_bytes);
  store_half_texels(to + 4 * x, select_texels(found, lanes.texels, old));
  store_shorts(in.own + y * in.stride + x, lanes.distance);
  float* radii = in.radii_row(y) + x;
  store(radii, select(found, lanes.radius, load(radii)));
  return found;
}

// Marks blocks of `hidden`'s rows in which lanes from x on are set.
SOFTFOCUS_INLINE void mark_blocks(HiddenPicture& hidden, int x, int y, Mask found) {
  std::uint8_t* blocks =
      hidden.blocks.data() + std::ptrdiff_t{y / kDiscBlock} * hidden.block_columns;
  const unsigned bits = lane_bits(found);
  for (int i = 0; i < kLanes; i += kDiscBlock) {
    if ((bits >> i & 0xFFu) != 0) blocks[(x + i) / kDiscBlock] = 1;
  }
}

}  // namespace

/// Hides what a row's pixels have found.
void hide_row(const HiddenSearch& search, int y, const std::int32_t* left,
              const std::int32_t* right, const ImageView& made, HiddenPicture& hidden) {
  const HiddenSearch in = search;  // bytes are stored, which might change it
  HiddenStrip* known = in.known_row(y);
  std::uint8_t* strips = hidden.strips.data() + std::ptrdiff_t{y} * hidden.strip_columns;
  for (int strip = 0; strip < in.strips; ++strip) {
    if (known[strip].ways == 0) continue;
    Mask near = splat(0), any_found = splat(0);
    for (int x = strip * kStrip; x < (strip + 1) * kStrip; x += kLanes) {
      HiddenLanes lanes;
      blend_sources(in, x, y, left, right, lanes);
      const Mask found = hide_vector(in, x, y, lanes, made);
      near |= load(in.radii_row(y) + x) < -1.0f;
      any_found |= found;
      mark_blocks(hidden, x, y, found);
    }
    known[strip].near = any(near);
    known[strip].ways = 0;
    if (!any(any_found)) continue;
    known[strip].hidden = 1;
    hidden.rows[static_cast<std::size_t>(y)] = 1;
    strips[strip] = 1;
  }
}

/// Lists what a row's pixels have found.
void find_in_row(const HiddenSearch& search, int y, const std::int32_t* left,
                 const std::int32_t* right, std::vector<HiddenTexels>& list) {
  const HiddenSearch in = search;  // bytes are stored, which might change it
  const HiddenStrip* known = in.known_row(y);
  for (int strip = 0; strip < in.strips; ++strip) {
    if (known[strip].ways == 0) continue;
    for (int x = strip * kStrip; x < (strip + 1) * kStrip; x += kLanes) {
      HiddenLanes lanes;
      if (!blend_sources(in, x, y, left, right, lanes)) continue;
      HiddenTexels& found = list.emplace_back();
      found.x = x;
      found.y = y;
      found.bits = lane_bits(lanes.distance != 0);
      store_half_texels(found.texels, lanes.texels);
    }
  }
}

#endif
