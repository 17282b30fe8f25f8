// softfocus relief make --height-field: heights out of a picture's file.

#include <algorithm>
#include <cmath>
#include <string>

#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"
#include "scenes/relief/height_relief.h"
#include "tools/cli/errors.h"
#include "tools/pictures/picture_file.h"
#include "tools/relief/relief_options.h"

namespace softfocus {
namespace {

[[noreturn]] void refuse_field(const std::filesystem::path& file, const std::string& why) {
  throw FileError("'" + file.string() + "': " + why);
}

/// The planes of heights and, behind them, of alpha. A grey picture may stand in three colours.
struct HeightPlanes {
  std::vector<std::size_t> planes;
  bool has_alpha;
};

HeightPlanes height_planes(const PictureFile& file) {
  const std::vector<ColourLayer> layers = colour_layers(file);
  if (layers.empty()) return {{0}, false};
  const ColourLayer& layer = layers[0];
  HeightPlanes found{{layer.red}, layer.alpha.has_value()};
  if (layer.green != layer.red) found.planes.insert(found.planes.end(), {layer.green, layer.blue});
  if (layer.alpha) found.planes.push_back(*layer.alpha);
  return found;
}

std::vector<std::uint32_t> read_field_colours(const std::filesystem::path& path, int width,
                                              int height) {
  const PictureFile file = open_picture_file(path);
  const std::vector<ColourLayer> layers = colour_layers(file);
  if (layers.empty()) refuse_field(path, "has no colour; it has " + plane_names(file));
  if (file.width != width || file.height != height) {
    refuse_field(path, "has " + size_text({file.width, file.height}) +
                           " pixels; the heights have " + size_text({width, height}));
  }
  const Image picture = read_colour(file, layers[0], false).image;
  std::vector<std::uint32_t> colours;
  colours.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    const std::uint16_t* texels = row<std::uint16_t>(picture, y).data();
    for (int x = 0; x < width; ++x) {
      std::uint32_t colour = 0xFF000000u;
      for (int i = 0; i < 3; ++i) {
        colour |= std::uint32_t{linear_to_srgb8(half_to_float(texels[4 * x + i]))} << (8 * i);
      }
      colours.push_back(colour);
    }
  }
  return colours;
}

}  // namespace

ReliefTexture relief_of_height_file(const ReliefOptions& options) {
  const std::filesystem::path path = options.input;
  const PictureFile file = open_picture_file(path);
  if (file.width > kMostReliefSize || file.height > kMostReliefSize) {
    refuse_field(path, "has " + size_text({file.width, file.height}) +
                           " heights; each side has 1 to " + std::to_string(kMostReliefSize));
  }
  const HeightPlanes of = height_planes(file);
  const std::vector<PlaneValues> values = read_planes(file, of.planes, NAN);
  const std::size_t heights = of.planes.size() - (of.has_alpha ? 1 : 0);
  for (std::size_t i = 1; i < heights; ++i) {
    const bool is_grey =
        std::equal(values[0].begin(), values[0].end(), values[i].begin(),
                   [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); });
    if (!is_grey) refuse_field(path, "is in colour; heights are grey");
  }
  HeightField field{file.width, file.height, values[0]};
  const int longest = std::max(file.width, file.height);
  const double full = full_scale(file.planes[of.planes[0]].type);
  const auto texels_of_one = static_cast<float>(options.height_m * longest / full);
  for (std::size_t i = 0; i < field.heights.size(); ++i) {
    const float value = field.heights[i];
    const bool is_empty = (options.empty_height && value == *options.empty_height) ||
                          (of.has_alpha && !(values.back()[i] > 0.0f));
    field.heights[i] = is_empty ? NAN : value * texels_of_one;
  }
  if (!options.colour.empty()) {
    field.colours = read_field_colours(options.colour, file.width, file.height);
  }
  std::optional<ReliefTexture> relief =
      relief_of_heights(field, {1.0 / longest, options.depth_bits, options.normals});
  if (!relief) refuse_field(path, "has no height: all of its texels are empty");
  return std::move(*relief);
}

}  // namespace softfocus
