// Filters the file "frame" into the file "filtered", row by row as a board would, and
// reports instructions and memory. Reading and writing is not counted.

#include "tools/boards/filter.h"
#include "tools/boards/machine.h"

namespace softfocus::boards {
namespace {

constexpr uint32_t kKnownRounds = 1000000;

/// Cuts the free memory up, aligned for any type.
struct Buffers {
  FreeMemory left;

  uint8_t* take(size_t bytes) {
    const size_t aligned = (bytes + 7) & ~size_t{7};
    if (aligned > left.bytes) give_up("The buffers do not fit into memory");
    uint8_t* const taken = left.begin;
    left.begin += aligned;
    left.bytes -= aligned;
    return taken;
  }
};

struct Tally {
  uint64_t instructions = 0;
  uint64_t started = 0;

  void start() { started = instructions_executed(); }
  void stop() { instructions += instructions_executed() - started; }
};

/// The clock's count of a loop of 2 kKnownRounds instructions more than another.
uint64_t count_known_loop() {
  const uint64_t start = instructions_executed();
  loop_of_known_length(kKnownRounds);
  const uint64_t between = instructions_executed();
  loop_of_known_length(2 * kKnownRounds);
  return instructions_executed() - between - (between - start);
}

void filter_frame() {
  const int in = open_to_read("frame");
  FrameSettings settings;
  if (in < 0 || !read_bytes(in, &settings, sizeof settings)) give_up("No file \"frame\"");
  if (settings.format != kFilterFormat) give_up("The frame has another format");
  const int out = open_to_write("filtered");
  if (out < 0) give_up("The file \"filtered\" cannot be written");

  start_clock();
  report("known_loop_instructions", 2 * kKnownRounds);
  report("known_loop_counted", count_known_loop());
  report("instructions_per_tick", instructions_per_tick());

  Buffers buffers{free_memory()};
  const size_t row_bytes = settings.width * colour_bytes(settings.format);
  const size_t row_depth_bytes = settings.width * depth_bytes(settings.format);
  uint8_t* const colour = buffers.take(row_bytes);
  uint8_t* const filtered = buffers.take(row_bytes);
  uint8_t* const depth = buffers.take(row_depth_bytes);
  const size_t bytes = filter_bytes(settings);
  uint8_t* const memory = buffers.take(bytes);

  paint_stack();
  Tally beginning;
  beginning.start();
  Filter* const filter = begin_filter(settings, memory, bytes);
  beginning.stop();
  if (filter == nullptr) give_up("The filter refuses these settings");
  Tally rows;
  uint32_t rows_out = 0;
  bool written = true;
  for (uint32_t y = 0; y < settings.height; ++y) {
    if (!read_bytes(in, colour, row_bytes) || !read_bytes(in, depth, row_depth_bytes)) {
      give_up("The file \"frame\" is too short");
    }
    rows.start();
    const bool came_out = put_row(*filter, colour, depth, filtered);
    rows.stop();
    if (!came_out) continue;
    written = written && write_bytes(out, filtered, row_bytes);
    ++rows_out;
  }
  for (;;) {
    rows.start();
    const bool came_out = next_row(*filter, filtered);
    rows.stop();
    if (!came_out) break;
    written = written && write_bytes(out, filtered, row_bytes);
    ++rows_out;
  }
  if (!written || rows_out != settings.height) give_up("Rows are missing");
  report("begin_instructions", beginning.instructions);
  report("row_instructions", rows.instructions);
  report("filter_bytes", bytes);
  report("row_buffer_bytes", 2 * row_bytes + row_depth_bytes);
  report("static_bytes", static_bytes());
  report("stack_bytes", deepest_stack_bytes());
}

}  // namespace
}  // namespace softfocus::boards

void run_filter() { softfocus::boards::filter_frame(); }
