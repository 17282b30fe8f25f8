#pragma once
// A profile as a TOML file: what `probe` writes and `--profile FILE` reads.

#include <filesystem>
#include <string>

#include "raster/numbers/profile.h"

namespace softfocus {

/// A profile with a name of its own: read from a file, or found by experiment.
struct ChosenProfile {
  std::string name;
  std::string summary;
  Profile profile;
  std::filesystem::path file{};  ///< that it was read from; else empty
};

/// The whole file, one key a line with what it means. `heading` becomes comment lines
/// on top: which driver, which version.
std::string profile_text(const ChosenProfile& chosen, const std::string& heading);

/// Reads a profile. A key that is missing has ieee's value; `name` must be there. Throws
/// SceneError naming the file, the line, the key and what would be right.
ChosenProfile load_profile(const std::filesystem::path& file);

}  // namespace softfocus
