#pragma once
// Vertices in batches of lanes.

#include <glm/vec4.hpp>
#include <span>

#include "raster/shaders/shader.h"
#include "raster/shaders/shader_batches.h"

namespace softfocus {

/// Runs the vertices begin <= v < end. `run.textures` and what follows it are not read: the batches
/// have them. Throws ShaderError if the budget is spent.
void run_vertices(const ShaderBatches& batches, const VertexRun& run, std::uint32_t begin,
                  std::uint32_t end, BatchMemory& memory);

}  // namespace softfocus
