#include "scenes/shadows/light_grid.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "raster/threads/loops.h"
#include "scenes/shadows/facets.h"

namespace softfocus {
namespace {

constexpr int kMostCellsAcross = 1024;

// Most entries of a caster on average. Casters that each fill the light's view get fewer, larger
// cells: the memory stays a multiple of the casters'.
constexpr std::size_t kMostEntries = 32;

// A part of a side, in cells: x_begin <= x <= x_end.
struct CellRange {
  int x_begin, y_begin, x_end, y_end;
};

int cell_of(double place, int cells) {
  // Not a number, which a division by 0 gives, is cell 0: see range_of().
  if (!(place > 0.0)) return 0;
  return static_cast<int>(std::min(place * cells, cells - 1.0));
}

// A little more than the polygon: what touches a cell's edge is in both cells.
constexpr double kMargin = 1e-9;

CellRange range_of(glm::dvec2 low, glm::dvec2 high, int cells) {
  return {cell_of(low.x - kMargin, cells), cell_of(low.y - kMargin, cells),
          cell_of(high.x + kMargin, cells), cell_of(high.y + kMargin, cells)};
}

glm::dvec2 along_axes(const LightGrid& grid, glm::dvec3 p) {
  return {dot(p, grid.axes[0]), dot(p, grid.axes[1])};
}

// A polygon as a side of the cube sees it: cut by its pyramid's four planes, then divided. Points
// are (across, across, ahead). An outline has 8 corners, each plane adds one, and rounding may add
// another where corners are there twice.
struct SidePolygon {
  std::array<glm::dvec3, 16> corners;
  std::size_t count = 0;
};

double inside_by(glm::dvec3 p, int plane) {
  const double across = plane < 2 ? p.x : p.y;
  return (p.z * (1.0 + kMargin)) + (plane % 2 == 0 ? across : -across);
}

void cut_to_pyramid(SidePolygon& polygon, int plane) {
  SidePolygon kept;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const glm::dvec3 a = polygon.corners[i], b = polygon.corners[(i + 1) % polygon.count];
    const double d_a = inside_by(a, plane), d_b = inside_by(b, plane);
    if (d_a >= 0.0 && kept.count < kept.corners.size()) kept.corners[kept.count++] = a;
    if ((d_a < 0.0) != (d_b < 0.0) && kept.count < kept.corners.size()) {
      kept.corners[kept.count++] = a + (b - a) * (d_a / (d_a - d_b));
    }
  }
  polygon = kept;
}

glm::dvec3 seen_by_side(glm::dvec3 p, int side) {
  const int axis = side / 2;
  const double sign = side % 2 == 0 ? 1.0 : -1.0;
  return {p[(axis + 1) % 3], p[(axis + 2) % 3], sign * p[axis]};
}

// Calls use(side, range) for each side whose cells the polygon may touch.
template <class Use>
void for_each_range(const LightGrid& grid, std::span<const glm::dvec3> polygon, const Use& use) {
  if (grid.sides == 1) {
    PlaceBox box;
    for (const glm::dvec3& corner : polygon) {
      add(box, (along_axes(grid, corner) - grid.low) / grid.size);
    }
    use(0, range_of(box.low, box.high, grid.cells));
    return;
  }
  for (int side = 0; side < 6; ++side) {
    SidePolygon seen;
    for (const glm::dvec3& corner : polygon) {
      seen.corners[seen.count++] = seen_by_side(corner - grid.light.place, side);
    }
    for (int plane = 0; plane < 4 && seen.count > 0; ++plane) cut_to_pyramid(seen, plane);
    if (seen.count == 0) continue;
    PlaceBox box;
    for (std::size_t i = 0; i < seen.count; ++i) {
      const glm::dvec3& p = seen.corners[i];
      // At the light itself: it is in every direction.
      if (!(p.z > std::numeric_limits<double>::min())) {
        add(box, glm::dvec2{0.0});
        add(box, glm::dvec2{1.0});
      } else {
        add(box, glm::dvec2{p.x, p.y} / p.z * 0.5 + 0.5);
      }
    }
    use(side, range_of(box.low, box.high, grid.cells));
  }
}

// Calls use(first cell of a row, count) for each row of cells that the polygon may touch.
template <class Use>
void for_each_row(const LightGrid& grid, std::span<const glm::dvec3> polygon, const Use& use) {
  for_each_range(grid, polygon, [&](int side, const CellRange& range) {
    for (int y = range.y_begin; y <= range.y_end; ++y) {
      use((side * grid.cells + y) * grid.cells + range.x_begin, range.x_end - range.x_begin + 1);
    }
  });
}

std::size_t cell_count(const LightGrid& grid) {
  return static_cast<std::size_t>(grid.sides) * static_cast<std::size_t>(grid.cells) *
         static_cast<std::size_t>(grid.cells);
}

// A polygon that touches more than half of the cells looks at all casters.
bool looks_at_all(const LightGrid& grid, std::span<const glm::dvec3> polygon) {
  std::size_t cells = 0;
  for_each_range(grid, polygon, [&](int, const CellRange& range) {
    cells += static_cast<std::size_t>(range.x_end - range.x_begin + 1) *
             static_cast<std::size_t>(range.y_end - range.y_begin + 1);
  });
  return cells > cell_count(grid) / 2;
}

// An entry of each cell: 1 where a wanted receiver may look.
std::vector<std::uint8_t> looked_at(const LightGrid& grid, std::span<const WantedReceiver> wanted) {
  std::vector<std::uint8_t> marks(cell_count(grid));
  for (const WantedReceiver& receiver : wanted) {
    if (looks_at_all(grid, receiver.corners_of_outline())) continue;
    for_each_row(grid, receiver.corners_of_outline(), [&](int first, int count) {
      std::fill_n(marks.begin() + first, count, std::uint8_t{1});
    });
  }
  return marks;
}

void set_side(LightGrid& grid, std::span<const Facet> facets,
              std::span<const std::uint32_t> casters) {
  const glm::dvec3 towards = grid.light.place;
  // Across the axis that it points along least.
  glm::dvec3 least{0.0};
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::fabs(towards[i]) < std::fabs(towards[axis])) axis = i;
  }
  least[axis] = 1.0;
  grid.axes[0] = normalize(cross(least, towards));
  grid.axes[1] = cross(towards, grid.axes[0]);
  PlaceBox box;
  for (const std::uint32_t caster : casters) {
    for (const glm::dvec3& corner : facets[caster].corners) add(box, along_axes(grid, corner));
  }
  if (casters.empty()) return;
  grid.low = box.low;
  const double least_size = std::numeric_limits<double>::min();
  grid.size = {std::max(box.high.x - box.low.x, least_size),
               std::max(box.high.y - box.low.y, least_size)};
}

