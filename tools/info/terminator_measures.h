#pragma once
// Where light ends on curves of few facets, by each rule of scenes/shadows/terminators.h, against
// the same shapes of many.

#include "raster/threads/parallel.h"
#include "tools/cli/option_values.h"

namespace softfocus {

/// Prints a table: a sphere, a torus and a teapot of few facets over a floor, and FLIP against the
/// shape of many, by region.
void print_terminator_table(PictureSize size, ThreadPool& pool);

}  // namespace softfocus
