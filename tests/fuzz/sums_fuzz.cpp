// Any bytes as a shard's sums: sums, or a FileError.

#include <span>

#include "raster/numbers/hash.h"
#include "tests/fuzz/fuzz_input.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/pictures/sums_file.h"

int softfocus::fuzz_sums(const std::uint8_t* data, std::size_t size) {
  constexpr std::int64_t kMostPixels = 1 << 16;
  std::vector<std::byte> bytes;
  // The checksum at the end, which no change by chance would meet.
  const std::size_t summed = size - std::min(size, sizeof(std::uint64_t));
  Hash hash;
  for (const std::uint8_t byte : std::span{data, summed}) {
    add_to_hash(hash, byte);
    bytes.push_back(std::byte{byte});
  }
  append_little_endian(bytes, hash.value);
  try {
    const SumsFile file = open_sums_file(
        fuzz_file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), ".sum"));
    check_sums_file(file);
    demand(difference(file, file).empty());
    const int width = file.origin.picture.width, height = file.origin.picture.height;
    if (std::int64_t{width} * height > kMostPixels) return counted(true, data, size);
    SampleSums sums = make_sample_sums(width, height);
    Image depth = make_image(Format::rgba16f, width, height);
    add_sums_file(file, sums, depth);
  } catch (const FileError&) {
    return counted(false, data, size);
  }
  return counted(true, data, size);
}
