#pragma once
// Which layers of one or two files are the colour and the depth.

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/pictures/picture_file.h"

namespace softfocus {

/// The layer of that name ("ViewLayer.Combined"), or whose name alone ends so ("Combined"), or
/// without a name: plain R, G, B, else Blender's
/// Combined, else the first. Throws UsageError that names `option` and lists those there are.
ColourLayer choose_colour(const PictureFile& file, const std::optional<std::string>& name,
                          const std::string& option);

// Views, as the eyes of a stereo picture.

/// The plane's name without its view: "ViewLayer.Depth.Z" of "ViewLayer.Depth.right.Z".
std::string name_without_view(const PlaneInfo& plane);

/// The plane that has that name in another view.
std::optional<std::size_t> plane_in_view(const PictureFile& file, std::size_t plane,
                                         const std::string& view);

/// The layer likewise.
std::optional<ColourLayer> layer_in_view(const PictureFile& file, const ColourLayer& layer,
                                         const std::string& view);

/// Depth planes that the names of the channels tell, best first: Z, depth.Z, ViewLayer.Depth.V,
/// VRayZDepth.R, FinalImageMovieRenderQueue_WorldDepth.R, a Z without X and Y, ...
/// Not Position.Z or Normal.Z.
std::vector<std::size_t> depth_planes(const PictureFile& file);

/// The depth in a file that holds a colour too: the first of depth_planes(), or a NumPy file's
/// alpha.
std::optional<std::size_t> find_depth_beside_colour(const PictureFile& file);

/// The plane of that name or of the layer of that name, or whose name alone ends so; without a
/// name, `of_circles`, our own channel coc, find_depth_beside_colour() if it is `beside_colour`,
/// else the first of depth_planes() or the file's one plane. Throws UsageError likewise.
std::size_t choose_depth(const PictureFile& file, const std::optional<std::string>& name,
                         bool beside_colour, bool of_circles = false);

/// Stands for a depth that an EXR lacks.
inline constexpr float kNoDepthThere = std::numeric_limits<float>::quiet_NaN();

/// The plane, and the two beside it if it is red: a grey picture in three channels.
std::vector<std::size_t> planes_of_depth(const PictureFile& file, std::size_t plane);

/// Throws UsageError if the values of those differ.
void check_one_depth(const PictureFile& file, std::span<const PlaneValues> values);

/// Its codes. Throws UsageError if they are one of three channels that differ: that is a picture
/// and no depth.
PlaneValues depth_codes(const PictureFile& file, std::size_t plane);

}  // namespace softfocus
