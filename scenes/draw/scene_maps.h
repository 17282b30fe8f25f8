#pragma once
// The shadow maps of a scene's lights: drawn when they must be, and looked up.

#include <cstddef>
#include <span>

#include "scenes/draw/shadowed_layers.h"
#include "scenes/shadows/maps/map_lookup.h"

namespace softfocus {

/// The camera that maps are fitted to.
MapCamera map_camera(const Scene& scene, const CameraMatrices& camera);

/// Draws the maps of lights that have one, where they stand, except those that hold what they would
/// hold.
void draw_maps(SceneShadows& shadows, std::span<const Light> lights, const MapCamera& camera,
               const Profile& profile, ThreadPool& pool);

/// Sets bits of a layer's mask, and its shares. Needs draw_maps().
void look_up_maps(SceneShadows& shadows, std::size_t layer, const ShadowView& view, glm::dvec3 eye,
                  ThreadPool& pool);

}  // namespace softfocus
