#include "tools/refocus/opacity.h"

#include <algorithm>

#include "raster/images/image.h"
#include "raster/numbers/half.h"

namespace softfocus {
namespace {

void multiply(const PlaneValues& opacity, Image& colour) {
  std::size_t pixel = 0;
  for (int y = 0; y < colour.height; ++y) {
    const auto halves = row<std::uint16_t>(colour, y);
    for (std::size_t i = 0; i < halves.size(); i += 4, ++pixel) {
      if (opacity[pixel] == 1.0f) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        halves[i + c] = float_to_half(half_to_float(halves[i + c]) * opacity[pixel],
                                      HalfRounding::nearest_even);
      }
    }
  }
}

}  // namespace

bool may_be_opacity(const PictureSources& sources) {
  const auto& alpha = sources.colour.alpha;
  const bool is_depth = !sources.depth_file && alpha == sources.depth_plane;
  const bool is_ours = sources.notes && sources.colour_file.reader == &kNpyReader;
  return alpha && !is_depth && !is_ours;
}

bool is_sure_of_alpha(const PictureFile& file) { return file.reader == &kExrReader; }

void take_opacity(const PictureFile& file, float whole, PlaneValues& alpha, Image& colour) {
  for (float& value : alpha) value = value > 0.0f ? std::min(value / whole, 1.0f) : 0.0f;
  if (file.reader != &kExrReader) multiply(alpha, colour);
}

PlaneValues take_opacity(const PictureSources& sources, Image& colour) {
  if (!may_be_opacity(sources)) return {};
  const std::size_t plane = *sources.colour.alpha;
  const PictureFile& file = sources.colour_file;
  PlaneValues opacity = std::move(read_planes(file, {&plane, 1}, 0.0f)[0]);
  const auto whole = static_cast<float>(full_scale(file.planes[plane].type));
  if (!is_sure_of_alpha(file) && std::any_of(opacity.begin(), opacity.end(), [&](float value) {
        return !(value >= 0.0f && value <= whole);
      })) {
    return {};
  }
  take_opacity(file, whole, opacity, colour);
  return opacity;
}

bool is_transparent(const PlaneValues& opacity) {
  return std::any_of(opacity.begin(), opacity.end(), [](float value) { return value < 1.0f; });
}

Image opacity_picture(const PlaneValues& opacity, const Image& like) {
  Image picture = make_image(like.format, like.width, like.height);
  std::size_t pixel = 0;
  for (int y = 0; y < like.height; ++y) {
    const auto from = row<std::uint16_t>(like, y);
    const auto to = row<std::uint16_t>(picture, y);
    for (std::size_t i = 0; i < to.size(); i += 4, ++pixel) {
      const std::uint16_t half = float_to_half(opacity[pixel], HalfRounding::nearest_even);
      to[i] = to[i + 1] = to[i + 2] = half;
      to[i + 3] = from[i + 3];
    }
  }
  return picture;
}

PlaneValues opacity_of(const Image& picture) {
  PlaneValues opacity;
  opacity.reserve(static_cast<std::size_t>(picture.width) *
                  static_cast<std::size_t>(picture.height));
  for (int y = 0; y < picture.height; ++y) {
    const auto halves = row<std::uint16_t>(picture, y);
    for (std::size_t i = 0; i < halves.size(); i += 4) {
      opacity.push_back(std::clamp(half_to_float(halves[i]), 0.0f, 1.0f));
    }
  }
  return opacity;
}

}  // namespace softfocus
