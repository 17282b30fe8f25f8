#include "tools/render/frame_sequence.h"

#include <cmath>
#include <string>

#include "tools/cli/errors.h"

namespace softfocus {
FrameSequence frame_sequence(const RenderOptions& options) {
  if (!options.sequence.frames) return {options.frame, 1.0};
  return {static_cast<double>(options.sequence.frames->first),
          static_cast<double>(options.sequence.frames->step)};
}

void draw_up_to(PreparedScene& prepared, const ChosenEffect& effect, double frame, int width,
                int height, FrameSequence& sequence, ThreadPool& pool) {
  const int warm_up = warm_up_frames(effect);
  const int wanted =
      warm_up + static_cast<int>(std::lround((frame - sequence.first) / sequence.step));
  FrameHistory& history = sequence.history;
  if (history.count > wanted) history.count = 0;
  const FrameEffect made = frame_effect(effect);
  while (history.count <= wanted) {
    draw_next(prepared, made, sequence.first + (history.count - warm_up) * sequence.step, width,
              height, history, pool);
  }
}

std::optional<ChosenEffect> checked_effect_of_frames(const RenderOptions& options,
                                                     const Scene& scene) {
  const bool is_image = options.show == Show::image;
  const std::string where =
      options.effects.are_given ? "--effect" : "the scene '" + options.scene + "'";
  const auto effect =
      effect_of_frames(all_effects(options.effects, is_image ? std::span{scene.effects}
                                                             : std::span<const ChosenEffect>{}),
                       where);
  if (!effect) return {};
  const std::string name = where + ": " + std::string{effect->effect->name};
  if (options.gl != nullptr) {
    throw UsageError(name + " draws its frames in the emulation; leave out --gl");
  }
  if (is_image && (options.method.of_scene != nullptr || options.method.is_auto())) {
    throw UsageError(name + " makes the picture that a method filters, and --method " +
                     std::string{options.method.name()} +
                     " draws the scene itself; give a method of a picture, or pinhole");
  }
  return effect;
}

}  // namespace softfocus
