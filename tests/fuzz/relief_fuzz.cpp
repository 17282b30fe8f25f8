// Any bytes as a relief texture: one that can be warped, or the error that is meant for the user.

#include <optional>
#include <string>

#include "raster/numbers/hash.h"
#include "scenes/relief/warp/resample.h"
#include "tests/fuzz/fuzz_input.h"
#include "tools/cli/errors.h"
#include "tools/relief/relief_file.h"

namespace {

using namespace softfocus;

/// Larger ones cost time and find nothing that these do not.
constexpr std::int64_t kMostReliefTexels = 1 << 14;

/// The sum over all, which no change by chance would meet.
std::string with_sum(const std::uint8_t* data, std::size_t size) {
  std::string bytes{reinterpret_cast<const char*>(data), size};
  constexpr std::size_t kSum = 8;
  if (size < kSum) return bytes;
  Hash hash;
  for (std::size_t i = 0; i < size - kSum; ++i) add_to_hash(hash, data[i]);
  for (std::size_t i = 0; i < kSum; ++i) {
    bytes[size - kSum + i] = static_cast<char>(hash.value >> (8 * i) & 255u);
  }
  return bytes;
}

/// Before its middle, as far as it is deep; a camera of huge numbers may have no such place.
void warp_it(const ReliefTexture& relief) {
  const std::optional<ReliefExtent> extent = relief_extent(relief);
  demand(extent.has_value() && extent->x_end <= relief.width && extent->y_end <= relief.height);
  const glm::dvec3 eye = relief_point(relief, 0.5 * relief.width, 0.5 * relief.height, 0.0) -
                         relief.camera.f * relief.camera.depth_m;
  const std::optional<PlaneRectangle> place = warped_extent(relief, *extent, eye);
  if (!place) return;
  static ThreadPool pool{1};
  WarpedRelief warped;
  warp_relief(relief, *extent, eye, *place, {}, warped, pool);
  demand(warped.colours.size() ==
         static_cast<std::size_t>(place->width) * static_cast<std::size_t>(place->height));
}

}  // namespace

int softfocus::fuzz_relief(const std::uint8_t* data, std::size_t size) {
  try {
    const ReliefTexture relief = decode_relief(with_sum(data, size), "fuzz");
    const auto texels =
        static_cast<std::size_t>(relief.width) * static_cast<std::size_t>(relief.height);
    demand(relief.depths.size() == texels && relief.colours.size() == texels);
    demand(relief.normals.empty() || relief.normals.size() == texels);
    demand(encode_relief(relief).size() == size);
    if (std::int64_t{relief.width} * relief.height <= kMostReliefTexels) warp_it(relief);
  } catch (const FileError&) {
    return counted(false, data, size);
  }
  return counted(true, data, size);
}
