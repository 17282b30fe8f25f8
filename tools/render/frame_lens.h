#pragma once
// The lens of a frame of `render`: as it is asked for, and as the drawn picture settles it.

#include <optional>

#include "raster/images/image.h"
#include "raster/threads/parallel.h"
#include "scenes/draw/frame_parts.h"
#include "tools/render/options.h"
#include "tools/render/performance_report.h"

namespace softfocus {

/// The lens as far as it is known before anything is drawn. Throws UsageError.
UsedLens chosen_lens(const RenderOptions& options, const SceneLens& of_scene, double fov_y_degrees);

/// Focuses on the drawn picture if that is asked for, and computes the frame's constants. Throws
/// UsageError.
void set_lens(UsedLens& used, const FrameParts& parts, const RenderOptions& options,
              double fov_y_degrees, ThreadPool& pool);

/// Halves a picture that was made at twice the size, and its lens's lengths in pixels.
Image halved(const Image& picture, const RenderOptions& options, double fov_y_degrees,
             std::optional<UsedLens>& used, ThreadPool& pool);

}  // namespace softfocus
