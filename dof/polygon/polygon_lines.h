#pragma once
// A polygon by blurs along lines, after McIntosh, Riecke and DiPaola 2012 and White 2011: a blur
// along a line, then one along another, is a parallelogram; a few parallelograms make a polygon.
//
//   5 corners  three parallelograms around the pentagon, each with two neighbouring sides of it, at
//              the top and at either lower corner: of their pictures the least, channel by channel,
//              for a point shows where all three overlap. And three rhombi of those sides, inside
//              it: of their pictures the most. Alone, the first keeps 0.69 of a lone cell's light,
//              the second makes 1.81 of it; in the shares L = 0.72 and 1 - L they keep all of it,
//              and what the least takes from an edge or a texture the most gives back.
//   6 corners  three rhombi side by side, each from the middle to two of every second corner. Of
//              their pictures the mean.
//
// A corner is up. A cell of size a, the radius of the circle around the polygon, gathers
//   out = sum of w v / sum of w
//   w(n) = sat(h + 1/2 - |n - m|),  m = a middle,  h = max(1/2, a half)
// over steps n along the line, of one row or column of cells each, whichever is more along it.
// Between two rows or columns a step takes a share of each, by a hat as wide as one; along the
// second of two lines that both go by columns as wide as their distances there, or the
// parallelogram would have holes.
//
// Far field: a neighbour p counts as in circular.h, its value is mix(own, p's, min(1, 2 w_p a_p /
// a)). Near field: colour and opacity as they are, and the polygon upside down.
//
// polygon_line.frag and polygon_combine.frag are the same on a GPU.

#include <array>
#include <vector>

#include "dof/picture_planes.h"

namespace softfocus {

/// A neighbour that a step along a line takes a share of.
struct LineTap {
  int dx, dy;
  float share;
};

struct PolygonLine {
  int reach;                  ///< steps to either side
  int taps_a_step;            ///< for steps -reach, ..., reach in `taps`
  float middle, half;         ///< in steps, for a size of 1
  std::vector<LineTap> taps;  ///< those of share 0 fill a step up
};

inline constexpr std::size_t kPolygonParts = 3;

struct PolygonLines {
  /// The first line and the second of kPolygonParts parallelograms, and of 5 corners of as many
  /// inside.
  std::vector<std::array<PolygonLine, 2>> parts;
  float least_share;  ///< L; 0: the mean
};

/// For sizes up to `largest`. `corners` is 5 or 6.
PolygonLines polygon_lines(int corners, float largest, bool upside_down);

/// Planes of a field that lines blur: colour, opacity of the near field, size, and of the far field
/// what counts of it, w_p a_p.
inline constexpr int kLineValues = 4, kLineSize = 4, kLineCounts = 5, kLinePlanes = 6;

/// Where a field has anything to blur: runs of a row's cells. The others become 0.
struct LineRun {
  int begin, end;
};

/// A field with its rows' ends repeated, for blurs along lines.
struct LineField {
  bool near;
  int width, height;
  int margin;                              ///< cells before and after a row
  Planes planes;                           ///< kLinePlanes
  std::vector<std::vector<LineRun>> runs;  ///< of each row
};
LineField make_line_field(bool near, int width, int height, int reach, ThreadPool& pool);

inline float* line_row(LineField& field, int plane, int y) {
  return plane_row(field.planes, plane, y) + field.margin;
}
inline const float* line_row(const LineField& field, int plane, int y) {
  return plane_row(field.planes, plane, y) + field.margin;
}

/// Repeats the ends of a row of `count` planes from `first` on.
void repeat_line_ends(LineField& field, int first, int count, int y);

/// Blurs the values along a line. `to` has the sizes and counts of `from` already.
void blur_line(const PolygonLine& line, const LineField& from, LineField& to, ThreadPool& pool);

/// The polygon: all lines, and what is left of their pictures, in place.
void blur_polygon(const PolygonLines& lines, LineField& field, ThreadPool& pool);

}  // namespace softfocus
