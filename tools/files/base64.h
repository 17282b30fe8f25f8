#pragma once
// Bytes as text (RFC 4648, section 4), for pictures inside of a page.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

std::string base64(std::span<const std::byte> bytes);

/// The way back. Other letters, such as blanks, are passed over.
std::vector<std::byte> bytes_of_base64(std::string_view text);

}  // namespace softfocus
