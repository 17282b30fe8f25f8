#pragma once
// The two-pass filter for pictures that arrive row by row, from a camera or a decoder:
// the same bits as two_pass(), in memory that does not grow with the picture's height.
//
// Of a filter that reaches R = tap_count(max_coc) rows, row y can come out when row y + R
// is in. Rows are filtered along x as many at a time as a vector has lanes, so they come
// out in groups, and up to lanes - 1 rows later than that.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "dof/two_pass/two_pass_strip.h"
#include "raster/threads/parallel.h"

namespace softfocus {

struct TwoPassStream {
  int width;
  int reach;
  StripFilter filter;
  std::vector<Strip> strips;

  std::size_t row_halves;               ///< from row to row, of both:
  std::vector<std::uint16_t> waiting;   ///< rows that came in, a group
  std::vector<std::uint16_t> finished;  ///< rows to go out
  int rows_waiting = 0;
  int rows_below = 0;  ///< rows past the last one that have been made up
};

/// What is done with a row that comes out: `width` pixels of RGBA16F.
using RowSink = std::function<void(std::span<const std::uint16_t> row)>;

/// A stream of pictures `width` pixels wide, from 1 to kMaxImageSize. Any `isa` that this
/// CPU has; `scalar` runs as `baseline`.
TwoPassStream begin_two_pass_stream(int width, const DofSettings& settings, const Profile& profile,
                                    Isa isa);

/// Bytes of memory that such a stream has, whatever the height.
std::size_t two_pass_stream_bytes(int width, const DofSettings& settings, Isa isa);

/// Takes the next row, `width` pixels of RGBA16F. Rows that are finished then come out.
void put_row(TwoPassStream& stream, std::span<const std::uint16_t> row, ThreadPool& pool,
             const RowSink& sink);

/// No more rows come: those that are still inside come out. The stream is then ready for
/// another picture.
void end_rows(TwoPassStream& stream, ThreadPool& pool, const RowSink& sink);

}  // namespace softfocus
