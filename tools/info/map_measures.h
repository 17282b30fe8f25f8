#pragma once
// What shadow maps cost and how wrong they are, beside projected shadows, which are right.

#include "raster/threads/parallel.h"
#include "scenes/scene.h"
#include "tools/cli/option_values.h"
#include "tools/gl/driver/driver.h"

namespace softfocus {

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

}  // namespace softfocus
