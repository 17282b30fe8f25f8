#pragma once
// A picture as a browser's canvas takes it.

#include "tools/page/page.h"

namespace softfocus {

/// RGBA16F, linear light, as RGBA of 8 bits: sRGB as in PNG files, alpha 255. NaN is black.
void show_on_screen(const Image& picture, Pixels& pixels, ThreadPool& pool);

}  // namespace softfocus
