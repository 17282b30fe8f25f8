#pragma once
// The file that a shard leaves (scenes/lens_views/shard.h). All numbers are little-endian.
//
//   16 bytes  "softfocus sums\n", 0
//   uint32    the length of the header
//   header    JSON: softfocus_sums (1, the version of this form), shard (1 to shards), shards,
//             samples (of the whole picture), hashes of what the picture is made from, half_store
//             (HalfRounding), and `picture`, the notes of the whole picture
//   uint16    the depth, row by row from the top: alpha of the picture
//   binary64  the totals of red, green and blue, pixel by pixel
//   uint64    FNV-1a of all before

#include <cstdint>
#include <filesystem>
#include <string>

#include "raster/images/image.h"
#include "scenes/lens_views/shard.h"
#include "tools/pictures/picture_notes.h"

namespace softfocus {

/// Common to one picture's shards.
struct SumsOrigin {
  PictureNotes picture;  ///< the hash of its pixels is not known yet: 0
  int samples = 1;
  HalfRounding half_store = HalfRounding::nearest_even;
  std::uint64_t scene_files_hash = 0;  ///< of the bytes of all files of the scene
  std::uint64_t profile_hash = 0;      ///< of profile_text()
  std::uint64_t pinhole_hash = 0;      ///< hash_image() of the picture without depth of field
};

/// A file whose header was read.
struct SumsFile {
  std::filesystem::path path;
  Shard shard;
  SumsOrigin origin;
  std::string header;  ///< the JSON
};

/// Writes the file whole or not at all. The depth is in `pinhole`'s alpha. Throws FileError.
void write_sums_file(const std::filesystem::path& path, const Shard& shard,
                     const SumsOrigin& origin, const SampleSums& sums, const Image& pinhole);

/// Reads the header. Throws FileError for what is no such file, is of another version of the
/// program, or has not the length that the header tells.
SumsFile open_sums_file(const std::filesystem::path& path);

/// In what a file is of another picture than the first: "frame is 1, not 2". Empty: in nothing.
std::string difference(const SumsFile& file, const SumsFile& first);

/// Reads all and compares the checksum. Throws FileError.
void check_sums_file(const SumsFile& file);

/// Checks the file too, adds its totals and samples to the sums, and stores its depth as alpha of
/// an RGBA16F picture, both of the file's size. After an error they are of no use.
void add_sums_file(const SumsFile& file, SampleSums& sums, Image& depth);

}  // namespace softfocus
