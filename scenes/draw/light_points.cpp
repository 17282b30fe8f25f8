#include "scenes/draw/light_points.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/exact_math.h"
#include "raster/numbers/vector_math.h"
#include "scenes/lens_views/lens_points.h"

namespace softfocus {
namespace {

// Two directions across one of length 1, and across each other.
std::pair<glm::dvec3, glm::dvec3> directions_across(glm::dvec3 along) {
  const bool is_steep = std::fabs(along.y) > 0.9;
  const glm::dvec3 x =
      normalize(cross(is_steep ? glm::dvec3{1.0, 0.0, 0.0} : glm::dvec3{0.0, 1.0, 0.0}, along));
  return {x, cross(along, x)};
}

glm::vec3 direction_in_cap(glm::vec3 middle, double radius_degrees, glm::dvec2 of_disc) {
  const glm::dvec3 along = normalize(glm::dvec3{middle});
  const auto [x, y] = directions_across(along);
  const double height = 1.0 - exact_math::cos_degrees(radius_degrees);
  const double squared = of_disc.x * of_disc.x + of_disc.y * of_disc.y;
  const double across = std::sqrt(height * (2.0 - height * squared));
  return glm::vec3{along * (1.0 - height * squared) + x * (across * of_disc.x) +
                   y * (across * of_disc.y)};
}

glm::vec3 place_in_ball(glm::vec3 middle, double radius_m, glm::dvec2 of_disc, double turn) {
  const double squared = of_disc.x * of_disc.x + of_disc.y * of_disc.y;
  const double z = std::sqrt(std::max(1.0 - squared, 0.0)) * exact_math::sin_degrees(360.0 * turn);
  return glm::vec3{glm::dvec3{middle} + glm::dvec3{of_disc.x, of_disc.y, z} * radius_m};
}

}  // namespace

bool is_soft(const Light& light) {
  const double size =
      light.kind == LightKind::point ? light.radius_m : light.angular_radius_degrees;
  return light.shadows != ShadowKind::none && size > 0.0;
}

bool has_soft_shadows(const Scene& scene) {
  return std::any_of(scene.lights.begin(), scene.lights.end(), is_soft);
}

std::vector<Light> lights_at_point(std::span<const Light> lights, std::uint32_t index) {
  std::vector<Light> moved{lights.begin(), lights.end()};
  if (index == 0) return moved;
  constexpr std::uint32_t kLightSeries = 0;
  const glm::dvec2 of_disc = ApertureMap{ApertureShape{}}(square_point(index, kLightSeries));
  const double turn = shutter_point(index);
  for (Light& light : moved) {
    if (!is_soft(light)) continue;
    light.position_or_direction =
        light.kind == LightKind::point
            ? place_in_ball(light.position_or_direction, light.radius_m, of_disc, turn)
            : direction_in_cap(light.position_or_direction, light.angular_radius_degrees, of_disc);
  }
  return moved;
}

void add_layers(std::span<Image* const> layers, LayerSums& sums, ThreadPool& pool) {
  const int width = layers[0]->width, height = layers[0]->height;
  const std::size_t row_sums = 3 * static_cast<std::size_t>(width);
  sums.totals.resize(layers.size());
  for (std::vector<double>& totals : sums.totals) {
    totals.resize(row_sums * static_cast<std::size_t>(height));
  }
  pool.for_each(height, [&](int y) {
    for (std::size_t i = 0; i < layers.size(); ++i) {
      double* to = sums.totals[i].data() + row_sums * static_cast<std::size_t>(y);
      const std::uint16_t* halves = row<std::uint16_t>(*layers[i], y).data();
      for (int x = 0; x < width; ++x, halves += 4, to += 3) {
        for (int c = 0; c < 3; ++c) to[c] += static_cast<double>(half_to_float(halves[c]));
      }
    }
  });
  ++sums.count;
}

void store_means(const LayerSums& sums, std::span<Image* const> layers, const Profile& profile,
                 ThreadPool& pool) {
  const int width = layers[0]->width, height = layers[0]->height;
  const std::size_t row_sums = 3 * static_cast<std::size_t>(width);
  pool.for_each(height, [&](int y) {
    for (std::size_t i = 0; i < layers.size(); ++i) {
      const double* from = sums.totals[i].data() + row_sums * static_cast<std::size_t>(y);
      for (int x = 0; x < width; ++x, from += 3) {
        glm::vec4 mean = load_texel<Format::rgba16f>(*layers[i], x, y);
        for (int c = 0; c < 3; ++c) mean[c] = static_cast<float>(from[c] / sums.count);
        store_texel<Format::rgba16f>(*layers[i], x, y, mean, profile);
      }
    }
  });
}

namespace {

const std::uint8_t* row_of(std::span<const std::uint8_t> shares, int width, int y) {
  return shares.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
}

}  // namespace

bool has_shares(std::span<const std::uint8_t> shares, int width, const Rectangle& area) {
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const std::uint8_t* of_row = row_of(shares, width, y);
    if (std::any_of(of_row + area.x_begin, of_row + area.x_end,
                    [](std::uint8_t share) { return share != 0; })) {
      return true;
    }
  }
  return false;
}

