#include "tools/refocus/source_rows.h"

#include <algorithm>

namespace softfocus {

SourceRows::SourceRows(const PictureSources& sources, const WantedRows& wanted)
    : sources_(sources), halves_(sources.colour_file, sources.colour, false) {
  const PictureFile& file = sources.colour_file;
  if (wanted.colour) {
    for (const std::size_t plane : halves_.planes()) colour_.push_back(want(file, plane, 0.0f));
  }
  if (wanted.alpha) alpha_.push_back(want(file, *sources.colour.alpha, 0.0f));
  if (wanted.depth) {
    const PictureFile& of_depth = sources.of_depth();
    for (const std::size_t plane : planes_of_depth(of_depth, sources.depth_plane)) {
      depth_.push_back(want(of_depth, plane, kNoDepthThere));
    }
  }
  for (Group& group : groups_) group.read = rows_of(*group.file, group.planes);
}

SourceRows::Place SourceRows::want(const PictureFile& file, std::size_t plane, float outside) {
  std::size_t at = 0;
  for (; at < groups_.size(); ++at) {
    const auto& planes = groups_[at].planes;
    // A plane that is wanted twice, as colour and as depth, is read twice.
    const bool is_free = std::find(planes.begin(), planes.end(), plane) == planes.end();
    if (groups_[at].file == &file && is_free) break;
  }
  if (at == groups_.size()) groups_.push_back({&file, {}, {}, {}, {}});
  Group& group = groups_[at];
  group.planes.push_back(plane);
  group.outside.push_back(outside);
  group.values.emplace_back();
  return {at, group.planes.size() - 1};
}

void SourceRows::read(Rows rows) {
  const int width = sources_.colour_file.width;
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(rows.count);
  for (Group& group : groups_) {
    for (std::size_t i = 0; i < group.values.size(); ++i) {
      group.values[i].assign(pixels, group.outside[i]);
    }
    group.read(rows, group.values);
  }
  if (!colour_.empty()) {
    if (colour.height != rows.count) colour = make_image(Format::rgba16f, width, rows.count);
    for (std::size_t i = 0; i < colour_.size(); ++i) halves_.put(i, values_of(colour_[i]), colour);
  }
  if (!alpha_.empty()) alpha.swap(values_of(alpha_[0]));
  if (depth_.empty()) return;
  if (depth_.size() > 1) {
    std::vector<PlaneValues> all;
    for (const Place place : depth_) all.push_back(values_of(place));
    check_one_depth(sources_.of_depth(), all);
  }
  codes.swap(values_of(depth_[0]));
}

}  // namespace softfocus
