#pragma once

#include <stdexcept>

namespace softfocus {

/// A shader's text is at fault, in one line: "FILE:LINE: what, and what would be right".
struct ShaderError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace softfocus