void take_shares(std::span<const std::uint8_t> shares, int whole, const Rectangle& area,
                 const Image& with, const Image& without, Image& colour, const Profile& profile) {
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const std::uint8_t* of_row = row_of(shares, colour.width, y);
    for (int x = area.x_begin; x < area.x_end; ++x) {
      if (of_row[x] == 0) continue;
      const float part = static_cast<float>(of_row[x]) / static_cast<float>(whole);
      const glm::vec4 lit = load_texel<Format::rgba16f>(with, x, y);
      const glm::vec4 unlit = load_texel<Format::rgba16f>(without, x, y);
      glm::vec4 here = load_texel<Format::rgba16f>(colour, x, y);
      for (int i = 0; i < 3; ++i) {
        here[i] = std::max(here[i] + part * (unlit[i] - lit[i]), 0.0f);
      }
      store_texel<Format::rgba16f>(colour, x, y, here, profile);
    }
  }
}

MapCamera map_camera(const Scene& scene, const CameraMatrices& camera) {
  return {multiply(camera.eye_to_clip, camera.world_to_eye), camera.eye, scene.camera.near_m,
          scene.camera.far_m};
}

void draw_maps(SceneShadows& shadows, std::span<const Light> lights, const MapCamera& camera,
               const Profile& profile, ThreadPool& pool) {
  for (std::size_t i = 0; i < shadows.lights.size(); ++i) {
    const Light& light = lights[shadows.lights[i]];
    ShadowMap& map = shadows.maps[i];
    if (light.shadows != ShadowKind::map) continue;
    if (!map.sides.empty() && (!map.camera || *map.camera == camera)) continue;
    map = draw_shadow_map(shadows.facets, shadow_light(light), light.map, camera, profile, pool);
  }
}

void look_up_maps(SceneShadows& shadows, std::size_t layer, const ShadowView& view, glm::dvec3 eye,
                  ThreadPool& pool) {
  std::vector<MapLookup> lookups;
  shadows.shares.resize(shadows.seen.size());
  shadows.shares[layer].resize(shadows.maps.size());
  for (std::size_t i = 0; i < shadows.maps.size(); ++i) {
    const ShadowMap& map = shadows.maps[i];
    if (map.sides.empty()) continue;
    std::vector<std::uint8_t>& shares = shadows.shares[layer][i];
    shares.resize(map.settings.kernel > 1 ? shadows.seen[layer].size() : 0);
    lookups.push_back({&map, static_cast<int>(i), shares});
  }
  if (lookups.empty()) return;
  look_up_maps(shadows.facets, lookups, shadows.seen[layer], view, eye, shadows.masks[layer], pool);
}

}  // namespace softfocus
