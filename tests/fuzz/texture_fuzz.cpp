// Any bytes as a texture: one with its mipmaps, or a SceneError.

#include <stb_image.h>

#include "scenes/files/picture_check.h"
#include "scenes/files/scene_error.h"
#include "scenes/files/texture_file.h"
#include "tests/fuzz/fuzz_input.h"

int softfocus::fuzz_texture(const std::uint8_t* data, std::size_t size) {
  constexpr std::int64_t kMostTexels = 1 << 16;
  int width = 0, height = 0, channels = 0;
  const bool is_sound = !has_overfull_huffman_table({reinterpret_cast<const char*>(data), size});
  if (is_sound &&
      stbi_info_from_memory(data, static_cast<int>(size), &width, &height, &channels) != 0 &&
      std::int64_t{width} * height > kMostTexels) {
    return -1;
  }
  try {
    load_texture(fuzz_file(data, size, ".png"));
  } catch (const SceneError&) {
  }
  return 0;
}
