#pragma once
// A picture with depth, as a lens focused elsewhere would have made it.

#include <optional>
#include <vector>

#include "dof/auto/auto_method.h"
#include "tools/refocus/options.h"

namespace softfocus {

/// Settings that were used.
struct UsedRefocus {
  SettledLens lens{};
  DofSettings settings{};
  const Method* method = nullptr;
  std::optional<AutoMethod> choice{};  ///< of auto
  float largest_circle_px = 0.0f;
  double brightest = 0.0;  ///< of the file's colours
  int light_power = 0;     ///< they are filtered divided by 2^light_power
  std::size_t cut = 0;     ///< and so many values cut to the largest half
  std::size_t unmixed_pixels = 0;
  bool by_rows = false;     ///< read, filtered and written a band of rows at a time
  std::string why_whole{};  ///< why not
};

/// Settings of two-pass and its kin, but for max_coc_px, which waits for the largest circle.
void begin_settings(const RefocusOptions& options, UsedRefocus& used);

/// The depths that the filter sees: those in the sharp range moved into focus, none infinite.
void move_to_seen(DepthMap& map, const std::optional<SharpDepthRange>& range);

/// The largest circle, and what max_coc_px follows from it. `picture` has all depths seen.
void settle_largest_circle(const ConstImageView& picture, const RefocusOptions& options,
                           UsedRefocus& used, ThreadPool& pool);

/// Metres as the result's alpha; of circles, which lie at no depth, 0.
void put_depth_in_alpha(const RefocusOptions& options, const PlaneValues& metres, Image& picture);

/// A picture with depth. RGBA16F, depth in alpha, its colour times its opacity.
struct PictureOnItsWay {
  Image picture{};
  PlaneValues opacity{};  ///< 0 to 1, a number a pixel; empty: all is opaque
  int light_power = 0;    ///< colours are to be multiplied by 2^light_power
};

/// The alpha of `source` becomes the depth, here and in the result. The picture or the map that
/// `options.show` asks for; a map has no opacity.
PictureOnItsWay refocused(PictureOnItsWay source, const DepthMap& depth,
                          const RefocusOptions& options, UsedRefocus& used, ThreadPool& pool);

/// The colour, and the alpha if there is one, as planes of a file.
void add_planes(const PictureOnItsWay& picture, const ColourLayer& colour,
                std::vector<ReplacedPlane>& planes);

/// The circles that were used, in pixels, negative nearer than the focus.
PlaneValues circle_radii(const DepthMap& depth, const UsedRefocus& used);

// The file of a refocused picture.

/// Whether a file of this format is an EXR.
bool is_of_exr(FileFormat format);

/// The file's profile, unless colours were converted from it.
std::span<const std::byte> kept_profile(const PictureFile& file);

/// Whether a file of that format has a place for a profile of its colours.
bool keeps_profile(FileFormat format);

/// The planes of the colour's file that are neither the colour nor its depth.
std::vector<std::size_t> other_planes(const PictureSources& sources);

/// Whether a file of that format has a place for alpha.
bool keeps_alpha(FileFormat format);

/// Whether the file has place for pixels beside those that are shown.
bool keeps_data_window(const RefocusOptions& options, const PictureSources& sources);

/// Cuts pixels of that file, and a depth, to those that are shown. Where there are none, black.
void cut_to_shown(const PictureFile& file, PictureOnItsWay& picture, PlaneValues* depth);

/// The planes that are kept as they are if an EXR becomes an EXR.
std::vector<std::size_t> kept_planes(const RefocusOptions& options, const PictureSources& sources);

/// The file's bytes: the picture with its notes and, if the format can, its alpha. An EXR has the
/// depth in floats and the circles too, and from an EXR its attributes and, unless
/// `options.keep_layers` is off, its other layers, in the place of some `views`.
Bytes refocused_file(const RefocusOptions& options, const PictureSources& sources,
                     const DepthMap& depth, const UsedRefocus& used, const PictureOnItsWay& result,
                     const PictureNotes& notes, std::span<const ReplacedPlane> views = {});

}  // namespace softfocus
