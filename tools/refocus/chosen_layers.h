#pragma once
// Which layers of one or two files are the colour and the depth.

#include <optional>
#include <string>

#include "tools/files/picture_file.h"

namespace softfocus {

/// The layer of that name ("ViewLayer.Combined"), or without a name: plain R, G, B, else Blender's
/// Combined, else the first. Throws UsageError that names `option` and lists those there are.
ColourLayer choose_colour(const PictureFile& file, const std::optional<std::string>& name,
                          const std::string& option);

/// Depth planes that the names of the channels tell, best first: Z, depth.Z, ViewLayer.Depth.V, ...
/// Not Position.Z or Normal.Z.
std::vector<std::size_t> depth_planes(const PictureFile& file);

/// The depth in a file that holds a colour too: the first of depth_planes(), or a NumPy file's
/// alpha.
std::optional<std::size_t> find_depth_beside_colour(const PictureFile& file);

/// The plane of that name or of the layer of that name; without a name
/// find_depth_beside_colour() if it is `beside_colour`, else the first of depth_planes() or the
/// file's one plane. Throws UsageError likewise.
std::size_t choose_depth(const PictureFile& file, const std::optional<std::string>& name,
                         bool beside_colour);

/// Its codes. Throws UsageError if they are one of three channels that differ: that is a picture
/// and no depth.
PlaneValues depth_codes(const PictureFile& file, std::size_t plane);

}  // namespace softfocus
