#include "scenes/shadows/light_grid.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "scenes/shadows/facets.h"

namespace softfocus {
namespace {

constexpr int kMostCells = 1024;

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
// are (across, across, ahead).
struct SidePolygon {
  std::array<glm::dvec3, 12> corners;
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

// Calls use(first cell of a row, count) for each row of cells that the polygon may touch.
template <class Use>
void for_each_row(const LightGrid& grid, std::span<const glm::dvec3> polygon, const Use& use) {
  const auto rows_of = [&](int side, const PlaceBox& box) {
    const CellRange range = range_of(box.low, box.high, grid.cells);
    for (int y = range.y_begin; y <= range.y_end; ++y) {
      use((side * grid.cells + y) * grid.cells + range.x_begin, range.x_end - range.x_begin + 1);
    }
  };
  if (grid.sides == 1) {
    PlaceBox box;
    for (const glm::dvec3& corner : polygon) {
      add(box, (along_axes(grid, corner) - grid.low) / grid.size);
    }
    rows_of(0, box);
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
    rows_of(side, box);
  }
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

// Without a pool, one after the other.
template <class Work>
void for_each(ThreadPool* pool, std::size_t count, const Work& work) {
  if (pool != nullptr) {
    pool->for_each(static_cast<int>(count), [&](int i) { work(static_cast<std::size_t>(i)); });
    return;
  }
  for (std::size_t i = 0; i < count; ++i) work(i);
}

// Cells of a row that name a caster.
struct CasterRow {
  std::uint32_t caster;
  int first, count;
};

// The rows of a part of the casters.
using RowsOfPart = std::vector<CasterRow>;

constexpr std::size_t kCastersOfRows = 4096;

// All of them, part after part; none if they are more than `most` cells.
std::optional<std::vector<RowsOfPart>> caster_rows(const LightGrid& grid,
                                                   std::span<const Facet> facets,
                                                   std::span<const std::uint32_t> casters,
                                                   std::size_t most, ThreadPool* pool) {
  std::vector<RowsOfPart> parts((casters.size() + kCastersOfRows - 1) / kCastersOfRows);
  std::atomic<std::size_t> entries{0};  // of all parts so far
  for_each(pool, parts.size(), [&](std::size_t number) {
    const std::size_t begin = number * kCastersOfRows;
    for (const std::uint32_t caster :
         casters.subspan(begin, std::min(kCastersOfRows, casters.size() - begin))) {
      if (entries.load(std::memory_order_relaxed) > most) return;
      std::size_t cells = 0;
      for_each_row(grid, facets[caster].corners, [&](int first, int count) {
        parts[number].push_back({caster, first, count});
        cells += static_cast<std::size_t>(count);
      });
      entries.fetch_add(cells, std::memory_order_relaxed);
    }
  });
  if (entries > most) return {};
  return parts;
}

// The facets that stop light, in their order.
std::vector<std::uint32_t> casters_of(const Facets& facets, const ShadowLight& light,
                                      ThreadPool* pool) {
  std::vector<std::uint8_t> stops(facets.facets.size());
  for_each(pool, (stops.size() + kCastersOfRows - 1) / kCastersOfRows, [&](std::size_t number) {
    const std::size_t begin = number * kCastersOfRows;
    for (std::size_t i = begin; i < std::min(begin + kCastersOfRows, stops.size()); ++i) {
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

LightGrid make_light_grid(const Facets& facets, const ShadowLight& light, ThreadPool* pool) {
  LightGrid grid;
  grid.light = light;
  grid.sides = light.w == 0.0 ? 1 : 6;
  grid.facets = facets.facets.size();
  const std::vector<std::uint32_t> casters = casters_of(facets, light, pool);
  const double per_side = static_cast<double>(casters.size()) / (grid.sides == 1 ? 0.5 : 1.5);
  grid.cells = std::clamp(static_cast<int>(std::sqrt(per_side)), 1, kMostCells);
  if (grid.sides == 1) set_side(grid, facets.facets, casters);
  const std::size_t most = kMostEntries * (casters.size() + 1);
  constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
  auto rows = caster_rows(grid, facets.facets, casters, grid.cells > 1 ? most : kAny, pool);
  while (!rows) {
    grid.cells /= 2;
    rows = caster_rows(grid, facets.facets, casters, grid.cells > 1 ? most : kAny, pool);
  }

  const auto cell_count = static_cast<std::size_t>(grid.sides) *
                          static_cast<std::size_t>(grid.cells) *
                          static_cast<std::size_t>(grid.cells);
  grid.begins.assign(cell_count + 1, 0);
  for (const RowsOfPart& part : *rows) {
    for (const auto& [caster, first, count] : part) {
      for (int i = 0; i < count; ++i) ++grid.begins[static_cast<std::size_t>(first + i) + 1];
    }
  }
  for (std::size_t i = 0; i < cell_count; ++i) grid.begins[i + 1] += grid.begins[i];
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
