#pragma once
// Our contender: a frame drawn and given its depth of field again and again.

#include "scenes/frame/frame.h"
#include "tools/bench/work.h"

namespace softfocus {

/// The work, and what its stages leave for the next frame: memory, and what a driver has in place
/// as well (decoded textures).
struct OurFrame {
  const BenchWork& work;
  ThreadPool& pool;
  bool one_picture =
      false;  ///< a filter gets no transparent layers: beside a driver, which has none
  FrameMemory memory{};
  DrawnFrame drawn{};
  Frame filtered{};
  Image copy{};  ///< of a pass's picture, if copies are timed
};

/// Draws the scene, with the objects' numbers if the method reads them; needs one.
void draw(OurFrame& frame);

/// Gives depth of field to what was drawn, or to the work's picture. Auto looks at the picture and
/// chooses each time.
void filter(OurFrame& frame);

/// Copies a picture of the frame's size, as a program without frame-buffer objects does after each
/// pass. Our filter keeps what is between its passes in the caches, so it is one of the same size
/// that is copied.
void copy(OurFrame& frame, const Image& picture);

}  // namespace softfocus
