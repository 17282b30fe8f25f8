#include "scenes/files/texture_file.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>

#include "scenes/files/file_bytes.h"
#include "scenes/files/picture_check.h"
#include "scenes/files/scene_error.h"

// What a damaged file leaves unset is 0 then, and not what was there before.
#define STBI_MALLOC(size) softfocus::zeroed_memory(size)
#define STBI_REALLOC(memory, size) std::realloc(memory, size)
#define STBI_FREE(memory) std::free(memory)
// Its vector code gives other bits for JPEG than its scalar code.
#define STBI_NO_SIMD
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

namespace softfocus {
namespace {

[[noreturn]] void fail(const std::string& name, const std::string& reason) {
  throw SceneError(name + ": " + reason);
}

std::string stb_reason() {
  const char* reason = stbi_failure_reason();
  return reason != nullptr ? reason : "unknown reason";
}

}  // namespace

Texture load_texture(const std::filesystem::path& file) {
  check_no_pipe(file);
  return texture_of_bytes(read_file_bytes(file, kMaxTextureBytes), file.string());
}

Texture texture_of_bytes(const std::string& bytes, const std::string& name) {
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());

  if (has_overfull_huffman_table(bytes)) {
    fail(name,
         "is damaged (a Huffman table of more than 256 codes); a complete PNG or JPEG file "
         "would do");
  }
  if (lacks_huffman_table(bytes)) {
    fail(name,
         "is damaged (a scan without its Huffman table); a complete PNG or JPEG file would do");
  }
  if (has_cut_png_chunk(bytes)) {
    fail(name, "is damaged (a chunk goes on past the end); a complete PNG or JPEG file would do");
  }
  int width = 0;
  int height = 0;
  int channels = 0;
  if (stbi_info_from_memory(data, size, &width, &height, &channels) == 0) {
    fail(name, "not a picture that can be read (" + stb_reason() +
                   "); a PNG or JPEG file of up to " + std::to_string(kMaxImageSize) +
                   " texels along a side would do");
  }
  if (width < 1 || height < 1 || width > kMaxImageSize || height > kMaxImageSize ||
      static_cast<std::int64_t>(width) * height > kMaxTextureTexels) {
    fail(name, "is " + std::to_string(width) + "x" + std::to_string(height) + " texels; up to " +
                   std::to_string(kMaxImageSize) + " along a side and " +
                   std::to_string(kMaxTextureTexels) + " in all would do");
  }
  const std::unique_ptr<stbi_uc, decltype(&stbi_image_free)> texels{
      stbi_load_from_memory(data, size, &width, &height, &channels, 4), &stbi_image_free};
  if (texels == nullptr || is_cut_jpeg(bytes)) {
    fail(name, "is damaged (" + (texels == nullptr ? stb_reason() : "its end is missing") +
                   "); a complete PNG or JPEG file would do");
  }

  Image image = make_image(Format::srgb8, width, height);
  for (int y = 0; y < height; ++y) {
    const auto to = row<std::uint8_t>(image, y);
    const stbi_uc* from = texels.get() + static_cast<std::size_t>(y) * to.size();
    std::copy(from, from + to.size(), to.begin());
  }
  Texture texture = make_texture(std::move(image));
  generate_mipmaps(texture, Profile{});
  return texture;
}

}  // namespace softfocus
