// The fixed-point filter on RGBA16F with the depth in alpha, for run_filter.cpp.

#include "dof/fixed/softfocus_fixed.h"
#include "tools/boards/filter.h"

namespace softfocus::boards {

const FrameFormat kFilterFormat = FrameFormat::rgba16f;

namespace {

constexpr uint8_t kColour = SOFTFOCUS_FIXED_RGBA16F;
constexpr uint8_t kDepth = SOFTFOCUS_FIXED_DEPTH_IN_ALPHA;
constexpr size_t kCodes = 65536;
constexpr auto begin_stream = softfocus_fixed_begin_half;

int make_table(const softfocus_fixed_lens& lens, const FrameSettings&,
               softfocus_fixed_weights* table) {
  return softfocus_fixed_table_half(&lens, table);
}

}  // namespace
}  // namespace softfocus::boards

#include "tools/boards/fixed_run.inl"