// Cells of a row that name a caster.
struct CasterRow {
  std::uint32_t caster;
  int first, count;
};

// The rows of a part of the casters.
using RowsOfPart = std::vector<CasterRow>;

constexpr std::size_t kCastersOfRows = 4096;

// Entries that a task counts by itself: threads share the number of all.
constexpr std::size_t kEntriesOfStep = 1024;

// All of them, part after part, from their first marked cell to their last; none if they are more
// than `most` cells. Without marks all cells are.
std::optional<std::vector<RowsOfPart>> caster_rows(const LightGrid& grid,
                                                   std::span<const Facet> facets,
                                                   std::span<const std::uint8_t> marks,
                                                   std::size_t most, ThreadPool* pool) {
  const std::span<const std::uint32_t> casters = grid.all;
  std::vector<RowsOfPart> parts((casters.size() + kCastersOfRows - 1) / kCastersOfRows);
  std::atomic<std::size_t> entries{0};  // of all parts so far
  for_each_part(pool, casters.size(), kCastersOfRows, [&](std::size_t begin, std::size_t end) {
    RowsOfPart& part = parts[begin / kCastersOfRows];
    std::size_t cells = 0;  // not yet among the entries
    for (std::size_t i = begin; i < end; ++i) {
      for_each_row(grid, facets[casters[i]].corners, [&](int first, int count) {
        if (!marks.empty()) {
          for (; count > 0 && marks[static_cast<std::size_t>(first)] == 0; --count) ++first;
          while (count > 0 && marks[static_cast<std::size_t>(first + count - 1)] == 0) --count;
          if (count == 0) return;
        }
        part.push_back({casters[i], first, count});
        cells += static_cast<std::size_t>(count);
      });
      if (cells < kEntriesOfStep && i + 1 < end) continue;
      if (entries.fetch_add(cells, std::memory_order_relaxed) > most) return;
      cells = 0;
    }
  });
  if (entries > most) return {};
  return parts;
}

