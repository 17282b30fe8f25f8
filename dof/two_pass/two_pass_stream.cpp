#include "dof/two_pass/two_pass_stream.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <vector>

#include "dof/two_pass/two_pass_strip.h"
#include "dof/weights.h"

namespace softfocus {

struct TwoPassStream::State {
  int width;
  int reach;
  StripFilter filter;
  std::vector<Strip> strips;

  std::size_t row_halves;               // from row to row, in both of these
  std::vector<std::uint16_t> waiting;   // a group of rows that came in
  std::vector<std::uint16_t> finished;  // a group of rows to go out
  int rows_waiting = 0;
  int rows_below = 0;  // rows below the last one that have been made up
};

namespace {

using State = TwoPassStream::State;

// Columns of a strip: its lines stay in a core's cache while a group of rows is filtered.
constexpr int kStripColumns = 128;

// Nodes of a strip besides those in reach: the more, the less often nodes are moved.
int slack(int reach) { return std::max(reach, kMostLanes); }

StripShape strip_shape(int width, int reach, int x_begin) {
  return {width, x_begin, std::min(kStripColumns, width - x_begin), reach};
}

int group_rows(const State& state) { return lanes_of(state.filter.isa); }

void begin_picture(State& state) {
  for (Strip& strip : state.strips) begin_rows(strip, state.filter, Outside::repeats, 0);
  state.rows_waiting = 0;
  state.rows_below = 0;
}

void write_finished(State& state, ThreadPool& pool, const RowSink& sink) {
  const int count = std::min(rows_done(state.strips.front()), group_rows(state));
  if (count <= 0) return;
  pool.for_each(static_cast<int>(state.strips.size()), [&](int i) {
    write_rows(state.strips[static_cast<std::size_t>(i)], state.filter, count,
               state.finished.data(),
               static_cast<std::ptrdiff_t>(state.row_halves * sizeof(std::uint16_t)));
  });
  for (int i = 0; i < count; ++i) {
    sink(std::span{state.finished}.subspan(static_cast<std::size_t>(i) * state.row_halves,
                                           state.row_halves));
  }
}

void filter_waiting(State& state, ThreadPool& pool, const RowSink& sink) {
  std::array<const std::uint16_t*, 2 * kMostLanes> rows{};
  for (int i = 0; i < 2 * kMostLanes; ++i) {
    const int row = std::min(i, state.rows_waiting - 1);
    rows[static_cast<std::size_t>(i)] =
        state.waiting.data() + static_cast<std::size_t>(row) * state.row_halves;
  }
  pool.for_each(static_cast<int>(state.strips.size()), [&](int i) {
    Strip& strip = state.strips[static_cast<std::size_t>(i)];
    room(strip, state.filter);
    add_rows(strip, state.filter, rows.data(), state.rows_waiting);
  });
  state.rows_waiting = 0;
  write_finished(state, pool, sink);
}

}  // namespace

TwoPassStream::TwoPassStream(int width, const DofSettings& settings, const Profile& profile,
                             Isa isa)
    : state(new State{width,
                      tap_count(settings.max_coc_px),
                      {settings, profile.half_store, isa},
                      {},
                      static_cast<std::size_t>(width) * 4,
                      {},
                      {}}) {
  assert(width >= 1 && width <= kMaxImageSize);
  const auto strips = static_cast<std::size_t>((width + kStripColumns - 1) / kStripColumns);
  state->strips.reserve(strips);
  for (int x = 0; x < width; x += kStripColumns) {
    begin_strip(state->strips.emplace_back(), state->filter, strip_shape(width, state->reach, x),
                slack(state->reach));
  }
  const std::size_t halves = state->row_halves * static_cast<std::size_t>(group_rows(*state));
  state->waiting.resize(halves);
  state->finished.resize(halves);
  begin_picture(*state);
}

TwoPassStream::~TwoPassStream() = default;
TwoPassStream::TwoPassStream(TwoPassStream&&) noexcept = default;
TwoPassStream& TwoPassStream::operator=(TwoPassStream&&) noexcept = default;

std::size_t stream_bytes(const TwoPassStream& stream) {
  const State& state = *stream.state;
  std::size_t bytes =
      sizeof(TwoPassStream) + sizeof(State) + state.strips.capacity() * sizeof(Strip);
  for (const Strip& strip : state.strips) {
    bytes +=
        sizeof(float) * strip.vectors.capacity() + sizeof(std::int32_t) * strip.extents.capacity();
  }
  return bytes + sizeof(std::uint16_t) * (state.waiting.capacity() + state.finished.capacity());
}

std::size_t two_pass_stream_bytes(int width, const DofSettings& settings, Isa isa) {
  const StripFilter filter{settings, {}, isa};
  const int reach = tap_count(settings.max_coc_px);
  std::size_t bytes = sizeof(TwoPassStream) + sizeof(State);
  for (int x = 0; x < width; x += kStripColumns) {
    bytes += sizeof(Strip) + strip_bytes(filter, strip_shape(width, reach, x), slack(reach));
  }
  const auto groups = 2 * static_cast<std::size_t>(lanes_of(isa));
  return bytes + groups * static_cast<std::size_t>(width) * 4 * sizeof(std::uint16_t);
}

void put_row(TwoPassStream& stream, std::span<const std::uint16_t> row, ThreadPool& pool,
             const RowSink& sink) {
  State& state = *stream.state;
  assert(row.size() == state.row_halves);
  std::copy(
      row.begin(), row.end(),
      state.waiting.begin() + state.rows_waiting * static_cast<std::ptrdiff_t>(state.row_halves));
  if (++state.rows_waiting == group_rows(state)) filter_waiting(state, pool, sink);
}

void end_rows(TwoPassStream& stream, ThreadPool& pool, const RowSink& sink) {
  State& state = *stream.state;
  if (state.rows_waiting > 0) filter_waiting(state, pool, sink);
  const bool any = state.strips.front().lead == 0;  // otherwise no row came, or reach is 0
  while (any && state.rows_below < state.reach) {
    const int count = std::min(group_rows(state), state.reach - state.rows_below);
    pool.for_each(static_cast<int>(state.strips.size()), [&](int i) {
      Strip& strip = state.strips[static_cast<std::size_t>(i)];
      room(strip, state.filter);
      add_rows_below(strip, state.filter, Outside::repeats, count);
    });
    state.rows_below += count;
    write_finished(state, pool, sink);
  }
  begin_picture(state);
}

}  // namespace softfocus
