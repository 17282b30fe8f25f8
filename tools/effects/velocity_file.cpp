#include "tools/effects/velocity_file.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "raster/images/texel.h"
#include "tools/cli/errors.h"
#include "tools/pictures/picture_file.h"

namespace softfocus {
namespace {

/// The channels of two names of the first layer that has both, and none of a third: a colour moves
/// nothing.
std::optional<std::array<std::size_t, 2>> channels_of(const PictureFile& file,
                                                      std::string_view first,
                                                      std::string_view second,
                                                      std::string_view without) {
  const auto layer_of = [](const std::string& name, std::string_view channel) {
    const bool is_it = name == channel || name.ends_with('.' + std::string{channel});
    return is_it ? std::optional{name.substr(0, name.size() - channel.size())} : std::nullopt;
  };
  for (std::size_t i = 0; i < file.planes.size(); ++i) {
    const std::optional<std::string> layer = layer_of(file.planes[i].name, first);
    const bool is_other = std::any_of(
        file.planes.begin(), file.planes.end(),
        [&](const PlaneInfo& plane) { return layer && layer_of(plane.name, without) == layer; });
    if (!layer || is_other) continue;
    for (std::size_t j = 0; j < file.planes.size(); ++j) {
      if (layer_of(file.planes[j].name, second) == layer) return std::array{i, j};
    }
  }
  return {};
}

std::string velocity_size(int width, int height) {
  return std::to_string(width) + 'x' + std::to_string(height);
}

}  // namespace

Image read_velocity(const std::filesystem::path& path, int width, int height) {
  const PictureFile file = open_picture_file(path);
  const std::string where = "--velocity '" + path.string() + "' ";
  auto channels = channels_of(file, "X", "Y", "R");
  if (!channels) channels = channels_of(file, "R", "G", "B");
  if (!channels && file.planes.size() == 2) channels = {0, 1};
  const bool is_whole = channels && full_scale(file.planes[(*channels)[0]].type) != 1.0;
  if (!channels || is_whole) {
    throw UsageError(where + "holds no motions; " + kVelocityFiles +
                     ", in pixels a frame, would be right");
  }
  if (file.width != width || file.height != height) {
    throw UsageError(where + "is " + velocity_size(file.width, file.height) +
                     "; the picture's size, " + velocity_size(width, height) + ", would be right");
  }
  const std::vector<PlaneValues> values = read_planes(file, *channels, 0.0f);
  Image velocity = make_image(Format::rg16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x);
      const auto cut = [](float px) { return std::clamp(px, -65504.0f, 65504.0f); };
      store_texel<Format::rg16f>(velocity, x, y,
                                 {cut(values[0][at]), cut(values[1][at]), 0.0f, 1.0f}, {});
    }
  }
  return velocity;
}

}  // namespace softfocus
