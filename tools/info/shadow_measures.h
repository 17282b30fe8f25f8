#pragma once
// What `softfocus shadows` measures beside projected shadows and volumes.

#include "raster/threads/parallel.h"
#include "scenes/scene.h"
#include "tools/cli/option_values.h"
#include "tools/gl/driver/driver.h"

namespace softfocus {

// --- shadow maps: what they cost and how wrong they are, beside projected ones, which are right

struct MapMeasure {
  const Scene& scene;  ///< all of its lights have a map
  PictureSize size;
  double frame;
  int runs;
  const Driver* versus = nullptr;  ///< draws the same maps
};

/// Prints times, each in turn, and the driver's if there is one. Throws DriverError. With `check`
/// every pixel against a ray.
void measure_maps(const MapMeasure& measure, bool check, ThreadPool& pool);

/// Prints a table: time and wrong pixels by size, bias, slope bias, kernel and cascades, one of
/// them at a time changed from the scene's settings.
void print_map_table(const MapMeasure& measure, ThreadPool& pool);

// --- soft shadows: each point of a light against rays, and how far few points are from many

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

// --- where light ends on curves of few facets, by each rule of scenes/shadows/terminators.h

/// Prints a table: a sphere, a torus and a teapot of few facets over a floor, and FLIP against the
/// shape of many, by region.
void print_terminator_table(PictureSize size, ThreadPool& pool);

}  // namespace softfocus
