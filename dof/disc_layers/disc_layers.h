#pragma once
// Disc-layers: everything with the same circle of confusion is blurred together, by an even
// disc, and the nearer layer is laid over the farther.
//
// Layers are radii before the focus and behind it, the rungs of disc_ladder.h. A pixel counts
// to the two rungs next to its radius, in shares m. B_k is the sum over the disc of rung k.
// From the nearest layer to the farthest:
//
//   a_k = B_k(m_k) / B_k(m_k and the shares of all farther)       opacity
//   out = sum T_k a_k B_k(m_k c) / B_k(m_k),  T_k = product of 1 - a of all nearer
//       = sum T_k B_k(m_k c) / B_k(m_k and farther)
//
// and `out` is divided by the opacity reached, 1 - T at the end. The denominator leaves out
// everything that is hidden by something nearer, so in a layer behind, the visible parts of a
// disc stand for the whole. A surface that runs through layers is nowhere seen through, since
// its shares add to one in any order. A background goes on behind the soft edge of a near
// thing, by its nearest visible parts. The picture's edges repeat outwards.
//
// Circles of 8 pixels and more are blurred at half resolution, of 16 and more at a quarter,
// and so on: a level for each doubling. The way down averages shares, and colours weighed by
// them. The way up enlarges colour and transmittance of all that is seen of a level and of
// larger ones: one picture goes before the smaller near layers, one behind the smaller far
// ones.
//
// Cost: about ten operations a pixel and rung, a quarter of that at each further level. Tiles
// leave out rungs that have nothing near them.
//
// Known failures: hidden things are not known, only continued, so texture behind a soft edge
// is smeared, and a surface goes on no farther than a circle's radius behind it; a circle
// between two rungs is two discs, not one of the radius between.

#include <vector>

#include "dof/disc_layers/disc_ladder.h"
#include "dof/dof.h"

namespace softfocus {

/// A Method's apply (dof.h).
void disc_layers(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The oracle of disc_layers(), and its scalar form: pixel by pixel. Equal to the bit.
void disc_layers_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The ladder up to the largest radius of the settings.
std::vector<LevelRungs> disc_ladder_of(const DofInput& input);

}  // namespace softfocus
