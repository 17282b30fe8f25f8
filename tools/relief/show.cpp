// softfocus relief show and warp: a relief's texels as they are, and from elsewhere.

#include <array>
#include <cstdio>
#include <optional>

#include "raster/images/texel.h"
#include "raster/numbers/srgb.h"
#include "scenes/relief/light_relief.h"
#include "scenes/relief/warp/map_relief.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/relief/relief_file.h"
#include "tools/relief/relief_options.h"

namespace softfocus {
namespace {

glm::vec3 shown_part(const ReliefTexture& relief, ReliefPart part, std::size_t at) {
  const auto three = [](std::uint32_t packed, const auto& of_byte) {
    return glm::vec3{of_byte(packed & 255u), of_byte(packed >> 8 & 255u),
                     of_byte(packed >> 16 & 255u)};
  };
  if (part == ReliefPart::depth) {
    const auto last = static_cast<float>(last_depth(relief.depth_bits));
    return glm::vec3{1.0f - static_cast<float>(relief.depths[at]) / last};
  }
  if (part == ReliefPart::normals) {
    return three(relief.normals[at], [](std::uint32_t byte) {
      return unorm8_to_linear(static_cast<std::uint8_t>(byte));
    });
  }
  return three(relief.colours[at],
               [](std::uint32_t byte) { return srgb8_to_linear(static_cast<std::uint8_t>(byte)); });
}

}  // namespace

int show_relief(const ReliefOptions& options) {
  if (options.part == ReliefPart::faces || options.part == ReliefPart::unseen) {
    throw UsageError("--show: show shows image, depth or normals; relief box has faces");
  }
  const ReliefTexture relief = read_relief_file(options.input);
  if (options.part == ReliefPart::normals && relief.normals.empty()) {
    throw UsageError("--show normals: '" + options.input +
                     "' has none; softfocus relief make --normals makes a relief that has");
  }
  Image picture = make_image(Format::rgba16f, relief.width, relief.height);
  const std::uint16_t empty = empty_depth(relief.depth_bits);
  const double step_m = depth_step(relief);
  for (int y = 0; y < relief.height; ++y) {
    for (int x = 0; x < relief.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(relief.width) +
                             static_cast<std::size_t>(x);
      if (relief.depths[at] == empty) continue;
      store_texel<Format::rgba16f>(
          picture, x, y,
          {shown_part(relief, options.part, at), static_cast<float>(relief.depths[at] * step_m)},
          Profile{});
    }
  }
  write_relief_output(options.output, encode(picture, options.format));
  return kDone;
}

int warp_view(const ReliefOptions& options) {
  ReliefTexture relief = read_relief_file(options.input);
  if (options.light && relief.unlit.empty()) {
    throw UsageError("--light: '" + options.input +
                     "' is lit once and for all; softfocus relief make --unlit makes one that is "
                     "not");
  }
  const auto [width, height] = options.size;
  const Camera camera = camera_before(relief, options);
  const CameraMatrices matrices = camera_matrices(camera, 0.0, width, height);
  const ReliefExtent extent = *relief_extent(relief);
  const std::optional<PlaneRectangle> place = warped_extent(relief, extent, matrices.eye);
  if (!place) {
    throw UsageError(
        "--yaw, --pitch and --distance: from there the relief is not seen from its "
        "front, or stretched without bounds; smaller angles or a larger distance would be right");
  }
  ThreadPool pool{options.pool.threads, options.pool.isa};
  if (options.light) {
    const std::array lights{Light{LightKind::directional, *options.light, glm::vec3{1.0f}}};
    light_relief(relief, relief_lights(Scene{}.ambient_light, lights), matrices.eye, pool);
  }
  WarpedRelief warped;
  WarpCounts counts;
  warp_relief(relief, extent, matrices.eye, *place, warp_rule(options), warped, pool, &counts);
  Image picture = make_image(Format::rgba16f, width, height);
  clear_image(picture, {0.0f, 0.0f, 0.0f, 65504.0f}, Profile{});
  map_relief(warped, plane_mapping(relief, matrices, *place, width, height), picture, pool);
  write_relief_output(options.output, encode(picture, options.format));
  std::fprintf(stderr,
               "%lld texels; %lld pieces, %lld over others, %lld stretched between neighbours more "
               "than %d texels apart\n",
               static_cast<long long>(extent.filled), static_cast<long long>(counts.pieces),
               static_cast<long long>(counts.overlaps), static_cast<long long>(counts.stretched),
               kApart);
  return kDone;
}

}  // namespace softfocus
