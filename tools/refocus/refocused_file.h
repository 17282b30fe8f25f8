#pragma once
// The file of a refocused picture.

#include <vector>

#include "tools/refocus/refocused.h"

namespace softfocus {

/// Whether a file of this format is an EXR.
bool is_of_exr(FileFormat format);

/// The planes of the colour's file that are neither the colour nor its depth.
std::vector<std::size_t> other_planes(const PictureSources& sources);

/// Whether a file of that format has a place for alpha.
bool keeps_alpha(FileFormat format);

/// The planes that are kept as they are if an EXR becomes an EXR.
std::vector<std::size_t> kept_planes(const RefocusOptions& options, const PictureSources& sources);

/// The file's bytes: the picture with its notes and, if the format can, its alpha. An EXR has the
/// depth in floats and the circles too, and from an EXR its attributes and, unless
/// `options.keep_layers` is off, its other layers.
Bytes refocused_file(const RefocusOptions& options, const PictureSources& sources,
                     const DepthMap& depth, const UsedRefocus& used, const PictureOnItsWay& result,
                     const PictureNotes& notes);

}  // namespace softfocus
