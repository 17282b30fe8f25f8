#pragma once
// Scenes without end: a class of scene, its objects, materials, textures, lights, camera, lens
// and focus, all drawn from a number. Nobody tunes to them, so that a claim over many of them
// holds for more than a few chosen pictures.

#include <cstdint>
#include <span>
#include <string_view>

#include "raster/threads/parallel.h"
#include "scenes/scene.h"

namespace softfocus {

/// The classes, in the order in which they are drawn. "mixed" takes its parts from all others.
std::span<const std::string_view> random_scene_classes();

/// Something is in focus, something is not, and nothing reaches the camera. The largest circle
/// of confusion is about 4 to 90 pixels of 1024 rows, and max_coc_px does not cut it. Named
/// "random:SEED"; the title names the class. The same bits on every machine. `pool`, if any, makes
/// the textures.
Scene make_random_scene(std::uint64_t seed, ThreadPool* pool = nullptr);

}  // namespace softfocus
