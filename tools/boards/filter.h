#pragma once
// A filter for run_filter.cpp to measure: every *_run.cpp defines these functions, and one of them
// is linked.

#include <stddef.h>
#include <stdint.h>

#include "tools/boards/frame.h"

namespace softfocus::boards {

/// The only format that the filter takes.
extern const FrameFormat kFilterFormat;

/// Bytes of memory that the filter needs, without the rows that come in and go out.
size_t filter_bytes(const FrameSettings& settings);

/// Makes the tables in `memory`, which is aligned for any type; nullptr if the settings are
/// refused.
struct Filter;
Filter* begin_filter(const FrameSettings& settings, uint8_t* memory, size_t bytes);

/// Takes a row. Returns whether a row was written to `out`.
bool put_row(Filter& filter, const void* colour, const void* depth, void* out);

/// To be called after the last row, until it returns false: as put_row().
bool next_row(Filter& filter, void* out);

}  // namespace softfocus::boards