// The facets that stop light, in their order.
std::vector<std::uint32_t> casters_of(const Facets& facets, const ShadowLight& light,
                                      ThreadPool* pool) {
  std::vector<std::uint8_t> stops(facets.facets.size());
  for_each_part(pool, stops.size(), kCastersOfRows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      stops[i] = stops_light(facets.facets[i], facets.planes[i], light) ? 1 : 0;
    }
  });
  std::vector<std::uint32_t> casters;
  for (std::uint32_t i = 0; i < stops.size(); ++i) {
    if (stops[i] != 0) casters.push_back(i);
  }
  return casters;
}

}  // namespace

bool stops_light(const Facet& facet, const FacetPlane& plane, const ShadowLight& light) {
  if (!facet.casts || !has_plane(plane)) return false;
  const double before = height_over(plane, light);
  return facet.two_sided ? before != 0.0 : before > 0.0;
}

LightGrid make_light_grid(const Facets& facets, const ShadowLight& light, ThreadPool* pool,
                          std::span<const WantedReceiver> wanted) {
  LightGrid grid;
  grid.light = light;
  grid.sides = light.w == 0.0 ? 1 : 6;
  grid.facets = facets.facets.size();
  grid.all = casters_of(facets, light, pool);
  const double per_side = static_cast<double>(grid.all.size()) / (grid.sides == 1 ? 0.5 : 1.5);
  grid.cells = std::clamp(static_cast<int>(std::sqrt(per_side)), 1, kMostCellsAcross);
  if (grid.sides == 1) set_side(grid, facets.facets, grid.all);
  const std::size_t most = kMostEntries * (grid.all.size() + 1);
  const auto rows_of_cells = [&] {
    const std::vector<std::uint8_t> marks =
        wanted.empty() ? std::vector<std::uint8_t>{} : looked_at(grid, wanted);
    constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
    return caster_rows(grid, facets.facets, marks, grid.cells > 1 ? most : kAny, pool);
  };
  auto rows = rows_of_cells();
  while (!rows) {
    grid.cells /= 2;
    rows = rows_of_cells();
  }

  const std::size_t cells = cell_count(grid);
  grid.begins.assign(cells + 1, 0);
  for (const RowsOfPart& part : *rows) {
    for (const auto& [caster, first, count] : part) {
      for (int i = 0; i < count; ++i) ++grid.begins[static_cast<std::size_t>(first + i) + 1];
    }
  }
  for (std::size_t i = 0; i < cells; ++i) grid.begins[i + 1] += grid.begins[i];
  grid.casters.resize(grid.begins.back());
  std::vector<std::uint32_t> next(grid.begins.begin(), grid.begins.end() - 1);
  for (const RowsOfPart& part : *rows) {
    for (const auto& [caster, first, count] : part) {
      for (int i = 0; i < count; ++i) {
        grid.casters[next[static_cast<std::size_t>(first + i)]++] = caster;
      }
    }
  }
  return grid;
}

void find_casters(const LightGrid& grid, std::span<const glm::dvec3> polygon,
                  std::vector<std::uint32_t>& found) {
  found.clear();
  for_each_row(grid, polygon, [&](int first, int count) {
    const std::uint32_t* all = grid.casters.data();
    found.insert(found.end(), all + grid.begins[static_cast<std::size_t>(first)],
                 all + grid.begins[static_cast<std::size_t>(first + count)]);
  });
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

std::span<const std::uint32_t> find_casters(const LightGrid& grid,
                                            std::span<const glm::dvec3> polygon,
                                            CasterSearch& search) {
  if (looks_at_all(grid, polygon)) return grid.all;
  std::vector<std::uint32_t>& found = search.found;
  found.clear();
  if (search.found_in.size() != grid.facets || ++search.search == 0) {
    search.found_in.assign(grid.facets, 0);
    search.search = 1;
  }
  for_each_row(grid, polygon, [&](int first, int count) {
    const std::uint32_t end = grid.begins[static_cast<std::size_t>(first + count)];
    for (std::uint32_t i = grid.begins[static_cast<std::size_t>(first)]; i < end; ++i) {
      const std::uint32_t caster = grid.casters[i];
      if (search.found_in[caster] == search.search) continue;
      search.found_in[caster] = search.search;
      found.push_back(caster);
    }
  });
  // To look at all is quicker than to sort many.
  if (found.size() > grid.facets / 16) {
    found.clear();
    for (std::uint32_t i = 0; i < grid.facets; ++i) {
      if (search.found_in[i] == search.search) found.push_back(i);
    }
  } else {
    std::sort(found.begin(), found.end());
  }
  return found;
}

}  // namespace softfocus
