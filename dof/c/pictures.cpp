#include "dof/c/pictures.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <string>

#include "raster/numbers/half.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

constexpr std::ptrdiff_t kTexelBytes = 8;  // of RGBA16F

ChannelType channel_type(const std::string& name, std::int32_t type) {
  switch (type) {
    case SOFTFOCUS_HALF: return ChannelType::half;
    case SOFTFOCUS_FLOAT: return ChannelType::single;
    case SOFTFOCUS_UNORM8: return ChannelType::unorm8;
    case SOFTFOCUS_SRGB8: return ChannelType::srgb8;
    default:
      refuse(name, std::to_string(type) +
                       " is no type; there are SOFTFOCUS_HALF, FLOAT, UNORM8 and SRGB8");
  }
}

ChannelType depth_type(const std::string& name, std::int32_t type) {
  if (type != SOFTFOCUS_HALF && type != SOFTFOCUS_FLOAT) {
    refuse(name,
           std::to_string(type) + " is no type of depths; there are SOFTFOCUS_HALF and FLOAT");
  }
  return channel_type(name, type);
}

const std::byte* bytes_at(const void* first) { return static_cast<const std::byte*>(first); }

/// The planes of a picture or a target, depth last if there is one.
template <class Pixels>
std::vector<PixelPlane> planes_of(const std::string& name, const Pixels& pixels, bool with_depth) {
  const auto colour_bytes =
      bytes_per_channel(channel_type(name + ".colour_type", pixels.colour_type));
  std::vector<PixelPlane> planes;
  for (const auto& [channel, first] : {std::pair<const char*, const void*>{".red", pixels.red},
                                       {".green", pixels.green},
                                       {".blue", pixels.blue}}) {
    planes.push_back({name + channel, first, pixels.pixel_bytes, pixels.row_bytes, colour_bytes});
  }
  if (with_depth) {
    planes.push_back({name + ".depth", pixels.depth, pixels.depth_pixel_bytes,
                      pixels.depth_row_bytes,
                      bytes_per_channel(depth_type(name + ".depth_type", pixels.depth_type))});
  }
  return planes;
}

template <class Pixels>
bool is_rgba16f(const Pixels& pixels, int width) {
  const std::byte* red = bytes_at(pixels.red);
  const auto row_bytes = kTexelBytes * width;
  return pixels.colour_type == SOFTFOCUS_HALF && pixels.depth_type == SOFTFOCUS_HALF &&
         pixels.depth != nullptr && bytes_at(pixels.green) == red + 2 &&
         bytes_at(pixels.blue) == red + 4 && bytes_at(pixels.depth) == red + 6 &&
         pixels.pixel_bytes == kTexelBytes && pixels.depth_pixel_bytes == kTexelBytes &&
         pixels.row_bytes == pixels.depth_row_bytes &&
         (pixels.row_bytes >= row_bytes || pixels.row_bytes <= -row_bytes) &&
         reinterpret_cast<std::uintptr_t>(red) % 2 == 0 && pixels.row_bytes % 2 == 0;
}

MemoryRange range_of_texels(const void* first, std::ptrdiff_t row_bytes, int width, int height) {
  return range_of({"", first, kTexelBytes, row_bytes, kTexelBytes}, width, height);
}

// Rows that a thread takes at a time.
constexpr int kRows = 16;

/// Halves are the alphas as they are.
void copy_half_depths(const softfocus_picture& picture, const ImageView& to, ThreadPool& pool) {
  for_each_row(pool, picture.height, kRows, [&](int y) {
    const auto texels = row<std::uint16_t>(to, y);
    const std::byte* from = bytes_at(picture.depth) + y * picture.depth_row_bytes;
    for (std::size_t i = 3; i < texels.size(); i += 4, from += picture.depth_pixel_bytes) {
      std::memcpy(&texels[i], from, sizeof texels[i]);
    }
  });
}

/// (z - focus) / z is NaN at infinity, and methods give NaN the largest circle. The horizon shall
/// have its own.
void bring_horizon_near(const ImageView& picture, ThreadPool& pool) {
  for_each_row(pool, picture.height, kRows, [&](int y) {
    const auto texels = row<std::uint16_t>(picture, y);
    for (std::size_t i = 3; i < texels.size(); i += 4) {
      if (texels[i] == kHalfInfinity) texels[i] = kHalfLargest;
    }
  });
}

