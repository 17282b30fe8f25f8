#pragma once
// From the options of `render` to the shot that the frame maker takes.

#include "scenes/frame/frame.h"
#include "tools/render/options.h"

namespace softfocus {

/// What is asked for of this scene. Throws UsageError for a lens that cannot be. `sequence` is that
/// of frames that depend on those before.
Shot asked_shot(const RenderOptions& options, const Scene& scene, FrameSequence& sequence);

/// Says in the words of the options why a lens cannot be.
[[noreturn]] void refuse_lens(const LensError& error, const RenderOptions& options);

/// That of --frames, or of the one frame.
FrameSequence frame_sequence(const RenderOptions& options);

/// The effect that makes frames from those before, if there is one. Throws UsageError if it does
/// not go with the other options.
std::optional<ChosenEffect> checked_effect_of_frames(const RenderOptions& options,
                                                     const Scene& scene);

/// The pixel of --autofocus.
Pixel focus_pixel(const RenderOptions& options);

}  // namespace softfocus
