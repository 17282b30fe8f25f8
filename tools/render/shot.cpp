#include "tools/render/shot.h"

#include <algorithm>
#include <string>

#include "scenes/draw/frame_matrices.h"
#include "tools/cli/errors.h"
#include "tools/render/picture_files.h"

namespace softfocus {
namespace {

std::vector<ChosenEffect> effects_on(const RenderOptions& options, const Scene& scene) {
  return all_effects(options.effects, options.show == Show::image
                                          ? std::span{scene.effects}
                                          : std::span<const ChosenEffect>{});
}

ShotLens asked_lens(const RenderOptions& options, const Scene& scene) {
  ShotLens asked{overruled(lens_at(scene.lens, options.frame), options.lens),
                 options.lens.coc_scale.value_or(scene.lens.coc_scale)};
  const auto scale = static_cast<float>(options.supersample);
  asked.settings.max_coc_px = std::min(
      scale * used_max_coc_px(options.max_coc_px, scene.lens, options.size.height), kLargestMaxCoc);
  asked.settings.leak = options.leak;
  asked.settings.budget = options.budget;
  asked.settings.aperture = options.aperture;
  asked.cuts_no_circle = takes_all_circles(options);
  if (options.autofocus) {
    const auto [x, y] = focus_pixel(options);
    asked.focus_at = {x, y};
  } else if (!options.sharp_depths.empty()) {
    asked.sharp_depths = sharp_depths(options.sharp_depths, asked.lens, scene.camera.fov_y_degrees,
                                      drawn_size(options).height, asked.coc_scale);
  } else {
    check_lens(asked.lens, options.lens, options.scene);
  }
  return asked;
}

}  // namespace

Shot asked_shot(const RenderOptions& options, const Scene& scene, FrameSequence& sequence) {
  checked_effect_of_frames(options, scene);
  Shot shot{.scene = &scene,
            .frame = options.frame,
            .width = options.size.width,
            .height = options.size.height,
            .supersample = options.supersample,
            .show = options.show,
            .method = options.method,
            .arithmetic = options.arithmetic,
            .layers = options.layers,
            .sampling = with_shutter_of(scene, options.sampling),
            .shard = options.shard,
            .goal = options.goal,
            .verify = options.verify,
            .most_coc_px = options.max_coc_px,
            .effects = effects_on(options, scene),
            .sequence = &sequence,
            .profile = options.profile};
  if (options.show == Show::coc || has_depth_of_field(options)) {
    shot.lens = asked_lens(options, scene);
  }
  return shot;
}

void refuse_lens(const LensError& error, const RenderOptions& options) {
  std::string where = options.scene;
  if (options.autofocus) {
    const auto [x, y] = focus_pixel(options);
    where = "--autofocus " + std::to_string(x) + "," + std::to_string(y);
  }
  if (options.sharp_depths.empty()) check_lens(error.lens.lens, options.lens, where);
  check_pixel_coc(error.lens.settings.coc);
  check_arithmetic(options.arithmetic, error.lens.settings);
  throw UsageError(error.what());
}

FrameSequence frame_sequence(const RenderOptions& options) {
  if (!options.sequence.frames) return {options.frame, 1.0};
  return {static_cast<double>(options.sequence.frames->first),
          static_cast<double>(options.sequence.frames->step)};
}

std::optional<ChosenEffect> checked_effect_of_frames(const RenderOptions& options,
                                                     const Scene& scene) {
  const std::string where =
      options.effects.are_given ? "--effect" : "the scene '" + options.scene + "'";
  const auto effect = effect_of_frames(effects_on(options, scene), where);
  if (!effect) return {};
  const std::string name = where + ": " + std::string{effect->effect->name};
  if (options.gl != nullptr) {
    throw UsageError(name + " draws its frames in the emulation; leave out --gl");
  }
  if (options.show == Show::image && options.method.filter == nullptr) {
    throw UsageError(name + " makes the picture that a method filters, and --method " +
                     std::string{options.method.name()} +
                     " draws the scene itself; give a method of a picture, or pinhole");
  }
  return effect;
}

Pixel focus_pixel(const RenderOptions& options) {
  return options.autofocus_pixel.value_or(Pixel{options.size.width / 2, options.size.height / 2});
}

}  // namespace softfocus
