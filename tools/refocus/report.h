#pragma once
// Report of a refocus, to read or as JSON, and as notes in the picture.

#include <string>
#include <vector>

#include "tools/refocus/refocused.h"

namespace softfocus {

/// Words once the files are there.
struct Refocused {
  Bytes picture{};      ///< of -o -
  std::string depth{};  ///< one line: what was believed of the depth
  std::vector<std::string> warnings{};
  std::string report{}, json{};
};

/// What was believed of the depth, and how the colours are taken.
std::string depth_line(const RefocusOptions& options, const PictureSources& sources,
                       const ReadDepth& depth, const UsedRefocus& used);
/// Empty unless a guess puts most of the picture where few pictures have anything.
std::string odd_depth_warning(const PictureSources& sources, const ReadDepth& depth);

std::string refocus_text(const RefocusOptions& options, const PictureSources& sources,
                         const ReadDepth& depth, const UsedRefocus& used);
std::string refocus_json(const RefocusOptions& options, const PictureSources& sources,
                         const ReadDepth& depth, const UsedRefocus& used, std::uint64_t hash);

/// Notes for a picture of that size; `hash` is its hash_image().
PictureNotes refocus_notes(const RefocusOptions& options, const UsedRefocus& used, int width,
                           int height, std::uint64_t hash);

/// Fills in the report and the JSON, and warns if circles were cut.
void tell(const RefocusOptions& options, const PictureSources& sources, const ReadDepth& depth,
          const UsedRefocus& used, std::uint64_t hash, Refocused& made);

std::string cut_light_warning(const std::string& colour, std::size_t cut, int light_power);
/// Empty if the format keeps the file's profile, or there is none.
std::string lost_profile_warning(const PictureFile& file, FileFormat format);
std::string lost_view_warning(const std::string& colour, const OtherView& view);
std::string lost_alpha_warning(const std::string& colour);

std::string_view name_of(DepthAlong along);

}  // namespace softfocus
