#pragma once
// What a render did and how long it took, to read or as JSON. The text follows the
// thesis's report: times without depth of field, with it, and its cost.

#include <optional>
#include <string>

#include "scenes/frame/frame.h"
#include "tools/render/options.h"

namespace softfocus {

/// Milliseconds of wall time.
struct StageTimes {
  double load = 0.0;
  double draw = 0.0;
  double focus = 0.0;   ///< finding the focus and the per-frame constants
  double choose = 0.0;  ///< of auto: looking at the picture and at the table
  double check = 0.0;   ///< of auto: holding the picture against views of the lens
  double filter = 0.0;  ///< the method, or the map that --show asks for
  double encode = 0.0;
  double write = 0.0;
};

struct RenderRecord {
  std::string scene_name{};
  std::string scene_title{};
  std::size_t triangles = 0;
  Camera camera{};                      ///< at the frame
  std::string made{};                   ///< of a large picture: by rows, or why not
  std::uint64_t picture_hash = 0;       ///< hash_image()
  std::string gl_renderer{};            ///< of --gl; else empty
  std::vector<ChosenEffect> effects{};  ///< on the finished picture
  Frame frame{};
  StageTimes ms{};
};

std::string_view name_of(Show show);

/// Whether the method was at work, and not a map or the picture before it.
bool has_depth_of_field(const RenderOptions& options);

std::string text_report(const RenderOptions& options, const RenderRecord& record);
std::string json_report(const RenderOptions& options, const RenderRecord& record);

}  // namespace softfocus
