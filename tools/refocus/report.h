#pragma once
// What a refocus did, to read or as JSON, and as notes in the picture.

#include "tools/refocus/refocused.h"

namespace softfocus {

std::string refocus_text(const RefocusOptions& options, const PictureSources& sources,
                         const ReadDepth& depth, const UsedRefocus& used);
std::string refocus_json(const RefocusOptions& options, const PictureSources& sources,
                         const ReadDepth& depth, const UsedRefocus& used, std::uint64_t hash);

PictureNotes refocus_notes(const RefocusOptions& options, const UsedRefocus& used,
                           const Image& picture);

/// "near 0.71 m, far 12 m" of a map without missing depths.
std::string depth_range_text(const DepthMap& map);

std::string_view name_of(DepthAlong along);

}  // namespace softfocus
