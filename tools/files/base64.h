#pragma once
// Bytes as text (RFC 4648, section 4), for pictures inside of a page.

#include <cstddef>
#include <span>
#include <string>

namespace softfocus {

std::string base64(std::span<const std::byte> bytes);

}  // namespace softfocus
