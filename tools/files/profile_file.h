#pragma once
// A profile as a TOML file: what `probe` writes and `--profile FILE` reads.

#include <filesystem>
#include <string>

#include "raster/numbers/profile.h"

namespace softfocus {

/// The whole file, one key a line with what it means. `heading` becomes comment lines
/// on top: which driver, which version.
std::string profile_text(const Profile& profile, const std::string& heading);

/// Reads a profile. A key that is missing has ieee's value; `name` must be there. Throws
/// SceneError naming the file, the line, the key and what would be right.
Profile load_profile(const std::filesystem::path& file);

}  // namespace softfocus
