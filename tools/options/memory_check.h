#pragma once
// A picture too large for the machine is refused before anything is drawn.

#include <cstdint>
#include <string_view>

#include "tools/cli/option_values.h"

namespace softfocus {

/// Throws UsageError, naming the option that gave the size, if the machine has less memory
/// than so many bytes a pixel. Where the system does not tell, allocation decides.
void check_memory(std::string_view option, PictureSize size, std::uint64_t bytes_per_pixel);

}  // namespace softfocus
