#pragma once
// How far the first views of a tile differ, as a viewer sees it: what decides how many more it
// needs.

#include <cstdint>
#include <span>
#include <vector>

namespace softfocus {

/// Steps of a colour on its way from 0 to 1: of its square root, which is near to how bright it
/// looks.
inline constexpr int kBrightnessSteps = 4095;

/// Of one of a tile's pixels and colours, the difference is that of the largest and the least of
/// the views' values, both taken as 0 to 1, in kBrightnessSteps. Returned is the sum of the
/// squares. Whole numbers: the same in any order. `views` are RGBA16F, `pixels` each.
std::uint64_t squared_difference(std::span<const std::uint16_t* const> views, int pixels);

}  // namespace softfocus
