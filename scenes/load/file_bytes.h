#pragma once
// A scene's files, read whole.

#include <cstddef>
#include <filesystem>
#include <string>

namespace softfocus {

/// The bytes of a file. Throws SceneError where there is none, it is a directory, it
/// cannot be read or it has more than `largest` bytes.
std::string read_file_bytes(const std::filesystem::path& file, std::size_t largest);

}  // namespace softfocus
