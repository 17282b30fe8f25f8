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

/// What became of a golden.
struct GoldenResult {
  Verdict verdict = Verdict::breaks;
  std::string why;   ///< of any but `passes`: one line
  std::string hash;  ///< of the picture that was made; empty if none was
  double ms = 0.0;
  std::optional<Image> got{}, expected{};  ///< of what fails or is new, as far as they are there
};

/// The folders of a check.
struct GoldenPlaces {
  std::filesystem::path manifest;  ///< the folder
  std::filesystem::path report;    ///< what is made goes here
};

/// The file that a golden writes: .npy for every bit, but from a command the ending of its
/// `picture`, or .png.
std::filesystem::path made_file(const Golden& golden, const GoldenPlaces& places);

/// Removes it, and the sidecar that says how it was made.
void remove_made(const Golden& golden, const GoldenPlaces& places);

/// What a shell runs.
std::string shell_command(const Golden& golden, const GoldenPlaces& places);

/// Makes a golden's file. The reason if it does not, in a line.
std::optional<std::string> make_golden(const Golden& golden, const GoldenPlaces& places);

/// Makes it and judges it. What passes leaves no file. Several at once by any threads.
GoldenResult check_golden(const Golden& golden, const GoldenPlaces& places);

/// Judges a picture that was made.
void judge(const Golden& golden, const GoldenPlaces& places, Image made, GoldenResult& result);

/// As the files of a format have it: what a PNG cuts and rounds is cut and rounded.
Image as_file_has_it(const Image& picture, FileFormat format);

}  // namespace softfocus
