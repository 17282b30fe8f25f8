#pragma once
// A golden made anew, and held against what is expected.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "tools/goldens/manifest.h"
#include "tools/pictures/image_file.h"

namespace softfocus {

enum class Verdict : std::uint8_t { passes, fails, is_new, breaks };

/// PNG in base64, to be shown; empty if there is none.
struct ShownPictures {
  std::string got, expected, difference;
};

/// What became of a golden.
struct GoldenResult {
  Verdict verdict = Verdict::breaks;
  std::string why{};   ///< of any but `passes`: one line
  std::string hash{};  ///< of the picture that was made; empty if none was
  double ms = 0.0;
  ShownPictures shown{};  ///< of what fails or is new
};

/// The folders of a check.
struct GoldenPlaces {
  std::filesystem::path manifest;  ///< the folder
  std::filesystem::path report;
  std::filesystem::path made() const { return report / "made"; }  ///< what goldens write
};

/// The file that a golden writes: .npy for every bit, but from a command with {out} the ending of
/// its `picture`, or .png.
std::filesystem::path made_file(const Golden& golden, const GoldenPlaces& places);

/// Removes it, and the sidecar that says how it was made.
void remove_made(const Golden& golden, const GoldenPlaces& places);

/// What a shell runs in the manifest's folder.
std::string shell_command(const Golden& golden, const GoldenPlaces& places);

/// Makes a golden's file, in a folder that is there. The reason if it does not, in a line; then
/// there is no file.
std::optional<std::string> make_golden(const Golden& golden, const GoldenPlaces& places);

/// Makes it and judges it. What passes leaves no file. Several at once by any threads.
GoldenResult check_golden(const Golden& golden, const GoldenPlaces& places);

}  // namespace softfocus