bool has_horizon(const ConstImageView& picture, ThreadPool& pool) {
  std::atomic<bool> found{false};
  for_each_row(pool, picture.height, kRows, [&](int y) {
    const auto texels = row<std::uint16_t>(picture, y);
    for (std::size_t i = 3; i < texels.size(); i += 4) {
      if (texels[i] == kHalfInfinity) return found.store(true);
    }
  });
  return found;
}

Image packed(const softfocus_picture& picture, ThreadPool& pool) {
  Image image = make_image(Format::rgba16f, picture.width, picture.height);
  const ColourSource colour{channel_type("", picture.colour_type),
                            picture.red,
                            picture.green,
                            picture.blue,
                            picture.pixel_bytes,
                            picture.row_bytes};
  constexpr float kNone = 0.0f;
  const bool is_half = picture.depth_type == SOFTFOCUS_HALF;
  const DepthSource depth = is_half
                                ? DepthSource{&kNone, 0, 0}
                                : DepthSource{static_cast<const float*>(picture.depth),
                                              picture.depth_pixel_bytes, picture.depth_row_bytes};
  pack(colour, depth, HalfRounding::nearest_even, image, pool);
  if (is_half) copy_half_depths(picture, image, pool);
  bring_horizon_near(image, pool);
  return image;
}

void check_size(const std::string& name, const softfocus_picture& picture) {
  const auto is_side = [](std::int32_t side) { return side >= 1 && side <= kMaxImageSize; };
  if (!is_side(picture.width) || !is_side(picture.height)) {
    refuse(name, "its width and height are " + std::to_string(picture.width) + " and " +
                     std::to_string(picture.height) + ", not from 1 to " +
                     std::to_string(kMaxImageSize));
  }
}

ReadPicture read_picture(const std::string& name, const softfocus_picture& picture,
                         std::vector<MemoryRange>& in_use, ThreadPool& pool) {
  for (const PixelPlane& plane : planes_of(name, picture, true)) {
    range_of(plane, picture.width, picture.height);
  }
  if (is_rgba16f(picture, picture.width)) {
    const ConstImageView view{Format::rgba16f, picture.width, picture.height, picture.row_bytes,
                              bytes_at(picture.red)};
    if (!has_horizon(view, pool)) {
      in_use.push_back(
          range_of_texels(picture.red, picture.row_bytes, picture.width, picture.height));
      return {{}, view};
    }
  }
  ReadPicture read{packed(picture, pool), {}};
  read.view = read.copy;  // whose texels stay where they are when it is moved
  return read;
}

/// A layer of `scene`'s size, which has no more than its pixels.
softfocus_picture read_layer(const std::string& name, const softfocus_picture* given,
                             const softfocus_picture& scene) {
  const auto layer = read_struct(name, given);
  if (layer.width != scene.width || layer.height != scene.height) {
    refuse(name, "it has not the size of the picture");
  }
  if (layer.objects != nullptr || layer.radii_px != nullptr || layer.behind_count != 0 ||
      layer.transparent_count != 0) {
    refuse(name, "a layer has no objects, radii or layers of its own");
  }
  return layer;
}

using LayerList = const softfocus_picture* const*;

void check_layers(const std::string& name, LayerList layers, std::int32_t count,
                  std::int32_t most) {
  if (count < 0 || count > most) {
    refuse("picture." + name + "_count",
           std::to_string(count) + " is not from 0 to " + std::to_string(most));
  }
  if (count > 0 && layers == nullptr) refuse("picture." + name, "a null pointer");
}

std::string numbered(const char* name, std::int32_t index) {
  return "picture." + std::string{name} + '[' + std::to_string(index) + ']';
}

