#include "scenes/draw/scene_maps.h"

#include <vector>

namespace softfocus {

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
