#pragma once
// Rendering the frames of a scene's animation.

#include <functional>

#include "scenes/scene.h"
#include "tools/render/options.h"

namespace softfocus {

/// Renders one picture.
using RenderFrame = std::function<void(const RenderOptions& options, FrameRun& run)>;

/// Renders the frames of --frames. Throws UsageError before any is begun; returns the exit status.
int render_frames(const RenderOptions& options, const CLI::App& parser, const Scene& scene,
                  const RenderFrame& render);

}  // namespace softfocus
