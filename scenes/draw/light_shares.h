#pragma once
// Parts of a light's share: what shadow maps take away where the kernel is partly in shadow.

#include <cstdint>
#include <span>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/state.h"

namespace softfocus {

/// Whether a pixel of the area has a share. `shares` are of an image of that width.
bool has_shares(std::span<const std::uint8_t> shares, int width, const Rectangle& area);

/// Of each pixel of the area with a share of n of `whole`, in binary32 and in this order, a colour
/// at a time and not below 0: colour = colour + n / whole * (without - with). Alpha stays.
/// RGBA16F images of one size, one lit with the light and one without.
void take_shares(std::span<const std::uint8_t> shares, int whole, const Rectangle& area,
                 const Image& with, const Image& without, Image& colour, const Profile& profile);

}  // namespace softfocus
