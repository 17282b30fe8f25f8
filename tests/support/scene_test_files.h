#pragma once
// Files that the scene loaders' tests read.

#include <string>

#include "raster/images/texel.h"
#include "scenes/files/scene_error.h"
#include "tests/support/run_program.h"
#include "tools/pictures/image_file.h"

namespace softfocus::test {

/// A PNG whose upper left texel is red and whose others are green.
inline std::string png_bytes(int width, int height) {
  Image image = make_image(Format::rgba16f, width, height);
  clear_image(image, {0.0f, 1.0f, 0.0f, 1.0f}, Profile{});
  store_texel(image, 0, 0, {1.0f, 0.0f, 0.0f, 1.0f}, Profile{});
  const Bytes bytes = encode_png(image);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A PNG of a white texel beside a black one.
inline std::string mask_bytes() {
  Image image = make_image(Format::rgba16f, 2, 1);
  store_texel(image, 0, 0, glm::vec4{1.0f}, Profile{});
  store_texel(image, 1, 0, {0.0f, 0.0f, 0.0f, 1.0f}, Profile{});
  const Bytes bytes = encode_png(image);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The message of the SceneError that `work` throws; empty if it throws none.
template <class Work>
std::string scene_error_of(Work work) {
  try {
    work();
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

}  // namespace softfocus::test
