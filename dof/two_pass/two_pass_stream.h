#pragma once
// The two-pass filter for pictures that arrive row by row, from a camera or a decoder: the
// bits of two_pass(), in memory that does not grow with the picture's height.
//
//   TwoPassStream stream(width, settings, Profile{}, pool.isa());
//   const RowSink show = [&](std::span<const std::uint16_t> row) { ... };
//   while (read(row)) put_row(stream, row, pool, show);
//   end_rows(stream, pool, show);
//
// The filter reaches R = tap_count(max_coc) rows: row y can come out when row y + R is in.
// Rows are filtered in groups of a vector's lanes, so a row comes out up to lanes - 1 rows
// later than that.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "dof/dof.h"

namespace softfocus {

/// A picture on its way. Its memory is allocated once, when it is made.
class TwoPassStream {
 public:
  /// For pictures `width` pixels wide, 1 to kMaxImageSize, of any height. Any `isa` that this
  /// CPU has; `scalar` runs as `baseline`.
  TwoPassStream(int width, const DofSettings& settings, const Profile& profile, Isa isa);
  ~TwoPassStream();
  TwoPassStream(TwoPassStream&& other) noexcept;
  TwoPassStream& operator=(TwoPassStream&& other) noexcept;

  struct State;
  std::unique_ptr<State> state;
};

/// Bytes of memory that the stream has.
std::size_t stream_bytes(const TwoPassStream& stream);

/// Bytes of memory that such a stream will have.
std::size_t two_pass_stream_bytes(int width, const DofSettings& settings, Isa isa);

/// Called with each row that comes out, from the top down: `width` pixels of RGBA16F (linear
/// colour; depth in metres in alpha). The row's memory is the stream's, until the call returns.
using RowSink = std::function<void(std::span<const std::uint16_t> row)>;

/// Puts the next row in, `width` pixels of RGBA16F; it is copied. Rows that are finished come
/// out before it returns. Work is shared out over `pool`, of any vector unit.
void put_row(TwoPassStream& stream, std::span<const std::uint16_t> row, ThreadPool& pool,
             const RowSink& sink);

/// Ends the picture: the rows that are still inside come out. The stream is then ready for the
/// next picture.
void end_rows(TwoPassStream& stream, ThreadPool& pool, const RowSink& sink);

}  // namespace softfocus
