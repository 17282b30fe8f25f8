#pragma once
// Shared by the fuzz targets: the input as a file or as numbers, and claims that must hold.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

namespace softfocus {

/// Writes the bytes to this process's own file of that extension, which its end removes, and
/// returns its path.
inline std::filesystem::path fuzz_file(const std::uint8_t* data, std::size_t size,
                                       const char* extension) {
  static const struct Place {
    std::filesystem::path file;
    ~Place() { std::filesystem::remove(file); }
  } place{std::filesystem::temp_directory_path() /
          ("softfocus-fuzz-" + std::to_string(::getpid()) + extension)};
  std::ofstream stream(place.file, std::ios::binary | std::ios::trunc);
  stream.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return place.file;
}

/// The input, number by number; zeros when it has ended.
struct FuzzNumbers {
  const std::uint8_t* data;
  std::size_t size;

  template <class Number>
  Number next() {
    Number number{};
    const std::size_t some = std::min(size, sizeof number);
    if (some > 0) std::memcpy(&number, data, some);
    data += some;
    size -= some;
    return number;
  }
};

/// Ends the program, which is a finding, unless it holds.
inline void demand(bool holds) {
  if (!holds) std::abort();
}

}  // namespace softfocus
