#include "tools/render/frame_lens.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "dof/circle_sizes.h"
#include "dof/halve.h"
#include "raster/images/texel.h"
#include "scenes/draw/keyframes.h"
#include "tools/cli/errors.h"
#include "tools/options/method_options.h"
#include "tools/render/picture_files.h"
#include "tools/render/sharp_depths_option.h"

namespace softfocus {
namespace {

// Of the picture and of each layer that is blurred by itself.
float largest_circle_px(const FrameParts& parts, const PixelCoc& coc, ThreadPool& pool) {
  const auto largest = [&](const Image& picture) {
    return circle_sizes(picture, coc, 0.0f, pool).largest_px;
  };
  float most = largest(parts.transparent.empty() ? parts.picture : parts.opaque);
  for (const TransparentPicture& layer : parts.transparent) {
    most = std::max(most, largest(layer.colour));
  }
  return most;
}

}  // namespace

UsedLens chosen_lens(const RenderOptions& options, const SceneLens& of_scene,
                     double fov_y_degrees) {
  UsedLens used;
  used.lens = overruled(lens_at(of_scene, options.frame), options.lens);
  used.coc_scale = options.lens.coc_scale.value_or(of_scene.coc_scale);
  const auto scale = static_cast<float>(options.supersample);
  used.settings.max_coc_px = std::min(
      scale * used_max_coc_px(options.max_coc_px, of_scene, options.size.height), kLargestMaxCoc);
  used.settings.leak = options.leak;
  used.settings.budget = options.budget;
  used.settings.aperture = options.aperture;
  if (options.autofocus) {
    used.autofocus_pixel =
        options.autofocus_pixel.value_or(Pixel{options.size.width / 2, options.size.height / 2});
  } else if (!options.sharp_depths.empty()) {
    used.sharp_depths = sharp_depths(options.sharp_depths, used.lens, fov_y_degrees,
                                     drawn_size(options).height, used.coc_scale);
  } else {
    check_lens(used.lens, options.lens, options.scene);
  }
  return used;
}

void set_lens(UsedLens& used, const FrameParts& parts, const RenderOptions& options,
              double fov_y_degrees, ThreadPool& pool) {
  const Image& scene = parts.picture;
  if (used.autofocus_pixel) {
    const auto [x, y] = *used.autofocus_pixel;
    const int scale = options.supersample;
    used.lens.focus_m =
        load_texel<Format::rgba16f>(scene, x * scale + scale / 2, y * scale + scale / 2).w;
    check_lens(used.lens, options.lens,
               "--autofocus " + std::to_string(x) + "," + std::to_string(y));
  }
  used.settings.coc =
      checked_pixel_coc(used.lens, fov_y_degrees, drawn_size(options).height, used.coc_scale);
  if (!used.sharp_depths.empty()) {
    used.radii_px = sharp_depths_radii(scene, used.sharp_depths, pool);
    const float largest = *std::max_element(used.radii_px.begin(), used.radii_px.end());
    if (takes_all_circles(options)) used.settings.max_coc_px = std::ceil(largest);
  } else if (takes_all_circles(options)) {
    used.settings.max_coc_px = std::ceil(largest_circle_px(parts, used.settings.coc, pool));
  }
  if (options.show == Show::image) check_arithmetic(options.arithmetic, used.settings);
}

Image halved(const Image& picture, const RenderOptions& options, double fov_y_degrees,
             std::optional<UsedLens>& used, ThreadPool& pool) {
  if (used) {
    used->settings.max_coc_px *= 0.5f;
    used->settings.coc =
        checked_pixel_coc(used->lens, fov_y_degrees, options.size.height, used->coc_scale);
  }
  return halve(picture, options.profile, pool);
}

}  // namespace softfocus
