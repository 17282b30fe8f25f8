#pragma once
// A scene's files, read whole, and memory for decoding them.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace softfocus {

/// The bytes of a file. Throws SceneError where there is none, it is a directory, it
/// cannot be read or it has more than `largest` bytes.
std::string read_file_bytes(const std::filesystem::path& file, std::size_t largest);

/// Throws SceneError for a pipe or a device, whose end may never come.
void check_no_pipe(const std::filesystem::path& file);

/// A file of text as UTF-8: without a byte order mark, and from UTF-16 of either byte order if its
/// mark says so. Throws as read_file_bytes() and check_no_pipe().
std::string read_file_text(const std::filesystem::path& file, std::size_t largest);

/// Whether a path ends so, in letters of either case: ".obj". ASCII only, and no locale's.
bool has_extension(std::string_view path, std::string_view extension);

/// Zeros, for std::free(), or null: what a decoder fills, so that what a damaged file leaves unset
/// is the same each time.
void* zeroed_memory(std::size_t size);

}  // namespace softfocus
