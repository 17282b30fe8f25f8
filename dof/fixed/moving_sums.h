#pragma once
// The sums of a pixel's taps without a look at each tap. Sums of integers are exact in any
// order, so a pixel's sums are its neighbour's plus the changes between the two. By its
// distance d a pixel P weighs
//
//     d         0 .. reach - 1     reach     reach + 1 ..
//     weight        whole           edge         0
//
// so its weight changes four times while a receiver passes: the work does not grow with the
// radius. Only a receiver with a leakage below 1, which is nearly sharp, needs the sums from
// beyond the focus by themselves; it gathers those tap by tap.

#include "dof/fixed/ring.h"
#include "dof/fixed/sums8.h"

namespace softfocus::fixed {

/// The first pass: filters the row in ring.line into its slot of the ring.
void filter_across(const Stream& stream, const Ring& ring, uint32_t slot);

/// The second pass: filters the rows in the ring into ring.line, for row `row`, the next to come
/// out. Colours have 2 added to them, so that cutting off two bits rounds.
void filter_down(const Stream& stream, const Ring& ring, uint32_t row);

}  // namespace softfocus::fixed
