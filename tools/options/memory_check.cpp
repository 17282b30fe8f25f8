#include "tools/options/memory_check.h"

#include "tools/cli/errors.h"
#include "tools/cli/platform.h"

namespace softfocus {

void check_memory(std::string_view option, PictureSize size, std::uint64_t bytes_per_pixel) {
  const auto needed = bytes_per_pixel * static_cast<std::uint64_t>(size.width) *
                      static_cast<std::uint64_t>(size.height);
  const auto there = memory_bytes();
  if (!there || needed <= *there) return;
  constexpr double kGigabyte = 1e9;
  throw UsageError(
      std::string{option} + " " + size_text(size) + ": needs " +
      short_number(static_cast<double>(needed) / kGigabyte) + " GB of memory and there are " +
      short_number(static_cast<double>(*there) / kGigabyte) + " GB; give a smaller size");
}

}  // namespace softfocus
