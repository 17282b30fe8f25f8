#pragma once
// Pictures as a C program has them.

#include <cstddef>
#include <memory>
#include <vector>

#include "dof/c/softfocus.h"
#include "raster/images/image.h"

namespace softfocus::test {

struct ContextClose {
  void operator()(softfocus_context* context) const { softfocus_close(context); }
};
using Context = std::unique_ptr<softfocus_context, ContextClose>;

inline Context open_context(int threads = 2) {
  softfocus_context* context = nullptr;
  softfocus_open(&context, threads);
  return Context{context};
}

inline softfocus_settings c_settings() {
  softfocus_settings settings;
  softfocus_init_settings(&settings, sizeof settings);
  return settings;
}

/// An image's own memory: halves, the depth behind the colour.
inline softfocus_picture c_picture(const Image& image) {
  const std::byte* first = image.bytes.data();
  const auto row_bytes = static_cast<std::ptrdiff_t>(image.stride_bytes);
  softfocus_picture picture{};
  picture.struct_size = sizeof picture;
  picture.width = image.width;
  picture.height = image.height;
  picture.red = first;
  picture.green = first + 2;
  picture.blue = first + 4;
  picture.depth = first + 6;
  picture.pixel_bytes = picture.depth_pixel_bytes = 8;
  picture.row_bytes = picture.depth_row_bytes = row_bytes;
  picture.colour_type = picture.depth_type = SOFTFOCUS_HALF;
  return picture;
}

inline softfocus_target c_target(Image& image) {
  std::byte* first = image.bytes.data();
  softfocus_target target{};
  target.struct_size = sizeof target;
  target.red = first;
  target.green = first + 2;
  target.blue = first + 4;
  target.depth = first + 6;
  target.pixel_bytes = target.depth_pixel_bytes = 8;
  target.row_bytes = target.depth_row_bytes = static_cast<std::ptrdiff_t>(image.stride_bytes);
  target.colour_type = target.depth_type = SOFTFOCUS_HALF;
  return target;
}

}  // namespace softfocus::test
