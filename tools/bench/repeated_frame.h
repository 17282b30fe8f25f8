#pragma once
// A frame that is made from those before, again and again: what `bench --effect temporal-aa` times.

#include "scenes/temporal/frame_history.h"
#include "tools/bench/work.h"

namespace softfocus {

struct RepeatedFrame {
  FrameEffect effect;
  FrameHistory history;  ///< up to the frame's passes, with what they read
  Image frames;          ///< that the passes write, R32F
  Image between;
};

/// Draws the history of the work's frame: the effect's `warm-up` frames before it, or 7 where that
/// is 0, with a step of 1; and one more if the frame would be drawn whole. Needs a scene.
RepeatedFrame make_repeated_frame(const ChosenEffect& chosen, const BenchWork& work,
                                  ThreadPool& pool);

/// The passes alone; the history stays as it is.
void run(RepeatedFrame& frame, Image& picture, const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
