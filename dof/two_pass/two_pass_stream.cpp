#include "dof/two_pass/two_pass_stream.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "dof/weights.h"

namespace softfocus {
namespace {

// Columns of a strip: its lines stay in a core's cache while a group of rows is filtered.
constexpr int kStripColumns = 128;

// Nodes that a strip has room for besides those in reach: the more, the less often they
// are moved.
int slack(int reach) { return std::max(reach, kMostLanes); }

StripShape strip_shape(int width, int reach, int x_begin) {
  return {width, x_begin, std::min(kStripColumns, width - x_begin), reach};
}

int group_rows(const TwoPassStream& stream) { return lanes_of(stream.filter.isa); }

void begin_picture(TwoPassStream& stream) {
  for (Strip& strip : stream.strips) begin_rows(strip, stream.filter, Outside::repeats, 0);
  stream.rows_waiting = 0;
  stream.rows_below = 0;
}

void write_finished(TwoPassStream& stream, ThreadPool& pool, const RowSink& sink) {
  const int count = std::min(rows_done(stream.strips.front()), group_rows(stream));
  if (count <= 0) return;
  pool.for_each(static_cast<int>(stream.strips.size()), [&](int i) {
    write_rows(stream.strips[static_cast<std::size_t>(i)], stream.filter, count,
               stream.finished.data(),
               static_cast<std::ptrdiff_t>(stream.row_halves * sizeof(std::uint16_t)));
  });
  for (int i = 0; i < count; ++i) {
    sink(std::span{stream.finished}.subspan(static_cast<std::size_t>(i) * stream.row_halves,
                                            static_cast<std::size_t>(stream.width) * 4));
  }
}

void filter_waiting(TwoPassStream& stream, ThreadPool& pool, const RowSink& sink) {
  std::array<const std::uint16_t*, 2 * kMostLanes> rows{};
  for (int i = 0; i < 2 * kMostLanes; ++i) {
    const int row = std::min(i, stream.rows_waiting - 1);
    rows[static_cast<std::size_t>(i)] =
        stream.waiting.data() + static_cast<std::size_t>(row) * stream.row_halves;
  }
  pool.for_each(static_cast<int>(stream.strips.size()), [&](int i) {
    Strip& strip = stream.strips[static_cast<std::size_t>(i)];
    room(strip, stream.filter);
    add_rows(strip, stream.filter, rows.data(), stream.rows_waiting);
  });
  stream.rows_waiting = 0;
  write_finished(stream, pool, sink);
}

}  // namespace

TwoPassStream begin_two_pass_stream(int width, const DofSettings& settings, const Profile& profile,
                                    Isa isa) {
  assert(width >= 1 && width <= kMaxImageSize);
  TwoPassStream stream{
      width, tap_count(settings.max_coc_px),      {settings, profile.half_store, isa},
      {},    static_cast<std::size_t>(width) * 4, {},
      {}};
  for (int x = 0; x < width; x += kStripColumns) {
    begin_strip(stream.strips.emplace_back(), stream.filter, strip_shape(width, stream.reach, x),
                slack(stream.reach));
  }
  const std::size_t halves = stream.row_halves * static_cast<std::size_t>(group_rows(stream));
  stream.waiting.resize(halves);
  stream.finished.resize(halves);
  begin_picture(stream);
  return stream;
}

std::size_t two_pass_stream_bytes(int width, const DofSettings& settings, Isa isa) {
  const StripFilter filter{settings, {}, isa};
  const int reach = tap_count(settings.max_coc_px);
  std::size_t bytes = sizeof(TwoPassStream);
  for (int x = 0; x < width; x += kStripColumns) {
    bytes += sizeof(Strip) + strip_bytes(filter, strip_shape(width, reach, x), slack(reach));
  }
  const auto groups = 2 * static_cast<std::size_t>(lanes_of(isa));
  return bytes + groups * static_cast<std::size_t>(width) * 4 * sizeof(std::uint16_t);
}

void put_row(TwoPassStream& stream, std::span<const std::uint16_t> row, ThreadPool& pool,
             const RowSink& sink) {
  assert(row.size() == stream.row_halves);
  std::ranges::copy(row, stream.waiting.begin() +
                             stream.rows_waiting * static_cast<std::ptrdiff_t>(stream.row_halves));
  if (++stream.rows_waiting == group_rows(stream)) filter_waiting(stream, pool, sink);
}

void end_rows(TwoPassStream& stream, ThreadPool& pool, const RowSink& sink) {
  if (stream.rows_waiting > 0) filter_waiting(stream, pool, sink);
  const bool any = stream.strips.front().lead == 0;  // or else no row came, and reach is 0
  while (any && stream.rows_below < stream.reach) {
    const int count = std::min(group_rows(stream), stream.reach - stream.rows_below);
    pool.for_each(static_cast<int>(stream.strips.size()), [&](int i) {
      Strip& strip = stream.strips[static_cast<std::size_t>(i)];
      room(strip, stream.filter);
      add_rows_below(strip, stream.filter, Outside::repeats, count);
    });
    stream.rows_below += count;
    write_finished(stream, pool, sink);
  }
  begin_picture(stream);
}

}  // namespace softfocus
