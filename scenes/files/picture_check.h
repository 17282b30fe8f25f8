#pragma once
// Damage in a PNG that stb_image (2.27) lets pass.

#include <string_view>

namespace softfocus {

/// Whether a chunk of a PNG, up to the one that ends it, claims more bytes than come behind it:
/// stb_image takes memory for what a chunk claims before it looks for it.
bool has_cut_png_chunk(std::string_view bytes);

// Damage in a JPEG that stb_image (2.27) lets pass.

/// Whether the bytes begin as a JPEG does and their end is missing: stb_image fills
/// what is not there with grey.
bool is_cut_jpeg(std::string_view bytes);

/// Whether a Huffman table of a JPEG claims more than its 256 codes: stb_image writes
/// them past the table's end.
bool has_overfull_huffman_table(std::string_view bytes);

/// Whether a scan of a JPEG names a Huffman table that does not come before it: stb_image decodes
/// by whatever its memory holds.
bool lacks_huffman_table(std::string_view bytes);

}  // namespace softfocus
