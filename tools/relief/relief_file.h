#pragma once
// A relief texture's file, all numbers least significant byte first:
//
//   8 bytes   "SFRELIEF"
//   5 x u32   version, 1 or 2; width; height; bits of depth, 8 or 16; 1 if there are normals, else
//   0 13 x f64  the camera: C, a, b, f (x, y, z each), and the metres of the last depth 3 x f64
//   version 2 alone: the eye of a perspective camera depths    width x height codes of one or two
//   bytes colours   width x height x 3 bytes: red, green, blue in the sRGB curve; 0 where nothing
//   is normals   the same: x, y, z, each 127 n + 128; if there are any u64       FNV-1a of all
//   bytes before

#include <filesystem>
#include <string_view>
#include <vector>

#include "scenes/relief/relief_texture.h"

namespace softfocus {

std::vector<std::byte> encode_relief(const ReliefTexture& relief);

/// The way back. Throws FileError, which names `file`, for what is not such a file, is cut short or
/// too long, was changed, has a camera whose axes are not at right angles or whose eye is not
/// before its plane, or shows nothing.
ReliefTexture decode_relief(std::string_view bytes, const std::filesystem::path& file);

ReliefTexture read_relief_file(const std::filesystem::path& file);

}  // namespace softfocus
