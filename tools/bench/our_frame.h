#pragma once
// Our contender: a frame drawn and given its depth of field again and again.

#include <cstdint>
#include <optional>
#include <vector>

#include "dof/auto/auto_method.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/filtered_views/filtered_views.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/warped_views/warped_views.h"
#include "tools/bench/work.h"

namespace softfocus {

/// The work, and what its stages leave for the next frame: memory, and what a driver has in place
/// as well (decoded textures).
struct OurFrame {
  const BenchWork& work;
  ThreadPool& pool;
  bool one_picture =
      false;  ///< a filter gets no transparent layers: beside a driver, which has none
  std::optional<PreparedScene> scene{};
  std::optional<AccumulationBuffer> views{};
  std::optional<FilteredViewsBuffer> filtered_views{};
  std::optional<WarpedViewsBuffer> warped_views{};
  Image drawn{};
  std::vector<Image> behind{};  ///< the layers behind it, if the method reads them
  std::vector<TransparentPicture> transparent{};  ///< layers before it, for a filter
  std::vector<std::uint16_t> objects{};  ///< the drawn objects' numbers, if the method reads them
  Image filtered{};
  Image copy{};                        ///< of a pass's picture, if copies are timed
  std::optional<AutoMethod> choice{};  ///< of auto
  int samples = 0;                     ///< taken by a method that draws the scene
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
