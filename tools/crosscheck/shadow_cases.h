#pragma once
// A frame with shadows, for the stages that compare them.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/draw/shadowed_layers.h"
#include "tools/crosscheck/cases.h"

namespace softfocus {

struct ShadowedFrame {
  std::shared_ptr<SceneShadows> shadows;  ///< as the frame left them
  glm::dvec3 eye;
  ShadowView view;
  MaskDraws draws;  ///< with the dark sides
};

/// Draws frame 0 of a scene. All its lights have shadows of this kind; `map` is for maps.
ShadowedFrame draw_shadowed_frame(const Bench& bench, const std::string& scene, ShadowKind kind,
                                  const ShadowMapSettings& map, int width, int height);

/// Rows of numbers, without gaps, as R32F.
template <class Number>
Image numbers_image(std::span<const Number> numbers, int width, int height) {
  Image image = make_image(Format::r32f, width, height);
  for (int y = 0; y < height; ++y) {
    const auto to = row<float>(image, y);
    for (std::size_t x = 0; x < to.size(); ++x) {
      to[x] = static_cast<float>(
          numbers[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + x]);
    }
  }
  return image;
}

/// "figures 97x61".
std::string name_and_size(const std::string& scene, int width, int height);

}  // namespace softfocus
