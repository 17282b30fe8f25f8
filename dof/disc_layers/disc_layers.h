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
// its shares add to one in any order. The picture's edges repeat outwards. On slopes c is the
// colour beside the pixel that disc_slopes.h finds; highlights and layers behind keep theirs.
//
// A pixel near the outline of something before the focus hides something: c' of shares m', as
// disc_hidden.h guesses it. It counts so:
//
//   rungs in focus and behind it   m' c' stands in place of m c
//   rungs before the focus         m c + m' c' over (m and farther) + m'
//
// Before the focus it counts in its own rungs alone. Counted in nearer ones as well, it would
// shine through a near thing that itself runs through several. It counts as no nearer than
// sqrt(48) pixels, the largest rung of level 0.
//
// Circles of 8 pixels and more are blurred at half resolution, of 16 and more at a quarter,
// and so on: a level for each doubling. The way down averages shares, and colours weighed by
// them. The way up enlarges colour and transmittance of all that is seen of a level and of
// larger ones: one picture goes before the smaller near layers, one behind the smaller far
// ones.
//
// Highlights, small lights far brighter than what lies around them, are taken out of the picture
// before all that (disc_highlights.h). Each is drawn at full resolution, as a disc of its pixel's
// own radius and of its light e over the disc's area. At a place it is seen by
//
//   gain = sum over its two rungs of m_k min(1, T_k B_k(1) / B_k(m_k and farther))
//
// T_k over the part of the disc that nearer rungs leave open: shares of one surface hide nothing
// of each other. The limit of 1 keeps light from growing beside something sharp. Highlights are
// added after the division by the opacity.
//
// Cost: about ten operations a pixel and rung, a quarter of that at each further level. Tiles
// leave out rungs that have nothing near them. Highlights cost one look at every pixel, and
// 12 r additions for each that is found. What is hidden costs one look, and a few dozen
// operations for each pixel that hides something.
//
// Known failures: what is hidden is a guess, the colours at the outline drawn inwards, so texture
// becomes streaks; two near layers behind each other are apart only if the farther is smaller than
// 8 pixels; but for highlights, a circle between two rungs is two discs, not one of the radius
// between, and from 8 pixels on its rim is about a level's pixel soft.

#include <vector>

#include "dof/disc_layers/disc_hidden.h"
#include "dof/disc_layers/disc_ladder.h"
#include "dof/dof.h"

namespace softfocus {

/// What near things hide, from a picture without its highlights. Without vectors it defines all of
/// HiddenPicture::picture, as an oracle does.
using FindHidden = HiddenPicture (*)(const DofInput& input, ThreadPool& pool);

/// A Method's apply (dof.h).
void disc_layers(const DofInput& input, const ImageView& result, ThreadPool& pool);

// Layered, after Lee, Eisemann and Seidel 2009 and Franke et al. 2018: disc-layers that need not
// guess what near things hide, because the layers behind the picture (DofInput::behind) show it.
//
// Behind a pixel P with r_P < -1 lies the first layer that is farther by a step, r > r_P + 1 +
// |r_P| / 4: nearer ones are the same thing's other parts, from which no point of the lens sees
// anything else. It takes the place of disc_hidden.h's guess, which remains where no layer is
// farther by a step. All else is as above.
//
// Known failures: those of disc-layers but for the guess. What the picture hides beside something
// that is not near, and what lies behind the last layer, is left out. A layer is seen through a
// nearer one by the same share all over its disc: a lens sees more of one side.

/// A Method's apply (dof.h). Without layers behind the picture it is disc_layers().
void layered(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The oracle of disc_layers(), and its scalar form: pixel by pixel. Equal to the bit.
void disc_layers_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool);

/// That of blur_discs().
void blur_discs_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool,
                       FindHidden find);

/// disc_layers() with another way to find it.
void blur_discs(const DofInput& input, const ImageView& result, ThreadPool& pool, FindHidden find);

/// The ladder up to the largest radius of the settings.
std::vector<LevelRungs> disc_ladder_of(const DofInput& input);

}  // namespace softfocus
