#pragma once
// Textures from PNG and JPEG files.

#include <cstddef>
#include <filesystem>
#include <string>

#include "raster/images/sampler.h"

namespace softfocus {

/// The picture as Format::srgb8 with all its mipmaps (of the ieee profile), row 0 on
/// top; grey becomes RGB, 16 bits become 8, what has no alpha is opaque. Throws
/// SceneError for what is no PNG or JPEG, is damaged, or has more than kMaxImageSize
/// texels along a side or kMaxTextureTexels in all.
Texture load_texture(const std::filesystem::path& file);

/// The same of a file's bytes; `name` is for errors.
Texture texture_of_bytes(const std::string& bytes, const std::string& name);

/// Of a file.
inline constexpr std::size_t kMaxTextureBytes = std::size_t{1} << 28;

/// 8192 x 8192, a quarter of a gigabyte: a small file can claim any size.
inline constexpr int kMaxTextureTexels = 1 << 26;

}  // namespace softfocus
