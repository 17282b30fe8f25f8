#pragma once
// What a render did not do as it was asked to, a line each; "" where there is nothing to say.

#include <string>

#include "scenes/draw/frame_parts.h"
#include "scenes/scene.h"
#include "tools/render/options.h"
#include "tools/render/performance_report.h"

namespace softfocus {

/// What --until asked for and the samples did not give.
std::string until_warning(const RenderRecord& record);

/// What auto was to keep to and predicts that it will not.
std::string goal_warning(const RenderOptions& options, const RenderRecord& record);

/// How the picture of a scene with transparent surfaces falls short.
std::string transparent_warning(const Scene& scene, const FrameParts& parts,
                                const RenderOptions& options);

}  // namespace softfocus
