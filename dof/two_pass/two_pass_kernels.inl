// Both passes of the two-pass filter over a strip, vectors at a time.

namespace {

#include "dof/repeating_texels.inl"
#include "dof/weights.inl"

#include "dof/two_pass/gather_line.inl"

/// The reach of as many nodes as there are lanes, one a lane.
struct NodeExtent {
  Floats smallest, largest;  // radii
  Bits signs;
};
SOFTFOCUS_INLINE NodeExtent no_extent() { return {splat(0x1p20f), splat(0.0f), splat(0u)}; }
SOFTFOCUS_INLINE void widen(NodeExtent& extent, Floats signed_radius_px) {
  const Floats radius = absolute(signed_radius_px);
  extent.smallest = smaller(extent.smallest, radius);
  extent.largest = larger(extent.largest, radius);
  extent.signs = extent.signs | as_bits(signed_radius_px);
}

// overlap(r, d) is 1 where r - d >= 1, of exact or rounded difference, and is 0 where
// r <= d.
SOFTFOCUS_INLINE Ints covers(const NodeExtent& extent) {
  return larger(truncate(extent.smallest) - 1, splat(0));
}
SOFTFOCUS_INLINE Ints covers_all(const NodeExtent& extent) {
  return select(as_ints(extent.signs) < 0, splat(0), covers(extent));
}
SOFTFOCUS_INLINE Ints touches(const NodeExtent& extent) {
  const Ints whole = truncate(extent.largest);
  return larger(whole + (to_floats(whole) == extent.largest), splat(0));
}

SOFTFOCUS_INLINE void store_part(const GatherNodes& nodes, int node, Floats r, Floats g, Floats b,
                                 Floats intensity_of_node) {
  float* part = nodes.part + node * 4 * kLanes;
  store(part + kLanes, r);
  store(part + 2 * kLanes, g);
  store(part + 3 * kLanes, b);
  float* whole = nodes.whole + node * 4 * kLanes;
  store(whole + kLanes, r * intensity_of_node);
  store(whole + 2 * kLanes, g * intensity_of_node);
  store(whole + 3 * kLanes, b * intensity_of_node);
}

/// Makes nodes `at` to `at` + kLanes - 1 of the line along x from as many rows. Those of
/// the strip itself leave radius, intensity and depth in the lines along y: vector
/// `column` of them, or none if that is negative.
SOFTFOCUS_INLINE void load_block(const Strip& strip, const DofSettings& settings,
                                 const std::uint16_t* const* rows, int x, int at, int column,
                                 int node) {
  Floats r[kLanes], g[kLanes], b[kLanes], radius[kLanes], light[kLanes];
  NodeExtent across = no_extent(), down = no_extent();
  for (int i = 0; i < kLanes; ++i) {
    // Rows lie too far apart for the hardware to see what comes next.
    __builtin_prefetch(rows[kLanes + i] + 4 * x);
    if constexpr (kLanes == 16) __builtin_prefetch(rows[kLanes + i] + 4 * x + 32);
    const HalfTexels texels = load_repeating(rows[i], x, strip.picture_width);
    r[i] = half_to_float(texels.r);
    g[i] = half_to_float(texels.g);
    b[i] = half_to_float(texels.b);
    radius[i] = signed_radius(settings, half_to_float(texels.a));
    light[i] = intensity(absolute(radius[i]));
    widen(across, radius[i]);
    if (column >= 0) {
      const int to = column * strip.capacity + node + i;
      store(strip.down.part + to * 4 * kLanes, radius[i]);
      store(strip.down.whole + to * 4 * kLanes, light[i]);
      store(strip.depths + to * kLanes, stored_depth(texels.a));
    }
  }
  transpose(r);
  transpose(g);
  transpose(b);
  transpose(radius);
  transpose(light);
  for (int i = 0; i < kLanes; ++i) {
    widen(down, radius[i]);
    store(strip.across.part + (at + i) * 4 * kLanes, radius[i]);
    store(strip.across.whole + (at + i) * 4 * kLanes, light[i]);
    store_part(strip.across, at + i, r[i], g[i], b[i], light[i]);
  }
  store(strip.across.covers + at, covers(across));
  store(strip.across.covers_all + at, covers_all(across));
  store(strip.across.touches + at, touches(across));
  if (column >= 0) {
    const int to = column * strip.capacity + node;
    store(strip.down.covers + to, covers(down));
    store(strip.down.covers_all + to, covers_all(down));
    store(strip.down.touches + to, touches(down));
  }
}

SOFTFOCUS_INLINE GatherNodes nodes_from(const GatherNodes& nodes, int node) {
  return {nodes.whole + node * 4 * kLanes, nodes.part + node * 4 * kLanes, nodes.covers + node,
          nodes.covers_all + node, nodes.touches + node};
}

void gather(const StripFilter& filter, const GatherNodes& line, int count, int reach,
            std::uint32_t* gathered) {
  if (filter.rounding == HalfRounding::nearest_even) {
    gather_line<HalfResults<HalfRounding::nearest_even>>(line, count, reach, filter.settings.leak,
                                                         gathered);
  } else {
    gather_line<HalfResults<HalfRounding::toward_zero>>(line, count, reach, filter.settings.leak,
                                                        gathered);
  }
}

/// Makes kLanes rows of what the first pass gave in a column nodes of the lines along y.
SOFTFOCUS_INLINE void halves_to_nodes(const Strip& strip, int column, int node) {
  Bits rg[kLanes], b[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const std::uint32_t* from = strip.gathered + (column * kLanes + i) * 2 * kLanes;
    rg[i] = load(from);
    b[i] = load(from + kLanes);
  }
  transpose(rg);
  transpose(b);
  for (int i = 0; i < kLanes; ++i) {
    const int to = column * strip.capacity + node + i;
    store_part(strip.down, to, half_to_float(rg[i] & 0xFFFFu), half_to_float(rg[i] >> 16),
               half_to_float(b[i]), load(strip.down.whole + to * 4 * kLanes));
  }
}
SOFTFOCUS_INLINE void singles_to_nodes(const Strip& strip, int column, int node) {
  Bits r[kLanes], g[kLanes], b[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const std::uint32_t* from = strip.gathered + (column * kLanes + i) * 3 * kLanes;
    r[i] = load(from);
    g[i] = load(from + kLanes);
    b[i] = load(from + 2 * kLanes);
  }
  transpose(r);
  transpose(g);
  transpose(b);
  for (int i = 0; i < kLanes; ++i) {
    const int to = column * strip.capacity + node + i;
    store_part(strip.down, to, as_floats(r[i]), as_floats(g[i]), as_floats(b[i]),
               load(strip.down.whole + to * 4 * kLanes));
  }
}

}  // namespace

