#pragma once
// A large picture that is drawn, filtered and written a band of rows at a time.

#include <functional>
#include <string>
#include <vector>

#include "scenes/frame/frame.h"
#include "tools/render/options.h"
#include "tools/render/performance_report.h"

namespace softfocus {

/// Whether the options ask for a large picture whose file can be written so, and nothing else.
bool may_render_by_rows(const RenderOptions& options);

/// Makes the picture's file, its sidecar and the report, the bytes of the whole form. Needs a shot
/// without a reason to be whole (frame_rows.h). Adds to the record what make_frame() gives but the
/// picture, the hash, and the time of encoding, with that of writing. `on_stage` as FrameRows has
/// it. Throws FileError, UsageError.
void render_by_rows(const RenderOptions& options, const Shot& shot, RenderRecord& record,
                    std::vector<std::string>& warnings,
                    const std::function<void(FrameStage)>& on_stage, ThreadPool& pool);

}  // namespace softfocus
