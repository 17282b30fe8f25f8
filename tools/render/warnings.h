#pragma once
// Warnings of wishes that a render did not meet, a line each; "" for none.

#include <string>

#include "scenes/draw/frame_parts.h"
#include "scenes/scene.h"
#include "tools/render/options.h"
#include "tools/render/performance_report.h"

namespace softfocus {

/// --until's error was not reached.
std::string until_warning(const RenderRecord& record);

/// auto predicts or measures that it misses its goal.
std::string goal_warning(const RenderOptions& options, const RenderRecord& record);

/// How the picture of a scene with transparent surfaces falls short.
std::string transparent_warning(const Scene& scene, const FrameParts& parts,
                                const RenderOptions& options);

}  // namespace softfocus
