#include "scenes/relief/warp/march_relief.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
namespace {

/// A ray in the relief: u and v are straight lines over the depth.
struct ReliefRay {
  float u, v, along_u, along_v;
};

struct MarchedTexel {
  std::size_t at;
  float depth_m;
};

/// The texel at a depth of the ray; none outside and where nothing is.
bool texel_on_ray(const ReliefTexture& relief, float step_m, const ReliefRay& ray, float depth_m,
                  MarchedTexel& texel) {
  const float u = ray.u + depth_m * ray.along_u + 0.5f, v = ray.v + depth_m * ray.along_v + 0.5f;
  if (!(u >= 0.0f && v >= 0.0f && u < static_cast<float>(relief.width) &&
        v < static_cast<float>(relief.height))) {
    return false;
  }
  texel.at = static_cast<std::size_t>(v) * static_cast<std::size_t>(relief.width) +
             static_cast<std::size_t>(u);
  if (relief.colours[texel.at] == 0) return false;
  texel.depth_m = static_cast<float>(relief.depths[texel.at]) * step_m;
  return true;
}

/// The first slice that holds the surface, and then by halves where the ray comes behind it.
bool meets_surface(const ReliefTexture& relief, const PreWarp& warp, const MarchSettings& settings,
                   const ReliefRay& ray, MarchedTexel& found) {
  const auto most_m = static_cast<float>(last_depth(relief.depth_bits)) * warp.step_m;
  const float slice_m = most_m / static_cast<float>(settings.slices);
  // Past a texel's surface, but not beside it: the ray was before a surface one slice ago, or this
  // slice holds the surface.
  bool was_before = texel_on_ray(relief, warp.step_m, ray, 0.0f, found);
  for (int slice = 1; slice <= settings.slices; ++slice) {
    float behind = static_cast<float>(slice) * slice_m;
    float before = behind - slice_m;
    const bool is_there = texel_on_ray(relief, warp.step_m, ray, behind, found);
    const bool is_behind = is_there && found.depth_m <= behind;
    if (!is_behind || !(was_before || found.depth_m >= before)) {
      if (is_behind && !settings.passes_behind) return false;
      was_before = is_there && !is_behind;
      continue;
    }
    for (int i = 0; i < settings.bisections; ++i) {
      const float middle = 0.5f * (before + behind);
      MarchedTexel texel{};
      if (texel_on_ray(relief, warp.step_m, ray, middle, texel) && texel.depth_m <= middle) {
        behind = middle;
        found = texel;
      } else {
        before = middle;
      }
    }
    return true;
  }
  return false;
}

}  // namespace

MarchMapping march_mapping(const ReliefTexture& relief, const ReliefExtent& extent,
                           const CameraMatrices& camera, int width, int height) {
  MarchMapping march{};
  const std::optional<PlaneRectangle> seen = warped_extent(relief, extent, camera.eye);
  if (!seen) return march;
  march.warp = pre_warp(relief, camera.eye);
  march.mapping = plane_mapping(relief, camera, {0, 0, relief.width, relief.height}, width, height);
  march.mapping.area = plane_mapping(relief, camera, *seen, width, height).area;
  return march;
}

void march_relief(const ReliefTexture& relief, const MarchMapping& march,
                  const MarchSettings& settings, Image& picture, ThreadPool& pool) {
  const PlaneMapping& mapping = march.mapping;
  const PreWarp& warp = march.warp;
  std::array<float, 256> linear{};
  for (std::size_t code = 0; code < linear.size(); ++code) {
    linear[code] = srgb8_to_linear(static_cast<std::uint8_t>(code));
  }
  pool.for_each(mapping.area.y_end - mapping.area.y_begin, [&](int line) {
    const int y = mapping.area.y_begin + line;
    const auto planar = [&](const PlaneMapping::Planar& of, int x) {
      return static_cast<float>(of.at(0.0, y)) +
             static_cast<float>(x) * static_cast<float>(of.step_x);
    };
    for (int x = mapping.area.x_begin; x < mapping.area.x_end; ++x) {
      const float q = planar(mapping.q, x);
      if (!(q > 0.0f)) continue;
      const float u = planar(mapping.u, x) / q, v = planar(mapping.v, x) / q;
      MarchedTexel texel{};
      if (!meets_surface(relief, warp, settings,
                         {u, v, u * warp.k3 - warp.k1, v * warp.k3 - warp.k2}, texel)) {
        continue;
      }
      const std::uint32_t colour = relief.colours[texel.at];
      if (colour == kStopsRays) continue;
      const float far = static_cast<float>(mapping.height_m) / q *
                        (1.0f + warp.k3 * texel.depth_m) /
                        (1.0f - mapping.source_per_m * texel.depth_m);
      const float cut = far < 65504.0f ? far : 65504.0f;
      if (!(cut + mapping.behind_m < load_texel<Format::rgba16f>(picture, x, y).w)) continue;
      store_texel<Format::rgba16f>(
          picture, x, y,
          {linear[colour & 255u], linear[colour >> 8 & 255u], linear[colour >> 16 & 255u], cut},
          Profile{});
    }
  });
}

}  // namespace softfocus
