#pragma once
// Refresh of a picture in n frames: the screen is divided into n groups, each a pseudo-random
// selection of quads of 2x2 pixels. A frame shades one group anew and takes the rest from the frame
// before (Akenine-Moller et al. 2018, section 12.2).

#include <cstdint>

#include "raster/images/image_view.h"
#include "raster/numbers/profile.h"
#include "raster/numbers/random_bits.h"
#include "raster/threads/parallel.h"

namespace softfocus {

inline constexpr int kMostGroups = 64;

/// Which of the groups a pixel is in.
constexpr int refresh_group(int x, int y, int groups) {
  return static_cast<int>(hash_of_place(x / 2, y / 2) % static_cast<std::uint32_t>(groups));
}

/// All of one size: `drawn`, the frame with its depth in alpha, of which only what is shown need be
/// there; `found`, what reverse_reproject() found, both RGBA16F. Writes pixels of `drawn` in the
/// group `turn`, 0 to groups - 1 or -1 for none, and where nothing was found; of `found` elsewhere,
/// with drawn's alpha. Into `frames`, R32F, 1 for what is drawn, and else found's alpha and 1.
/// Returns how many pixels are drawn.
std::int64_t refresh(int groups, int turn, const ConstImageView& drawn, const ConstImageView& found,
                     const ImageView& result, const ImageView& frames, const Profile& profile,
                     ThreadPool& pool);

}  // namespace softfocus
