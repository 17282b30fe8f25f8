#pragma once
// goldens.toml: pictures that have to stay as they are, and how each is made. A [[golden]] has
//
//   name      of its files: letters, digits, '.', '_' and '-', the first a letter, digit or '_'
//   scene     render's scene; or
//   pipeline  or shader, apply's, with `input`, the picture; or
//   command   what a shell runs in the manifest's folder. {out} in it is the file to write; without
//             {out} the first word is softfocus, and -o with the file comes last
//   options   more words for the first three
//   hash      of the picture's bits, as render reports it
//   was       hashes that were accepted before, the last one first
//   picture   a file beside the manifest, .png, .npy, .exr, .pfm, .hdr or .tiff: what is expected,
//             to be looked at, and to be measured against if there is a tolerance or no hash
//   max_ulps, max_flip, max_error, max_pixels, max_difference, search   as compare's options
//
// Paths are relative to the manifest's folder.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/compare/options.h"

namespace softfocus {

inline constexpr const char* kManifestName = "goldens.toml";
inline constexpr std::size_t kMostManifestBytes = std::size_t{16} << 20;

struct Golden {
  std::string name;
  std::string scene, pipeline, shader, input, command, options;
  std::optional<std::string> hash;
  std::vector<std::string> was{};
  std::optional<std::string> picture;
  Tolerance tolerance{};

  bool operator==(const Golden&) const = default;
};

/// Throws SceneError, which names file and line.
std::vector<Golden> parse_goldens(const std::string& text, const std::filesystem::path& file);

/// In a command, the file that it is to write.
inline constexpr std::string_view kOut = "{out}";
inline bool has_out(const Golden& golden) { return golden.command.find(kOut) != std::string::npos; }

/// What the goldens' maker is: "scene portrait", a command.
std::string maker_of(const Golden& golden);

/// The manifest's text with a golden's `hash`, `was` and `picture` as they are now; all else stays
/// as it was written. A golden that it does not have is added at the end, with all its keys. Throws
/// UsageError for a manifest that cannot be changed line by line.
std::string with_golden(const std::string& text, const Golden& golden,
                        const std::filesystem::path& file);

inline constexpr std::size_t kMostHashesKept = 8;

}  // namespace softfocus
