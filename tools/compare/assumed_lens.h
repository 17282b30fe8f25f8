#pragma once
// Which lens the regions are of, and who says so.

#include <optional>
#include <string>
#include <vector>

#include "tools/compare/options.h"
#include "tools/pictures/picture_notes.h"

namespace softfocus {

/// A picture's file and its notes.
struct NamedNotes {
  std::string name;  ///< of the picture, as it was given
  FoundNotes found;
};

struct AssumedLens {
  NotedLens lens;
  std::string source;              ///< "scene", "picture", "options" or "default"
  std::string name;                ///< of the scene or of the file that has the lens; else empty
  std::vector<std::string> given;  ///< the options that overrule the source
  std::vector<std::filesystem::path> files;  ///< that the scene was read from
};

/// The lens for --regions: of --scene, else the first that a picture carries, else ThinLens's and
/// 40 degrees; in each of them the options that were given overrule. Throws UsageError for a lens
/// that cannot be, and SceneError.
AssumedLens assumed_lens(const CompareOptions& options, const std::vector<NamedNotes>& pictures);

/// "85 mm, f/2, focused at 1 m, coc scale 1, field of view 28 degrees".
std::string lens_text(const NotedLens& lens);

/// Who says so: "by a.npy.json", "by the scene figures, --focus as given".
std::string source_text(const AssumedLens& assumed);

/// A line each, on what is doubtful: pictures of two lenses, a sidecar of another picture.
std::vector<std::string> lens_doubts(const std::vector<NamedNotes>& pictures);

}  // namespace softfocus
