#pragma once
// A strip of columns on its way down the picture, through both passes of the two-pass filter.
// Rows go in, a vector's lanes of them at once. Each is filtered along x and becomes a node of
// the lines along y. Only nodes within reach of the next rows are kept, so a strip stays in a
// core's cache however high the picture is. Needs a vector unit with kernels (not scalar).

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dof/dof.h"
#include "raster/images/image.h"
#include "raster/lanes/isa.h"

namespace softfocus {

/// A line of pixels for kernels. A node is one place along the line, in kLanes lines at once:
/// 16 rows are filtered along x together, one a lane, then 16 columns along y. Neighbours
/// along the line are then whole vectors.
///
/// A node has two forms. If P's circles cover the receivers (overlap 1) and nothing leaks
/// (leakage 1), W(P) = (1 * I) * 1 is its intensity to the bit, and colour * W(P) is the same
/// product for all receivers: the tap is four additions of `whole`. `covers` says how far that
/// holds. Other taps are computed from `part`.
///
/// Arrays by node; `whole` and `part` hold four vectors a node. On both sides of the nodes
/// that are filtered lie as many nodes as the taps reach.
struct GatherNodes {
  float* whole;  ///< intensity; intensity * red, green, blue
  float* part;   ///< radius, its sign set beyond the focus; red, green, blue

  std::int32_t* covers;      ///< up to this distance all pixels of the node have overlap 1
  std::int32_t* covers_all;  ///< covers, or 0 if a pixel lies beyond the focus and may leak
  std::int32_t* touches;     ///< past this distance all pixels of the node have overlap 0
};

/// How the colours between the passes are stored.
enum class Between : std::uint8_t { half, single };

struct StripFilter {
  DofSettings settings;
  HalfRounding rounding;
  Isa isa;
  Between between = Between::half;
  bool past_caches = false;  ///< write_past_caches() of the result
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
  std::uint32_t* gathered;  ///< a filtered line: two or three vectors a node

  int lead = 0;    ///< nodes above the first row, to be made when that row comes
  int filled = 0;  ///< nodes of `down` so far
  int next = 0;    ///< the node whose row comes out next

  std::vector<float, RowAllocator<float>> vectors;
  std::vector<std::int32_t> extents;

  Strip() = default;  // moved, not copied: the pointers lead into its own memory
  Strip(Strip&&) = default;
  Strip& operator=(Strip&&) = default;
};

/// Which part of a picture a strip filters.
struct StripShape {
  int picture_width;
  int x_begin;
  int columns;
  int reach;  ///< no radius in the part is above reach + 1
};

/// Bytes of memory that a strip of this shape takes.
std::size_t strip_bytes(const StripFilter& filter, const StripShape& shape, int batch);

/// Makes a strip ready for rows; memory that it has is used again. At most `batch` rows wait
/// to come out.
void begin_strip(Strip& strip, const StripFilter& filter, const StripShape& shape, int batch);

/// What lies above the first row that goes in, and below the last one.
enum class Outside : std::uint8_t {
  repeats,  ///< that row again: the picture's edge
  sharp,    ///< rows that reach none of those that come out
};

/// Begins a picture, or a part of one. The first row to come out is the one that goes in
/// `rows_before` after the first.
void begin_rows(Strip& strip, const StripFilter& filter, Outside above, int rows_before);

/// Rows that add_rows() or add_rows_below() can take now. Makes room.
int room(Strip& strip, const StripFilter& filter);

/// Adds the next `count` rows, up to the unit's lanes. `rows` has twice the unit's lanes of
/// entries: first these rows, then the rows after them, which are fetched ahead. Every entry
/// is a row that can be read. Needs room for the unit's lanes, whatever the count.
void add_rows(Strip& strip, const StripFilter& filter, const std::uint16_t* const* rows, int count);

/// Adds `count` rows that lie below the last one.
void add_rows_below(Strip& strip, const StripFilter& filter, Outside below, int count);

/// Rows that can come out now.
int rows_done(const Strip& strip);

/// Writes the strip's columns of the next `count` rows. `result` is where the first of these
/// rows of the picture begins, at x = 0.
void write_rows(Strip& strip, const StripFilter& filter, int count, std::uint16_t* result,
                std::ptrdiff_t stride_bytes);

}  // namespace softfocus
