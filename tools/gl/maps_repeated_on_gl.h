#pragma once
// Shadow maps that a GL driver draws again and again in this process: what `shadows --vs` times.
// Uploads, links and allocates when it is made.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "raster/images/image.h"
#include "scenes/shadows/maps/draw_map_side.h"
#include "tools/gl/driver/driver.h"

namespace softfocus {

/// A light's map by its sides' casters.
struct MapCasters {
  ShadowMapSettings settings;
  std::vector<std::vector<CutCasters>> sides;
};

class MapsRepeatedOnGl {
 public:
  /// Opens the driver; Mesa's get that number of threads. Throws DriverError.
  MapsRepeatedOnGl(const Driver& driver, std::span<const MapCasters> maps, int threads);
  ~MapsRepeatedOnGl();

  /// GL_RENDERER and GL_VERSION.
  std::string renderer() const;

  void draw();  ///< returns when all is done: glFinish
  /// Nearness on a side of a map: R32F.
  Image nearness(std::size_t map, std::size_t side) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace softfocus
