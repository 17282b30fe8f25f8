#pragma once
// What the taps of a pixel add up to, without a look at each tap: sums of integers are
// exact in any order, so that those of a pixel are its neighbour's and what changes between
// the two. A pixel P weighs, by its distance d,
//
//     d         0 .. reach - 1     reach     reach + 1 ..
//     weight        whole           edge         0
//
// and so changes its weight four times while a receiver passes: the work of a pixel does
// not grow with the radius. Only a receiver with a leakage below 1, nearly sharp itself,
// needs the sums of what lies beyond the focus, and gathers those tap by tap.

#include "dof/fixed/ring.h"
#include "dof/fixed/sums8.h"

namespace softfocus::fixed {

/// The first pass: of the row in ring.line, whose slot in the ring this is; into the ring.
void filter_across(const Stream& stream, const Ring& ring, uint32_t slot);

/// The second pass: of the rows in the ring, of which `row` is the next to come out; into
/// ring.line, with 2 added to each colour, so that a quarter of it, cut off, is rounded.
void filter_down(const Stream& stream, const Ring& ring, uint32_t row);

}  // namespace softfocus::fixed
