#pragma once
// A colour and its depth from one file or two, as `refocus` and `inspect` read them.

#include <optional>
#include <string>
#include <vector>

#include "tools/cli/parser.h"
#include "tools/pictures/picture_notes.h"
#include "tools/refocus/chosen_layers.h"
#include "tools/refocus/depth/believed_encoding.h"
#include "tools/refocus/depth/depth_map.h"
#include "tools/refocus/depth/mend_depth.h"
#include "tools/refocus/photo_lens.h"

namespace softfocus {

/// The fate of pixels without a depth.
enum class Holes : std::uint8_t { from_far_side, refused };

struct DepthOptions {
  std::optional<std::string> layer;  ///< of the colour
  std::optional<std::string> depth_layer;
  std::optional<std::string> mask;          ///< a file that is 0 where the depth is missing
  const DepthEncoding* encoding = nullptr;  ///< none: as believed
  DepthNumbers numbers;
  std::optional<DepthAlong> along;  ///< none: the encoding's
  std::vector<double> missing_codes;
  Holes holes = Holes::from_far_side;
  Mending mending;
};

/// Adds --layer, --depth-layer, --depth-encoding, its numbers, --depth-along, --missing, --mask,
/// --holes and the three ways of mending.
void add_depth_options(CLI::App& parser, DepthOptions& options);

/// Files whose headers were read.
struct PictureSources {
  PictureFile colour_file;
  std::optional<PictureFile> depth_file{};  ///< none: the colour's
  ColourLayer colour{};
  std::size_t depth_plane = 0;
  std::optional<PictureNotes> notes{};  ///< of the colour's file
  HeaderLens lens{};                    ///< likewise, if there are no notes

  const PictureFile& of_depth() const { return depth_file ? *depth_file : colour_file; }
};

/// Opens COLOUR and, unless it is empty, DEPTH, and chooses layers. Throws FileError; UsageError
/// for layers that are not there and a depth of another shape than the colour.
PictureSources open_sources(const std::string& colour, const std::string& depth,
                            const DepthOptions& options);

/// Opens files that stay on the disk. Nothing, with the reason in `why`, if one of them is read
/// whole, or they differ in size.
std::optional<PictureSources> open_sources_on_disk(const std::string& colour,
                                                   const std::string& depth,
                                                   const DepthOptions& options, std::string& why);

/// A depth map and how it was read.
struct ReadDepth {
  DepthMap map{};  ///< of the colour's size, nothing missing
  NumbersSeen seen{};
  const DepthEncoding* encoding = nullptr;
  std::string why{};  ///< of a believed encoding
  DepthAlong along = DepthAlong::axis;
  int width = 0, height = 0;  ///< of the file's map
  DepthEnds ends{};
  std::size_t filled = 0;  ///< missing depths of the file's map
  MendedDepth mended{};
};

/// Settles the encoding, asked for or believed by `read.seen`. Throws UsageError if it cannot be
/// told or lacks numbers.
void settle_encoding(const PictureSources& sources, const DepthOptions& options, ReadDepth& read);

/// How the codes of the depth's file are read then, but for their ends.
DepthReading depth_reading(const PictureSources& sources, const DepthOptions& options,
                           const PhotoLens& photo, const ReadDepth& read);

/// Reads the depth of `sources`, mends it beside `colour` (RGBA16F) and fills what is missing.
/// Throws FileError; UsageError for an encoding that cannot be told or lacks numbers, and missing
/// depths that are not to be filled.
ReadDepth read_depth(const PictureSources& sources, const Image& colour,
                     const DepthOptions& options, const PhotoLens& photo, ThreadPool& pool);

}  // namespace softfocus
