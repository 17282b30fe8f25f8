#pragma once
// A strip of columns on its way down the picture through both passes of the two-pass
// filter. Rows go in, as many at once as a vector has lanes; each is filtered along x and
// becomes a node of the lines along y, of which only those within reach of rows to come
// are kept: the strip stays in a core's cache, whatever the picture's height.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dof/dof.h"
#include "dof/two_pass/gather_nodes.h"
#include "raster/images/image.h"
#include "raster/lanes/isa.h"

namespace softfocus {

/// How the colours between the passes are stored.
enum class Between : std::uint8_t { half, single };

/// What a strip is filtered with.
struct StripFilter {
  DofSettings settings;
  HalfRounding rounding;
  Isa isa;
  Between between = Between::half;
  bool past_caches = false;  ///< see write_past_caches(); needs an Image's rows
};

struct Strip {
  int picture_width;
  int x_begin;   ///< a multiple of the lanes
  int columns;   ///< in whole vectors: the last may lie past the picture's edge
  int reach;     ///< taps to each side
  int halo;      ///< the reach in whole vectors
  int capacity;  ///< nodes in each line along y

  GatherNodes across;       ///< of the rows at hand: halo + columns + halo nodes
  GatherNodes down;         ///< `capacity` nodes for each vector of columns
  std::uint32_t* depths;    ///< halves, a vector for each node of `down`
  std::uint32_t* gathered;  ///< what a line's filter gives: two or three vectors a node

  int lead = 0;    ///< nodes before the first row, to be made when it comes
  int filled = 0;  ///< nodes of `down` that are there
  int next = 0;    ///< the node whose row is to come out next

  std::vector<float, RowAllocator<float>> vectors;
  std::vector<std::int32_t> extents;

  Strip() = default;  // moved, but not copied: the pointers lead into its own memory
  Strip(Strip&&) = default;
  Strip& operator=(Strip&&) = default;
};

/// The part of a picture that a strip is.
struct StripShape {
  int picture_width;
  int x_begin;
  int columns;
  int reach;  ///< no radius in the part is above reach + 1
};

/// Memory that a strip of this shape takes.
std::size_t strip_bytes(const StripFilter& filter, const StripShape& shape, int batch);

/// Makes a strip ready for rows. Its memory is used again if it is large enough. `batch`
/// is how many rows may wait to come out.
void begin_strip(Strip& strip, const StripFilter& filter, const StripShape& shape, int batch);

/// What lies above the first row that comes in, and below the last one.
enum class Outside : std::uint8_t {
  repeats,  ///< that row: the picture's edge
  sharp,    ///< rows that reach none of those that come out
};

/// The first row to come out is that which comes in `rows_before` after the first one.
void begin_rows(Strip& strip, const StripFilter& filter, Outside above, int rows_before);

/// Rows that add_rows() or add_rows_below() can take now.
int room(Strip& strip, const StripFilter& filter);

/// Takes the next `count` rows; `rows` has an entry for each lane, those past the count
/// any row, and as many for the rows after these, which are fetched ahead. Needs room for
/// as many rows as there are lanes.
void add_rows(Strip& strip, const StripFilter& filter, const std::uint16_t* const* rows, int count);

/// Takes rows that lie below the last one.
void add_rows_below(Strip& strip, const StripFilter& filter, Outside below, int count);

/// Rows that can come out.
int rows_done(const Strip& strip);

/// Writes the next `count` rows, of which the first begins at `result`.
void take_rows(Strip& strip, const StripFilter& filter, int count, std::uint16_t* result,
               std::size_t stride);

}  // namespace softfocus
