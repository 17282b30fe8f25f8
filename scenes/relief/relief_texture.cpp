#include "scenes/relief/relief_texture.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "raster/numbers/vector_math.h"

namespace softfocus {

double source_distance(const ReliefCamera& camera) {
  if (!camera.eye) return std::numeric_limits<double>::infinity();
  return dot(camera.origin - *camera.eye, camera.f);
}

glm::dvec3 point_at_depth(const ReliefCamera& camera, double u, double v, double depth_m) {
  const glm::dvec3 in_plane = (camera.origin + camera.a * u) + camera.b * v;
  if (!camera.eye) return in_plane + camera.f * depth_m;
  return *camera.eye + (in_plane - *camera.eye) * (1.0 / (1.0 - depth_m / source_distance(camera)));
}

glm::dvec3 relief_point(const ReliefTexture& relief, double u, double v, double code) {
  return point_at_depth(relief.camera, u, v, code * depth_step(relief));
}

std::optional<ReliefExtent> relief_extent(const ReliefTexture& relief) {
  const std::uint16_t empty = empty_depth(relief.depth_bits);
  ReliefExtent extent{relief.width, 0, relief.height, 0, empty, 0, 0};
  for (int y = 0; y < relief.height; ++y) {
    const std::uint16_t* codes =
        relief.depths.data() + static_cast<std::ptrdiff_t>(y) * relief.width;
    for (int x = 0; x < relief.width; ++x) {
      if (codes[x] == empty) continue;
      extent.x_begin = std::min(extent.x_begin, x);
      extent.x_end = std::max(extent.x_end, x + 1);
      extent.y_begin = std::min(extent.y_begin, y);
      extent.y_end = y + 1;
      extent.least_code = std::min<int>(extent.least_code, codes[x]);
      extent.most_code = std::max<int>(extent.most_code, codes[x]);
      ++extent.filled;
    }
  }
  if (extent.filled == 0) return std::nullopt;
  return extent;
}

namespace {

/// The mean of one to four colours, each channel to nearest, ties up.
std::uint32_t mean_colour(const std::array<std::uint32_t, 4>& colours, std::uint32_t count) {
  assert(count > 0);
  std::uint32_t mean = 0xFF000000u;
  for (int shift = 0; shift < 24; shift += 8) {
    std::uint32_t sum = count / 2;
    for (std::uint32_t i = 0; i < count; ++i) sum += colours[i] >> shift & 255u;
    mean |= sum / count << shift;
  }
  return mean;
}

}  // namespace

ReliefTexture coarser_relief(const ReliefTexture& relief) {
  assert(relief.width > 1 && relief.height > 1);
  ReliefTexture half;
  half.width = (relief.width + 1) / 2;
  half.height = (relief.height + 1) / 2;
  half.depth_bits = relief.depth_bits;
  half.camera = relief.camera;
  half.camera.origin = relief.camera.origin + (relief.camera.a + relief.camera.b) * 0.5;
  half.camera.a = relief.camera.a * 2.0;
  half.camera.b = relief.camera.b * 2.0;
  half.materials = relief.materials;
  const std::uint16_t empty = empty_depth(relief.depth_bits);
  const auto texels = static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height);
  half.depths.assign(texels, empty);
  half.colours.assign(texels, 0);
  half.normals.assign(relief.normals.empty() ? 0 : texels, 0);
  half.unlit.assign(relief.unlit.empty() ? 0 : texels, 0);
  const int same = static_cast<int>(kSameSurface * last_depth(relief.depth_bits));
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      std::array<std::size_t, 4> filled{};
      std::size_t count = 0, nearest = 0;
      for (int i = 0; i < 4; ++i) {
        const int u = 2 * x + (i & 1), v = 2 * y + (i >> 1);
        if (u >= relief.width || v >= relief.height) continue;
        const std::size_t at =
            static_cast<std::size_t>(v) * static_cast<std::size_t>(relief.width) +
            static_cast<std::size_t>(u);
        if (relief.depths[at] == empty) continue;
        if (count == 0 || relief.depths[at] < relief.depths[nearest]) nearest = at;
        filled[count++] = at;
      }
      if (count < 2) continue;
      std::array<std::uint32_t, 4> colours{}, unlit{};
      std::uint32_t alike = 0;
      for (std::size_t i = 0; i < count; ++i) {
        if (relief.depths[filled[i]] > relief.depths[nearest] + same) continue;
        colours[alike] = relief.colours[filled[i]];
        if (!relief.unlit.empty()) unlit[alike] = relief.unlit[filled[i]];
        ++alike;
      }
      const std::size_t to = static_cast<std::size_t>(y) * static_cast<std::size_t>(half.width) +
                             static_cast<std::size_t>(x);
      half.depths[to] = relief.depths[nearest];
      half.colours[to] = mean_colour(colours, alike);
      if (!relief.normals.empty()) half.normals[to] = relief.normals[nearest];
      if (!relief.unlit.empty()) half.unlit[to] = mean_colour(unlit, alike);
    }
  }
  return half;
}

}  // namespace softfocus
