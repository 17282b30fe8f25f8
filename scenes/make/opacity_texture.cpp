#include "scenes/make/opacity_texture.h"

#include <algorithm>
#include <cassert>
#include <cstdint>

namespace softfocus {
namespace {

constexpr std::size_t kAlpha = 3;

// Whether a test holds for every byte of a channel.
template <class Test>
bool all_of_channel(const Image& picture, std::size_t channel, Test test) {
  for (int y = 0; y < picture.height; ++y) {
    const auto texels = row<std::uint8_t>(picture, y);
    for (std::size_t i = channel; i < texels.size(); i += 4) {
      if (!test(texels[i])) return false;
    }
  }
  return true;
}

}  // namespace

Texture make_opacity_texture(const Image& picture) {
  assert(picture.format == Format::rgba8 || picture.format == Format::srgb8);
  const bool is_opaque =
      all_of_channel(picture, kAlpha, [](std::uint8_t alpha) { return alpha == 255; });
  Image opacity = make_image(Format::rgba8, picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y) {
    const auto from = row<std::uint8_t>(picture, y);
    const auto to = row<std::uint8_t>(opacity, y);
    for (std::size_t i = 0; i < from.size(); i += 4) {
      const int mean = (from[i] + from[i + 1] + from[i + 2] + 1) / 3;
      std::fill_n(&to[i], 4, is_opaque ? static_cast<std::uint8_t>(mean) : from[i + kAlpha]);
    }
  }
  Texture texture = make_texture(std::move(opacity));
  generate_mipmaps(texture, Profile{});
  return texture;
}

bool is_cut_out(const Texture& opacity) {
  return all_of_channel(opacity.levels[0], kAlpha,
                        [](std::uint8_t value) { return value == 0 || value == 255; });
}

}  // namespace softfocus
