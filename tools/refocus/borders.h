#pragma once
// Pixels beyond the borders of a picture that is refocused.

#include "tools/pictures/picture_file.h"

namespace softfocus {

/// `by_method`: as each filter has it (docs/refocus.md). The others are pixels around the picture,
/// which the filter then sees: its edge again and again, its mirror image, or black, where nothing
/// is opaque. Depths of black ones are those of the edge.
enum class Border : std::uint8_t { by_method, clamp, mirror, black };

/// clamp, mirror, black; by-method.
std::string_view name_of(Border border);

/// The picture, RGBA16F with depth in alpha, with `margin` pixels more on each side.
Image with_border(const Image& picture, int margin, Border border);

/// Enlarges a plane of numbers; black ones are 0.
PlaneValues with_border(const PlaneValues& values, int width, int height, int margin,
                        Border border);

/// The way back: `width` and `height` are those with the border.
Image without_border(const Image& picture, int margin);
PlaneValues without_border(const PlaneValues& values, int width, int height, int margin);

}  // namespace softfocus
