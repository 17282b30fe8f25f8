#pragma once
// hash_image() of an image that comes in bands of rows.

#include "raster/images/image_view.h"
#include "raster/numbers/hash.h"

namespace softfocus {

/// What the hash of an image of that size begins with.
Hash begin_image_hash(Format format, int width, int height);

/// Adds the next rows.
void add_rows_to_hash(Hash& hash, const ConstImageView& rows);

}  // namespace softfocus
