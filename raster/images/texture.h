#pragma once
// An image with its mip levels.

#include <utility>
#include <vector>

#include "raster/images/image.h"

namespace softfocus {

/// Each level has half the size of the one before, rounded down, to 1x1. Without mipmaps there
/// is one level.
struct Texture {
  std::vector<Image> levels;
};

/// A texture of one level.
inline Texture make_texture(Image image) {
  Texture texture;
  texture.levels.push_back(std::move(image));
  return texture;
}

}  // namespace softfocus
