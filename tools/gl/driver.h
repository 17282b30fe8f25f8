#pragma once
// The GL drivers that can be asked for by name, and how each is reached.

#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace softfocus {

/// What a driver refused or lacks, in one line.
struct DriverError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Driver {
  std::string_view name;
  std::string_view summary;
  /// The profile that it is compared with unless another is given, on this CPU; empty
  /// for a GPU, whose profile has to be probed first.
  std::string_view profile;
  /// Environment variables that Mesa reads when the first display is opened; one
  /// without a value is unset.
  std::vector<std::pair<const char*, const char*>> environment;
  /// What GL_RENDERER must begin with; empty for any hardware.
  std::string_view renderer;
  /// Draws so slowly that it gets small pictures only.
  bool slow = false;
};

/// llvmpipe, llvmpipe-sse41, softpipe, gpu.
std::span<const Driver> drivers();

/// The driver of that name, or nullptr.
const Driver* find_driver(std::string_view name);

}  // namespace softfocus
