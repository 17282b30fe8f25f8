#pragma once
// The alpha of a picture that is refocused. Colour is filtered multiplied by it, and alpha as the
// colour of a second picture with the same depth: so each method treats both alike, and what was
// one straight colour stays it.

#include "tools/refocus/picture_with_depth.h"

namespace softfocus {

/// The alpha of the colour of `sources`, 0 to 1 a pixel, by which `colour` is multiplied here
/// unless the file's is (EXR). Empty if there is none, or if it is no alpha: numbers beyond 0 and
/// 1 of other files than EXR, and a fourth channel of NumPy files of ours, are depths.
PlaneValues take_opacity(const PictureSources& sources, Image& colour);

/// Whether an alpha is one whatever its numbers are. Renderers' filters leave an EXR's a little
/// below 0 and above 1.
bool is_sure_of_alpha(const PictureFile& file);

/// Whether the alpha of `sources` may be one by what its file is, and need but be within 0 and 1.
bool may_be_opacity(const PictureSources& sources);

/// The numbers of the file's alpha, of that full scale, as opacity, cut to 0 and 1 (NaN is 0), by
/// which `colour` is multiplied unless the file's is.
void take_opacity(const PictureFile& file, float whole, PlaneValues& alpha, Image& colour);

/// Whether any pixel is not opaque.
bool is_transparent(const PlaneValues& opacity);

/// A picture whose red, green and blue are the opacity, with the depths of `like`.
Image opacity_picture(const PlaneValues& opacity, const Image& like);

/// The way back, cut to 0 and 1.
PlaneValues opacity_of(const Image& picture);

}  // namespace softfocus