template <class Value>
std::span<const Value> values_of(const std::string& name, const Value* first,
                                 const softfocus_picture& picture, ReadFrame& frame) {
  if (first == nullptr) return {};
  constexpr auto kBytes = static_cast<std::ptrdiff_t>(sizeof(Value));
  if (reinterpret_cast<std::uintptr_t>(first) % alignof(Value) != 0) {
    refuse(name, "not aligned to " + std::to_string(alignof(Value)) + " bytes");
  }
  frame.in_use.push_back(range_of({name, first, kBytes, kBytes * picture.width, kBytes},
                                  picture.width, picture.height));
  return {first,
          static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height)};
}

}  // namespace

ReadFrame read_frame(const softfocus_picture* given, ThreadPool& pool) {
  const auto picture = read_struct("picture", given);
  check_size("picture", picture);
  check_layers("behind", picture.behind, picture.behind_count, SOFTFOCUS_MOST_BEHIND);
  check_layers("transparent", picture.transparent, picture.transparent_count,
               SOFTFOCUS_MOST_TRANSPARENT);
  check_layers("opacity", picture.opacity, picture.transparent_count, SOFTFOCUS_MOST_TRANSPARENT);
  ReadFrame frame;
  frame.objects = values_of("picture.objects", picture.objects, picture, frame);
  frame.radii_px = values_of("picture.radii_px", picture.radii_px, picture, frame);
  frame.scene = read_picture("picture", picture, frame.in_use, pool);
  const auto add = [&](const std::string& name, const softfocus_picture& layer) {
    frame.layers.push_back(read_picture(name, layer, frame.in_use, pool));
    return frame.layers.back().view;
  };
  for (std::int32_t i = 0; i < picture.behind_count; ++i) {
    const std::string name = numbered("behind", i);
    frame.behind.push_back(add(name, read_layer(name, picture.behind[i], picture)));
  }
  for (std::int32_t i = 0; i < picture.transparent_count; ++i) {
    const std::string name = numbered("transparent", i), opacity_name = numbered("opacity", i);
    const auto layer = read_layer(name, picture.transparent[i], picture);
    auto opacity = read_layer(opacity_name, picture.opacity[i], picture);
    opacity.depth = layer.depth;
    opacity.depth_type = layer.depth_type;
    opacity.depth_pixel_bytes = layer.depth_pixel_bytes;
    opacity.depth_row_bytes = layer.depth_row_bytes;
    const ConstImageView colour = add(name, layer);
    frame.transparent.push_back({colour, add(opacity_name, opacity)});
  }
  return frame;
}

ResultTarget::ResultTarget(const softfocus_target* target, int width, int height)
    : target_(read_struct("target", target)), width_(width), height_(height) {
  for (const PixelPlane& plane : planes_of("target", target_, target_.depth != nullptr)) {
    range_of(plane, width, height);
    check_apart(plane, width, height);
  }
}

ImageView ResultTarget::place(const ReadFrame& frame, Image& own) const {
  if (is_rgba16f(target_, width_)) {
    const MemoryRange range = range_of_texels(target_.red, target_.row_bytes, width_, height_);
    if (std::none_of(frame.in_use.begin(), frame.in_use.end(),
                     [&](const MemoryRange& read) { return overlap(read, range); })) {
      return view_of(Format::rgba16f, target_.red, width_, height_, target_.row_bytes);
    }
  }
  own = make_image(Format::rgba16f, width_, height_);
  return own;
}

void ResultTarget::finish(const ConstImageView& result, ThreadPool& pool) const {
  if (result.texels == target_.red) return;
  unpack(result,
         {channel_type("", target_.colour_type), target_.red, target_.green, target_.blue,
          target_.pixel_bytes, target_.row_bytes},
         pool);
  if (target_.depth == nullptr) return;
  for_each_row(pool, height_, kRows, [&](int y) {
    const auto texels = row<std::uint16_t>(result, y);
    std::byte* to = static_cast<std::byte*>(target_.depth) + y * target_.depth_row_bytes;
    for (std::size_t i = 3; i < texels.size(); i += 4, to += target_.depth_pixel_bytes) {
      if (target_.depth_type == SOFTFOCUS_HALF) {
        std::memcpy(to, &texels[i], sizeof texels[i]);
      } else {
        const float metres = half_to_float(texels[i]);
        std::memcpy(to, &metres, sizeof metres);
      }
    }
  });
}

}  // namespace softfocus
