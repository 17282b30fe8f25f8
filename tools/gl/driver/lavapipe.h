#pragma once
// lavapipe, Mesa's Vulkan driver for the CPU: where it is on this machine.

#include <string>

namespace softfocus {

/// The files (lvp_icd.json, lvp_icd.x86_64.json ...) by which Vulkan's loader finds lavapipe, for
/// VK_ICD_FILENAMES: those that the user's VK_DRIVER_FILES or VK_ICD_FILENAMES name, else those in
/// the loader's standard folders. Throws DriverError if there is none.
std::string lavapipe_files();

}  // namespace softfocus
