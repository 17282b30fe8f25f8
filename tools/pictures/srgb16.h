#pragma once
// The sRGB curve in 16 bits, as PNG has it (IEC 61966-2-1), and from halves.

#include <cstdint>
#include <vector>

namespace softfocus {

/// Linear light; 0 to 65535 stand for 0 to 1.
float srgb16_to_linear(std::uint16_t encoded);

/// For every half's bits the number that encodes it, 0 to 65535: values outside of 0 to 1 are cut,
/// NaN is 0.
std::vector<std::uint16_t> srgb16_of_halves();

}  // namespace softfocus
