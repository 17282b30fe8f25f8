#pragma once
// The files of a report, in the directory that -o names. Each is whole or absent.

#include <filesystem>
#include <optional>
#include <string_view>

#include "tools/files/json.h"

namespace softfocus {

/// Makes a directory and those above it. Throws FileError.
void make_directory(const std::filesystem::path& directory);

/// Throws FileError.
void write_text(const std::filesystem::path& file, std::string_view text);
void write_json(const std::filesystem::path& file, const Json& json);

/// What a file holds, if it is there and is JSON.
std::optional<Json> read_json(const std::filesystem::path& file);

}  // namespace softfocus
