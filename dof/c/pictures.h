#pragma once
// Pictures in a C program's memory as methods read and write them.

#include <cstdint>
#include <span>
#include <vector>

#include "dof/c/settings.h"
#include "dof/c/softfocus.h"
#include "dof/dof.h"
#include "raster/images/image.h"

namespace softfocus {

/// Where the caller's memory is RGBA16F with depth in alpha, a view of it; else of a copy.
struct ReadPicture {
  Image copy;
  ConstImageView view;
};

/// A picture and all that came with it.
struct ReadFrame {
  ReadPicture scene;
  std::vector<ReadPicture> layers;  ///< behind and transparent ones, with their opacities
  std::vector<ConstImageView> behind;
  std::vector<TransparentLayer> transparent;
  std::span<const std::uint16_t> objects;
  std::span<const float> radii_px;
  std::vector<MemoryRange> in_use;  ///< the caller's memory that a method reads
};

/// Throws BadArgument and std::bad_alloc.
ReadFrame read_frame(const softfocus_picture* picture, ThreadPool& pool);

/// Where the result goes, checked for a picture of this size. Throws BadArgument.
class ResultTarget {
 public:
  ResultTarget(const softfocus_target* target, int width, int height);

  /// What a method writes: the caller's memory, or a picture in `own` that finish() brings there.
  ImageView place(const ReadFrame& frame, Image& own) const;
  void finish(const ConstImageView& result, ThreadPool& pool) const;

 private:
  softfocus_target target_;
  int width_, height_;
};

}  // namespace softfocus
