#pragma once
// Where a pass's textures come from.

#include <string_view>

#include "dof/pipelines/pipeline.h"

namespace softfocus {

/// Gives the textures of a pass that have no input yet one, as finish_pipeline() says, and cuts
/// those into slices that the program reads as arrays, volumes or cubes.
void bind_textures(Pipeline& pipeline, PipelinePass& pass, const ShaderProgram& program,
                   std::string_view how_to_name);

}  // namespace softfocus