/// The first pass: filters kLanes rows along x and makes them nodes `node` and following
/// of the lines along y.
void filter_across(const Strip& strip, const StripFilter& filter, const std::uint16_t* const* rows,
                   int node) {
  const int length = strip.halo + strip.columns + strip.halo;
  for (int at = 0; at < length; at += kLanes) {
    const bool inside = at >= strip.halo && at < strip.halo + strip.columns;
    load_block(strip, filter.settings, rows, strip.x_begin - strip.halo + at, at,
               inside ? (at - strip.halo) / kLanes : -1, node);
  }
  const GatherNodes line = nodes_from(strip.across, strip.halo);
  if (filter.between == Between::single) {
    gather_line<FloatResults>(line, strip.columns, strip.reach, filter.settings.leak,
                              strip.gathered);
  } else {
    gather(filter, line, strip.columns, strip.reach, strip.gathered);
  }
  for (int column = 0; column < strip.columns / kLanes; ++column) {
    if (filter.between == Between::single) {
      singles_to_nodes(strip, column, node);
    } else {
      halves_to_nodes(strip, column, node);
    }
  }
}

/// The second pass: filters nodes `node` to `node` + count - 1 of the lines along y and
/// stores them in rows that begin at `result`.
void filter_down(const Strip& strip, const StripFilter& filter, int node, int count,
                 std::uint16_t* result, std::ptrdiff_t stride) {
  for (int column = 0; column < strip.columns / kLanes; ++column) {
    const int from = column * strip.capacity + node;
    const int x = strip.x_begin + column * kLanes;
    gather(filter, nodes_from(strip.down, from), count, strip.reach, strip.gathered);
    const int inside = strip.picture_width - x < kLanes ? strip.picture_width - x : kLanes;
    for (int i = 0; i < count; ++i) {
      const Bits rg = load(strip.gathered + i * 2 * kLanes);
      const Bits b = load(strip.gathered + i * 2 * kLanes + kLanes);
      const HalfTexels texels{rg & 0xFFFFu, rg >> 16, b, load(strip.depths + (from + i) * kLanes)};
      std::uint16_t* to = result + i * stride + 4 * x;
      if (inside == kLanes) {
        if (filter.past_caches) {
          stream_texel_words(to, interleave(texels));
        } else {
          store_half_texels(to, texels);
        }
      } else if (inside > 0) {
        std::uint16_t last[4 * kLanes];
        store_half_texels(last, texels);
        std::memcpy(to, last, 4 * sizeof *last * static_cast<std::size_t>(inside));
      }
    }
  }
  if (filter.past_caches) finish_streaming();
}
