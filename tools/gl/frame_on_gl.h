#pragma once
// A frame rendered by a GL driver in this process: what `render --gl` does.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dof/dof.h"
#include "raster/images/image.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/scene.h"
#include "scenes/shadows/maps/draw_map_side.h"
#include "scenes/shadows/shadow_mask.h"
#include "tools/gl/driver/driver.h"
#include "tools/gl/shaders.h"

namespace softfocus {

class FrameOnGl {
 public:
  /// Opens the driver; throws DriverError.
  FrameOnGl(const Driver& driver, Shaders shaders);
  ~FrameOnGl();

  /// GL_RENDERER and GL_VERSION.
  std::string renderer() const;

  /// As draw_scene(): RGBA16F, depth in alpha.
  Image draw(const Scene& scene, const CameraMatrices& view, double frame, int width, int height);

  /// As softfocus::draw_layers().
  std::vector<Image> draw_layers(const Scene& scene, const CameraMatrices& view, double frame,
                                 int width, int height, std::size_t layers);

  /// As the method's apply(). Throws DriverError for a method that has no shader.
  Image filter(const Method& method, const DofSettings& settings, const Image& scene);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Projected shadows that a GL driver draws again and again in this process: what `shadows --vs`
// times. Uploads, links and allocates when it is made.

class ShadowsRepeatedOnGl {
 public:
  /// Opens the driver; Mesa's get that number of threads. Throws DriverError.
  ShadowsRepeatedOnGl(const Driver& driver, const MaskDraws& draws, int lights, int width,
                      int height, int threads);
  ~ShadowsRepeatedOnGl();

  /// GL_RENDERER and GL_VERSION.
  std::string renderer() const;

  void draw();  ///< returns when all is done: glFinish
  std::vector<std::uint8_t> mask(std::span<const std::uint8_t> dark) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Shadow maps that a GL driver draws again and again in this process: what `shadows --vs` times.
// Uploads, links and allocates when it is made.

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
