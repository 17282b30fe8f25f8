// Steps of walks, scalar and in lanes.

#ifndef SOFTFOCUS_ISA

#include "scenes/relief/warp/step_lanes.h"

#include "scenes/relief/warp/resample_walk.h"

#define SOFTFOCUS_KERNELS "scenes/relief/warp/step_lanes.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

void step_texel_alone(const WalkSteps& steps, const StepRule& rule, int i,
                      const SteppedTexels& put) {
  put.colour[i] = 0;
  put.across[i] = put.depth[i] = 0.0f;
  const float from = steps.from_along[i], to = steps.along[i];
  if ((steps.from_colour[i] | steps.colour[i]) == 0) {
    put.reached[i] = kNoTexel;
    return;
  }
  const bool runs_on = steps.from_colour[i] != 0 && steps.colour[i] != 0 &&
                       (rule.sign > 0 ? to >= from : to <= from);
  const auto reached_by = [&](float place) {
    return rule.sign > 0 ? FloatPlaces::floor(place) : FloatPlaces::ceil(place);
  };
  const int passed = runs_on ? rule.sign * (reached_by(to) - reached_by(from)) : 2;
  if (passed != 1) {
    put.reached[i] = passed == 0 ? kNoTexel : kOtherStep;
    return;
  }
  const FloatPlaces numbers{rule.warp, rule.most_m, 0.0f};
  const int texel = reached_by(to);
  const float share = FloatPlaces::share(texel, from, to);
  put.reached[i] = texel;
  put.colour[i] = mix_colours(steps.from_colour[i], steps.colour[i], FloatPlaces::weight(share));
  put.across[i] = FloatPlaces::mix(steps.from_across[i], steps.across[i], share);
  put.depth[i] = FloatPlaces::mix(steps.from_depth[i], steps.depth[i], share);
  if (rule.compensated) {
    put.depth[i] = numbers.compensated(rule.row, put.across[i], put.depth[i]);
  }
  if (rule.to_column) put.across[i] = numbers.place_in_column(rule.row, put.depth[i]);
}

}  // namespace

void step_texels(const WalkSteps& steps, const StepRule& rule, int count, const SteppedTexels& to,
                 Isa isa) {
  int i = 0;
  if (isa != Isa::scalar) {
    i = rule.sign > 0 ? SOFTFOCUS_KERNEL(isa, step_vectors<1>)(steps, rule, count, to)
                      : SOFTFOCUS_KERNEL(isa, step_vectors<-1>)(steps, rule, count, to);
  }
  for (; i < count; ++i) step_texel_alone(steps, rule, i, to);
}

}  // namespace softfocus

#else  // the kernels, once a vector unit

namespace {

/// FloatPlaces::floor().
SOFTFOCUS_INLINE Ints floor_place(Floats place) {
  const Ints whole = truncate(place);
  return whole + (place < to_floats(whole));  // a mask is -1
}

template <int sign>
SOFTFOCUS_INLINE Ints reached_place(Floats place) {
  if constexpr (sign > 0) return floor_place(place);
  return -floor_place(-place);
}

/// mix_colours().
SOFTFOCUS_INLINE Bits mix_colour_lanes(Bits a, Bits b, Bits weight) {
  const Bits rest = 256u - weight;
  const Bits even = (a & 0xFF00FFu) * rest + (b & 0xFF00FFu) * weight;
  const Bits odd = (a >> 8 & 0xFF00FFu) * rest + (b >> 8 & 0xFF00FFu) * weight;
  return ((even + 0x800080u) >> 8 & 0xFF00FFu) | ((odd + 0x800080u) & 0xFF00FF00u);
}

}  // namespace

/// Returns how many steps are done.
template <int sign>
int step_vectors(const WalkSteps& steps, const StepRule& rule, int count,
                 const SteppedTexels& put) {
  const Floats row = splat(static_cast<float>(rule.row));
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    const Bits from_colour = load(steps.from_colour + i), colour = load(steps.colour + i);
    const Floats from = load(steps.from_along + i), to = load(steps.along + i);
    const Mask both = (from_colour != 0u) & (colour != 0u);
    const Mask runs_on = both & (sign > 0 ? to >= from : to <= from);
    const Ints texel = reached_place<sign>(to);
    const Ints passed = select(runs_on, (texel - reached_place<sign>(from)) * sign, splat(2));
    const Mask is_one = passed == 1;
    const Mask is_none = ((from_colour | colour) == 0u) | (passed == 0);
    store(put.reached + i,
          select(is_none, splat(kNoTexel), select(is_one, texel, splat(kOtherStep))));
    const Floats way = select(is_one, to - from, splat(1.0f));
    const Floats share = select(is_one, (to_floats(texel) - from) / way, splat(0.0f));
    const Bits weight = as_bits(truncate(share * 256.0f + 0.5f));
    store(put.colour + i, mix_colour_lanes(from_colour, colour, weight));
    const Floats from_across = load(steps.from_across + i), from_depth = load(steps.from_depth + i);
    Floats across = from_across + share * (load(steps.across + i) - from_across);
    Floats depth = from_depth + share * (load(steps.depth + i) - from_depth);
    if (rule.compensated) {
      const Floats below = rule.warp.k2 - across * rule.warp.k3;
      const Mask moves = below != 0.0f;
      const Floats own = select(moves, (across - row) / select(moves, below, splat(1.0f)), depth);
      depth = select(own > 0.0f, smaller(splat(rule.most_m), own), splat(0.0f));
    }
    if (rule.to_column) {
      const Floats scale = 1.0f / (1.0f + rule.warp.k3 * depth);
      across = (row + rule.warp.k2 * depth) * scale;
    }
    store(put.across + i, across);
    store(put.depth + i, depth);
  }
  return i;
}

#endif
