#pragma once
// Damage in a PNG that stb_image (2.27) lets pass.

#include <string_view>

namespace softfocus {

/// Whether a chunk of a PNG, up to the one that ends it, claims more bytes than come behind it:
/// stb_image takes memory for what a chunk claims before it looks for it.
bool has_cut_png_chunk(std::string_view bytes);

}  // namespace softfocus
