// The fixed-point filter on RGB565 with 8-bit depth, for run_filter.cpp.

#include "dof/fixed/softfocus_fixed.h"
#include "tools/boards/filter.h"

namespace softfocus::boards {

const FrameFormat kFilterFormat = FrameFormat::rgb565;

namespace {

constexpr uint8_t kColour = SOFTFOCUS_FIXED_RGB565;
constexpr uint8_t kDepth = SOFTFOCUS_FIXED_DEPTH8;
constexpr size_t kCodes = 256;
constexpr auto begin_stream = softfocus_fixed_begin;

int make_table(const softfocus_fixed_lens& lens, const FrameSettings& settings,
               softfocus_fixed_weights* table) {
  return softfocus_fixed_table8(&lens, settings.near_um, settings.far_um, table);
}

}  // namespace
}  // namespace softfocus::boards

#include "tools/boards/fixed_run.inl"
