#pragma once
// A frame that is drawn and filtered a band of rows at a time: the bits of make_frame(), in memory
// that grows with the picture's width, the radius and the scene, not with its height.

#include <functional>
#include <memory>
#include <string>

#include "scenes/frame/frame.h"

namespace softfocus {

/// Why a shot has to be made whole; empty if it need not. Its pool's `isa` counts.
std::string why_whole(const Shot& shot, Isa isa);

/// Rows of the picture that come next, RGBA16F, until the call returns: what was drawn, or what
/// was made of it.
using FrameBandSink = std::function<void(const ConstImageView& rows)>;

class FrameRows {
 public:
  /// Needs a shot without a reason to be whole. Sorts the triangles. `on_stage` is told as drawing
  /// and filtering begin, again and again, and when they are done. Shot, pool and what `on_stage`
  /// refers to must outlive it. Throws LensError.
  FrameRows(const Shot& shot, ThreadPool& pool,
            const std::function<void(FrameStage)>& on_stage = {});
  ~FrameRows();
  FrameRows(const FrameRows&) = delete;
  FrameRows& operator=(const FrameRows&) = delete;

  /// As make_frame() gives them, without a picture.
  const Frame& frame() const;

  /// Makes the next `count` rows, 1 at least, into `to`, of that height. `on_drawn` is told of
  /// each band that is drawn.
  void make(int count, Image& to, const FrameBandSink& on_drawn);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace softfocus
