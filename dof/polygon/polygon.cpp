#include "dof/polygon/polygon.h"

#include <algorithm>

#include "dof/half_resolution/half_fields.h"
#include "dof/half_resolution/merge_fields.h"
#include "dof/polygon/polygon_lines.h"

namespace softfocus {
namespace {

// How far a parallelogram's corner lies from the middle, and a hat's width.
constexpr float kPolygonStretch = 1.75f;

LineField far_of(const HalfFields& fields, int reach, ThreadPool& pool) {
  const Planes& cells = fields.cells;
  LineField field = make_line_field(false, cells.width, cells.height, reach, pool);
  pool.for_each(cells.height, [&](int y) {
    for (int c = 0; c < 3; ++c) {
      std::copy_n(plane_row(cells, kFarColour + c, y), cells.width, line_row(field, c, y));
    }
    const float* size = plane_row(cells, kFarSize, y);
    const float* weight = plane_row(cells, kFarWeight, y);
    std::copy_n(size, cells.width, line_row(field, kLineSize, y));
    float* counts = line_row(field, kLineCounts, y);
    for (int x = 0; x < cells.width; ++x) counts[x] = size[x] * weight[x];
    repeat_line_ends(field, 0, kLinePlanes, y);
  });
  return field;
}

LineField near_of(const HalfFields& fields, const HalfTiles& tiles, int reach, ThreadPool& pool) {
  const Planes& cells = fields.cells;
  LineField field = make_line_field(true, cells.width, cells.height, reach, pool);
  pool.for_each(cells.height, [&](int y) {
    for (int c = 0; c < kLineValues; ++c) {
      std::copy_n(plane_row(cells, c < 3 ? kNearColour + c : kNearOpacity, y), cells.width,
                  line_row(field, c, y));
    }
    std::copy_n(plane_row(cells, kNearSize, y), cells.width, line_row(field, kLineSize, y));
    repeat_line_ends(field, 0, kLinePlanes, y);
    std::vector<LineRun>& runs = field.runs[static_cast<std::size_t>(y)];
    runs.clear();
    for (int column = 0; column < tiles.columns; ++column) {
      if (!(tiles.near_reach[tiles.at(column, y / kHalfTile)] > 0.0f)) continue;
      const int begin = column * kHalfTile, end = std::min(begin + kHalfTile, cells.width);
      if (!runs.empty() && runs.back().end == begin) {
        runs.back().end = end;
      } else {
        runs.push_back({begin, end});
      }
    }
  });
  return field;
}

void put_back(const LineField& field, HalfFields& fields, ThreadPool& pool) {
  Planes& cells = fields.cells;
  pool.for_each(cells.height, [&](int y) {
    const float* weight = plane_row(cells, kFarWeight, y);
    for (int c = 0; c < (field.near ? kLineValues : 3); ++c) {
      const float* from = line_row(field, c, y);
      float* to = plane_row(
          cells, field.near ? (c < 3 ? kNearColour + c : kNearOpacity) : kFarColour + c, y);
      for (int x = 0; x < cells.width; ++x) to[x] = field.near ? from[x] : from[x] * weight[x];
    }
  });
}

void polygon(const DofInput& input, const ImageView& result, int corners, ThreadPool& pool) {
  HalfFields fields = make_half_fields(input, pool, corners);
  const HalfTiles tiles = make_half_tiles(fields, kPolygonStretch, true, pool);
  for (const bool near : {false, true}) {
    if (near && !fields.near_field) continue;
    const std::vector<float>& sizes = near ? tiles.near_reach : tiles.far_reach;
    const float largest = *std::max_element(sizes.begin(), sizes.end());
    const PolygonLines lines = polygon_lines(corners, largest, near);
    int reach = 0;
    for (const auto& part : lines.parts) {
      for (const PolygonLine& line : part) reach = std::max(reach, line.reach);
    }
    LineField field = near ? near_of(fields, tiles, reach, pool) : far_of(fields, reach, pool);
    blur_polygon(lines, field, pool);
    put_back(field, fields, pool);
  }
  merge_fields(input, fields, result, pool);
}

}  // namespace

void pentagonal(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  polygon(input, result, 5, pool);
}
void hexagonal(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  polygon(input, result, 6, pool);
}

}  // namespace softfocus
