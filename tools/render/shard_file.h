#pragma once
// render --shard: the sums of a part of a picture's samples, which `softfocus join` joins.

#include "scenes/lens_views/shard.h"
#include "tools/render/options.h"
#include "tools/render/performance_report.h"

namespace softfocus {

/// Throws UsageError if what was asked for cannot be shared out, or needs the whole picture.
void check_shard_options(const RenderOptions& options, const CLI::App& parser);

/// Throws UsageError for more shards than groups of samples.
void check_shard_count(const Shard& shard, int samples);

/// Writes a shard's sums. `record` is of the whole picture but for its pixels.
void write_shard(const Scene& scene, const RenderOptions& options, const RenderRecord& record);

}  // namespace softfocus
