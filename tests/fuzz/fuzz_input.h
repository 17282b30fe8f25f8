#pragma once
// What the fuzz targets share: a file that holds the input, and "any error but the one
// that is meant for the user is a finding".

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

namespace softfocus {

/// Writes the bytes to this process's own file of that extension and returns its path.
inline std::filesystem::path fuzz_file(const std::uint8_t* data, std::size_t size,
                                       const char* extension) {
  static const std::filesystem::path stem =
      std::filesystem::temp_directory_path() / ("softfocus-fuzz-" + std::to_string(::getpid()));
  std::filesystem::path file = stem;
  file += extension;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return file;
}

}  // namespace softfocus
