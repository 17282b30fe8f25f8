#pragma once
// The GL drivers that can be asked for by name.

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "raster/shaders/shader_error.h"

namespace softfocus {

/// A driver refuses or lacks something; in one line.
struct DriverError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Driver {
  std::string_view name;
  std::string_view summary;
  /// The profile that it is compared with unless another is given, on this CPU; empty
  /// for a GPU, whose profile has to be probed first.
  std::string_view profile;
  /// For Mesa's software drivers: the driver's name, and the CPU features that it may use
  /// (empty: all). GL_RENDERER begins with the driver's name.
  std::string_view gallium_driver;
  std::string_view cpu_caps;
  /// Draws so slowly that it gets small pictures only.
  bool slow = false;
  /// The gallium driver draws by Vulkan, and Vulkan by lavapipe.
  bool on_lavapipe = false;
  /// The emulated GPU itself, by any profile.
  bool is_emulated = false;
  bool has_samples = true;  ///< draws into textures of several samples a pixel
};

inline bool is_software(const Driver& driver) { return !driver.gallium_driver.empty(); }

/// Returns work(), and puts the driver's name in front of its DriverError or ShaderError.
template <class Work>
auto naming(const Driver& driver, const Work& work) {
  const std::string name = "driver " + std::string(driver.name) + ": ";
  try {
    return work();
  } catch (const DriverError& error) {
    throw DriverError(name + error.what());
  } catch (const ShaderError& error) {
    throw ShaderError(name + error.what());
  }
}

/// llvmpipe, llvmpipe-sse41, softpipe, lavapipe, emulated, gpu.
std::span<const Driver> drivers();

/// The driver of that name, or nullptr.
const Driver* find_driver(std::string_view name);

}  // namespace softfocus
