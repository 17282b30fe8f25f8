#pragma once
// What run_filter.cpp measures: every *_run.cpp has what is declared here, and one of them
// is linked.

#include <stddef.h>
#include <stdint.h>

#include "tools/boards/frame.h"

namespace softfocus::boards {

/// The only one that the filter takes.
extern const FrameFormat kFilterFormat;

/// Bytes that the filter wants of its caller, rows in and out not counted.
size_t filter_bytes(const FrameSettings& settings);

/// Takes the memory (aligned for any type) and makes the tables; nullptr if it refuses.
struct Filter;
Filter* begin_filter(const FrameSettings& settings, uint8_t* memory, size_t bytes);

/// Takes a row; whether one came out, into `out`.
bool put_row(Filter& filter, const void* colour, const void* depth, void* out);

/// After the last row: whether there is another to come out, into `out`.
bool next_row(Filter& filter, void* out);

}  // namespace softfocus::boards
