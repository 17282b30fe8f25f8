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

/// What came from outside and was wrong. The message is one line that names the file
/// (and the line in it) and says what would be right.
struct SceneError : std::runtime_error {
  explicit SceneError(const std::string& message) : std::runtime_error(printable(message)) {}
};

}  // namespace softfocus
