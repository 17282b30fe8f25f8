#pragma once

#include <stdexcept>

namespace softfocus {

/// What came from outside and was wrong. The message is one line that names the file
/// (and the line in it) and says what would be right.
struct SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace softfocus
