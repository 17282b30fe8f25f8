#pragma once
// A relief texture's file, all numbers least significant byte first:
//
//   8 bytes   "SFRELIEF"
//   5 x u32   version, 1, or 2 of a perspective camera; width; height; bits of depth, 8 or 16; 2
//             if the relief is unlit, else 1 if there are normals, else 0
//   13 x f64  the camera: C, a, b, f (x, y, z each), and the metres of the last depth
//   3 x f64   of version 2: the eye
//   depths    width x height codes of one or two bytes
//   colours   width x height x 3 bytes: red, green, blue in the sRGB curve; 0 where nothing is
//   normals   if there are any: width x height x 3 bytes: x, y, z, each 127 n + 128
//   if the relief is unlit
//     unlit     as the colours
//     numbers   width x height x 1 byte: each texel's material
//     u32       number of materials, 1 to 256; for each
//       6 x f32   its share of ambient light and its highlight, red, green and blue each
//       2 x u32   shininess, 1 to 1024; 1 if it is lit, else 0
//   u64       FNV-1a of all bytes before

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/relief/relief_texture.h"

namespace softfocus {

/// Throws UsageError, which names `of`, if a relief's texels, depth or place are so small or so
/// large that decode_relief() would refuse them.
void check_relief_size(const ReliefTexture& relief, const std::string& of);

std::vector<std::byte> encode_relief(const ReliefTexture& relief);

/// The inverse. Throws FileError, which names `file`, if the bytes are no such file, are cut short
/// or too long, or were changed, if the camera's axes are not at right angles or its eye is not
/// before its plane, or if the relief shows nothing.
ReliefTexture decode_relief(std::string_view bytes, const std::filesystem::path& file);

ReliefTexture read_relief_file(const std::filesystem::path& file);

}  // namespace softfocus
