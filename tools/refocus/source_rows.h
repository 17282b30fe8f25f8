#pragma once
// A picture with depth out of files that stay on the disk, a band of rows at a time.

#include <vector>

#include "tools/refocus/picture_with_depth.h"

namespace softfocus {

/// Which of it is wanted.
struct WantedRows {
  bool colour = false, alpha = false, depth = false;
};

class SourceRows {
 public:
  /// Needs the sources as long as it lives.
  SourceRows(const PictureSources& sources, const WantedRows& wanted);

  /// Throws FileError; UsageError for a depth of three channels that differ.
  void read(Rows rows);

  Image colour{};       ///< RGBA16F, of light; alpha is 0
  PlaneValues alpha{};  ///< as they are in the file
  PlaneValues codes{};  ///< of the depth

 private:
  /// Planes of one file, read together: they may lie in the same compressed blocks.
  struct Group {
    const PictureFile* file;
    std::vector<std::size_t> planes;
    std::vector<float> outside;  // of each plane
    ReadRows read;
    std::vector<PlaneValues> values;
  };
  struct Place {
    std::size_t group, plane;
  };

  Place want(const PictureFile& file, std::size_t plane, float outside);
  PlaneValues& values_of(Place place) { return groups_[place.group].values[place.plane]; }

  const PictureSources& sources_;
  ColourHalves halves_;
  std::vector<Group> groups_{};
  std::vector<Place> colour_{}, alpha_{}, depth_{};
};

}  // namespace softfocus
