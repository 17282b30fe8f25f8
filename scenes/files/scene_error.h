#pragma once

#include <stdexcept>
#include <string>

namespace softfocus {

/// The text with '?' for control characters: names in files may hold line ends and
/// terminal sequences.
inline std::string printable(std::string text) {
  for (char& letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (code < 0x20 || code == 0x7F) letter = '?';
  }
  return text;
}

/// A fault in a file. The message is one line that names the file, the line in it, and what
/// would be right.
struct SceneError : std::runtime_error {
  explicit SceneError(const std::string& message) : std::runtime_error(printable(message)) {}
};

}  // namespace softfocus
