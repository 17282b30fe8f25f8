#pragma once
// The parts of random scenes, from the back to the front. Each draws what it needs from the
// stage's random numbers.

#include "scenes/random/stage.h"

namespace softfocus {

// --- backdrops.cpp: set Stage::backdrop_m ---

void add_wall(Stage& stage);
void add_room(Stage& stage);
/// A sky, without anything in it.
void add_sky(Stage& stage);
void add_night(Stage& stage);
/// `cells` of the texture; the more, the finer.
void add_floor(Stage& stage, double fields_a_metre);

// --- things.cpp ---

/// One to three shapes, about the subject's place.
void add_still_life(Stage& stage);
/// Head and shoulders.
void add_bust(Stage& stage);
/// Boxes that stand on the floor, as furniture or houses do.
void add_blocks(Stage& stage, int count);
/// Small things at all depths, from `nearest` to `farthest` times the subject's distance.
void add_clutter(Stage& stage, int count, double nearest, double farthest);
/// Lamps of 1 to 100 times white, most of them behind the subject.
void add_lamps(Stage& stage, int count);
/// Thin rings and rods with highlights of up to 100 times white.
void add_bright_edges(Stage& stage, int count);

// --- foregrounds.cpp: return the distance along the axis at which they can be in focus, or 0 ---

double add_fence(Stage& stage);
double add_foliage(Stage& stage);
double add_near_things(Stage& stage);

}  // namespace softfocus
