#pragma once
// Frames that depend on those before (scenes/temporal): where they begin, and how far they are.

#include <optional>

#include "scenes/temporal/frame_history.h"
#include "tools/render/options.h"

namespace softfocus {

/// Frame i of the sequence is first + i step. It begins `warm-up` frames before the first that is
/// asked for, so that a frame's bits depend on where the run begins, but not on which of its frames
/// are made anew.
struct FrameSequence {
  double first = 0.0;
  double step = 1.0;
  FrameHistory history{};
};

/// That of --frames, or of the one frame.
FrameSequence frame_sequence(const RenderOptions& options);

/// Draws what is missing up to this frame, from the beginning if the history is past it. The frame
/// is then history.picture.
void draw_up_to(PreparedScene& prepared, const ChosenEffect& effect, double frame, int width,
                int height, FrameSequence& sequence, ThreadPool& pool);

/// The effect that makes frames from those before, if there is one. Throws UsageError if it does
/// not go with the other options.
std::optional<ChosenEffect> checked_effect_of_frames(const RenderOptions& options,
                                                     const Scene& scene);

}  // namespace softfocus
