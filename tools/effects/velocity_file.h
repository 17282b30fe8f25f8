#pragma once
// A velocity from a file.

#include <filesystem>

#include "raster/images/image.h"

namespace softfocus {

/// Contents of such a file, for help and messages.
inline constexpr const char* kVelocityFiles =
    "NPY of shape (height, width, 2), or EXR with channels X and Y, or R and G alone";

/// RG16F of that size: an EXR's channels X and Y, or R and G without B, or the two that a file has.
/// Numbers beyond the largest half are cut to it. Throws FileError for a file that cannot be read,
/// UsageError for one of another shape.
Image read_velocity(const std::filesystem::path& path, int width, int height);

}  // namespace softfocus
