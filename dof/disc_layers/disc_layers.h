#pragma once
// Discs by layers, for a picture with depth: everything of the same circle of confusion is
// blurred together, by an even disc, and the nearer layer is laid over the farther.
//
// Layers are radii, the rungs of disc_ladder.h, before the focus and behind it. A pixel
// counts to the two rungs next to its radius, in shares m. With B_k the sum over the disc of
// rung k, from the nearest layer to the farthest:
//
//   a_k = B_k(m_k) / B_k(m_k and the shares of all farther)       opacity
//   out = sum T_k a_k B_k(m_k c) / B_k(m_k),  T_k = product of 1 - a of what is nearer
//       = sum T_k B_k(m_k c) / B_k(m_k and farther)
//
// and what is left open, T at the end, is divided away. The denominator leaves out what is
// hidden by something nearer: of a layer behind, the discs' visible parts stand for the
// whole. So a surface that runs through layers is never seen through, as its shares add to
// one in whatever order, and what lies behind the soft edge of something near goes on behind
// it, by its nearest parts. Beyond the picture its edges repeat.
//
// Circles of 8 pixels and more are blurred at half resolution, of 16 and more at a quarter,
// and so on: a level for each doubling. On the way down shares and the colours they weigh are
// averaged, on the way up what is seen of a level and all larger ones, colour and
// transmittance: one picture of what is before the smaller near layers, one of what is
// behind the smaller far ones.
//
// Cost: some ten operations a pixel and rung for the small ones, a quarter of it with each
// level; tiles leave out the rungs of which they have nothing near.
//
// Known failures: what is hidden is not known, only continued, so texture behind a soft edge
// is smeared; nothing is found behind more than a circle's radius from its last visible part.
// Circles of which a pixel is a mixture are two discs, not one between them.

#include <vector>

#include "dof/disc_layers/disc_ladder.h"
#include "dof/dof.h"

namespace softfocus {

void disc_layers(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// Its oracle, pixel by pixel; equal to the bit.
void disc_layers_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The ladder up to the largest radius of the settings.
std::vector<LevelRungs> disc_ladder_of(const DofInput& input);

}  // namespace softfocus
