#pragma once
// Soft shadows: each point of a light against rays, and how far few points are from many.

#include "raster/threads/parallel.h"
#include "scenes/scene.h"
#include "tools/cli/option_values.h"

namespace softfocus {

struct SoftMeasure {
  const Scene& scene;  ///< has_soft_shadows()
  PictureSize size;
  double frame;
  int runs;
};

/// Prints the time of a frame. With `check`, every pixel's stencil of every point against a ray.
void measure_soft(const SoftMeasure& measure, bool check, ThreadPool& pool);

/// Prints a table: how far the shares of N points are from those of 1,024 others, by rays; and
/// the time of N points.
void print_soft_table(const SoftMeasure& measure, ThreadPool& pool);

}  // namespace softfocus
