#include "scenes/surface_splatting/surface_splats.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "dof/dof.h"
#include "raster/numbers/vector_math.h"
#include "scenes/lens_views/ray_geometry.h"
#include "scenes/surface_splatting/splat_sources.h"

namespace softfocus {
namespace {

// A task's rows of pixels: no cell is higher.
constexpr int kSplatBandRows = kLargestSplatCell;
static_assert(1 << (kSplatLevels - 1) == kLargestSplatCell);

// Points that a cell's side has at least, if its circle leaves it a choice.
constexpr int kPointsAcross = 4;

// --- spans ---

std::int64_t floor_quotient(std::int64_t a, std::int64_t b) {  // b > 0
  const std::int64_t quotient = a / b;
  return a % b < 0 ? quotient - 1 : quotient;
}

struct Span {
  int begin, end;  // of columns of the lattice
};

// The points (i + 1/2, row + 1/2) * step inside the polygon, in pixels. A point on an edge
// belongs to the polygon if the edge is its left or upper one.
Span span_of_row(const SeenTriangle& seen, int row, int step) {
  const std::int64_t y = (2 * static_cast<std::int64_t>(row) + 1) * step * 128;
  std::int64_t begin = floor_quotient(seen.left_px, step);
  std::int64_t end = floor_quotient(seen.right_px, step) + 1;
  for (std::size_t i = 0; i < static_cast<std::size_t>(seen.corners); ++i) {
    const std::size_t j = (i + 1) % static_cast<std::size_t>(seen.corners);
    const std::int64_t dx = seen.x[j] - seen.x[i], dy = seen.y[j] - seen.y[i];
    const bool owns = dy < 0 || (dy == 0 && dx > 0);
    // Inside is dx (y - y_i) - dy (x - x_i) >= 0, for x = step (256 i + 128).
    const std::int64_t at_zero = dx * (y - seen.y[i]) -
                                 dy * (static_cast<std::int64_t>(step) * 128 - seen.x[i]) -
                                 (owns ? 0 : 1);
    const std::int64_t slope = -dy * step * 256;
    if (slope > 0) {
      begin = std::max(begin, -floor_quotient(at_zero, slope));
    } else if (slope < 0) {
      end = std::min(end, floor_quotient(at_zero, -slope) + 1);
    } else if (at_zero < 0) {
      return {0, 0};
    }
  }
  if (begin >= end) return {0, 0};
  return {static_cast<int>(begin), static_cast<int>(end)};
}

// --- points to splats ---

// The last splat in a cell.
struct Slot {
  std::uint32_t surface = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t splat = 0;
};

// The cells of a level that can reach the picture, in a band.
struct CellGrid {
  int first = 0;  // column
  int columns = 0;
  std::vector<Slot> slots;
};

struct Band {
  int top_px;
  std::array<CellGrid, kSplatLevels> grids;
  std::vector<Splat> splats;
};

struct PointSource {
  const SplatCamera& camera;
  const std::vector<SeenMesh>& meshes;
  const Farthest& farthest;
  const Profile& profile;
};

int margin_of_level(int level) {
  const float most =
      level + 1 < kSplatLevels ? static_cast<float>(3 << (level + 1)) : kLargestMaxCoc;
  return static_cast<int>(splat_reach_px(most)) + 2;
}

Band make_band(const SplatCamera& camera, int number) {
  Band band{number * kSplatBandRows, {}, {}};
  for (int level = 1; level < kSplatLevels; ++level) {
    CellGrid& grid = band.grids[static_cast<std::size_t>(level)];
    const int margin = margin_of_level(level);
    grid.first = -(margin >> level) - 1;
    grid.columns = ((camera.width + margin) >> level) + 1 - grid.first;
    const auto cells = static_cast<std::size_t>(grid.columns * (kSplatBandRows >> level));
    grid.slots.resize(cells);
  }
  return band;
}

// A triangle's share of a cell: sums over its points there.
struct CellSum {
  int points = 0;
  double x = 0.0, y = 0.0, inverse_depth = 0.0;
};

LensRay pinhole_ray(const PointSource& source, double x, double y) {
  return lens_ray(source.camera.rays, {0.0, 0.0}, x, y);
}

BlockRays block_at(const PointSource& source, double x, double y, int size_px) {
  return {pinhole_ray(source, x, y), pinhole_ray(source, x + size_px, y),
          pinhole_ray(source, x, y + size_px)};
}

// A transparent surface is all there or not at all.
bool is_hole(const PointSource& source, const SeenTriangle& seen, double x, double y,
             double block_x, double block_y, int step) {
  const RayMesh& mesh = source.meshes[seen.surface].mesh;
  return (mesh.draw.variant.holed || mesh.draw.opacity.blends) &&
         opacity_at(mesh, hit_in_triangle(mesh, seen.triangle, pinhole_ray(source, x, y)),
                    block_at(source, block_x, block_y, step), source.profile) < 0.5f;
}

glm::vec3 shade_at(const PointSource& source, const SeenTriangle& seen, double x, double y,
                   double block_x, double block_y, int cell_px) {
  const SeenMesh& seen_mesh = source.meshes[seen.surface];
  const BlockRays block = block_at(source, block_x, block_y, cell_px);
  const RayHit hit = hit_in_triangle(seen_mesh.mesh, seen.triangle, pinhole_ray(source, x, y));
  return shade_hit(seen_mesh.mesh, hit, seen.back, seen_mesh.highlights, block, source.profile);
}

double inverse_depth_at(const SeenTriangle& seen, double x, double y) {
  const glm::dvec3& plane = seen.inverse_depth;
  const double inverse = (plane.x * x + plane.y * y) + plane.z;
  return std::min(std::max(inverse, seen.least_inverse), seen.most_inverse);
}

bool reaches_picture(const SplatCamera& camera, double x, double y, float radius_px) {
  const double reach = static_cast<double>(splat_reach_px(radius_px));
  return x > -reach && y > -reach && x < camera.width + reach && y < camera.height + reach;
}

// Points in focus, or nearly: each a splat of one pixel.
void add_sharp_row(const PointSource& source, const SeenTriangle& seen, int row, Span span,
                   Band& band) {
  const double y = row + 0.5;
  for (int column = span.begin; column < span.end; ++column) {
    const double x = column + 0.5;
    const double inverse = inverse_depth_at(seen, x, y);
    const float radius = source.camera.radius_px(inverse);
    if (splat_level(radius) != 0 || inverse * source.camera.far_m < 1.0) continue;
    if (!reaches_picture(source.camera, x, y, radius)) continue;
    if (is_hidden(source.farthest, source.camera.radius_per_inverse, x, y, inverse, 1)) continue;
    const double block_x = (column & ~1) + 0.5, block_y = (row & ~1) + 0.5;
    if (is_hole(source, seen, x, y, block_x, block_y, 1)) continue;
    const glm::vec3 colour = shade_at(source, seen, x, y, block_x, block_y, 1);
    band.splats.push_back({static_cast<float>(x), static_cast<float>(y),
                           static_cast<float>(inverse), radius, 1.0f, seen.surface, colour});
  }
}

// Adds to the splat that the cell has of this object, if they fit together.
bool joins(Splat& splat, const Splat& part, float cell_area) {
  const float area = splat.area_px + part.area_px;
  if (area > cell_area || std::fabs(splat.radius_px - part.radius_px) > part.radius_px * 0.125f) {
    return false;
  }
  const float share = part.area_px / area;
  splat.x_px += share * (part.x_px - splat.x_px);
  splat.y_px += share * (part.y_px - splat.y_px);
  splat.inverse_depth += share * (part.inverse_depth - splat.inverse_depth);
  splat.radius_px += share * (part.radius_px - splat.radius_px);
  splat.colour += (part.colour - splat.colour) * share;
  splat.area_px = area;
  return true;
}

void add_cell(const PointSource& source, const SeenTriangle& seen, int level, Slot& slot,
              const CellSum& sum, int step, Band& band) {
  const int cell_px = 1 << level;
  const double x = sum.x / sum.points, y = sum.y / sum.points;
  const double inverse = sum.inverse_depth / sum.points;
  const Splat part{static_cast<float>(x),
                   static_cast<float>(y),
                   static_cast<float>(inverse),
                   source.camera.radius_px(inverse),
                   static_cast<float>(sum.points * step * step),
                   seen.surface,
                   shade_at(source, seen, x, y, x, y, cell_px)};
  if (slot.surface == seen.surface &&
      joins(band.splats[slot.splat], part, static_cast<float>(cell_px * cell_px))) {
    return;
  }
  slot = {seen.surface, static_cast<std::uint32_t>(band.splats.size())};
  band.splats.push_back(part);
}

struct BandRows {
  int begin, end;  // of the lattice, in the band and the triangle
};

// A row of cells of one level, whose lattice rows are `rows`.
void add_cell_row(const PointSource& source, const SeenTriangle& seen, int level, int step,
                  BandRows rows, std::span<const Span> spans, Band& band) {
  Span all{std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  for (const Span& span : spans) {
    if (span.begin >= span.end) continue;
    all = {std::min(all.begin, span.begin), std::max(all.end, span.end)};
  }
  if (all.begin >= all.end) return;
  CellGrid& grid = band.grids[static_cast<std::size_t>(level)];
  const int across = (1 << level) / step;  // points
  const int cell_row = (rows.begin * step - band.top_px) >> level;
  const int shift = level - std::countr_zero(static_cast<unsigned>(step));
  const int first = std::max(all.begin >> shift, grid.first);
  const int last = std::min((all.end - 1) >> shift, grid.first + grid.columns - 1);
  for (int column = first; column <= last; ++column) {
    CellSum sum;
    for (int row = rows.begin; row < rows.end; ++row) {
      const Span& span = spans[static_cast<std::size_t>(row - rows.begin)];
      const double y = (row + 0.5) * step;
      const int end = std::min(span.end, (column + 1) * across);
      for (int i = std::max(span.begin, column * across); i < end; ++i) {
        const double x = (i + 0.5) * step;
        const double inverse = inverse_depth_at(seen, x, y);
        const float radius = source.camera.radius_px(inverse);
        if (splat_level(radius) != level || inverse * source.camera.far_m < 1.0) continue;
        if (!reaches_picture(source.camera, x, y, radius)) continue;
        if (is_hidden(source.farthest, source.camera.radius_per_inverse, x, y, inverse, step))
          continue;
        if (is_hole(source, seen, x, y, x, y, step)) continue;
        ++sum.points;
        sum.x += x;
        sum.y += y;
        sum.inverse_depth += inverse;
      }
    }
    if (sum.points == 0) continue;
    Slot& slot =
        grid.slots[static_cast<std::size_t>(cell_row * grid.columns + column - grid.first)];
    add_cell(source, seen, level, slot, sum, step, band);
  }
}

void add_triangle(const PointSource& source, const SeenTriangle& seen, Band& band) {
  int step = 1;  // wider than a pixel if all of it is so blurred
  while (2 * step * kPointsAcross <= 1 << seen.least_level) step *= 2;
  const int top = std::max(seen.top_px, band.top_px);
  const int bottom = std::min(seen.bottom_px, band.top_px + kSplatBandRows);
  if (top >= bottom) return;
  const int begin = static_cast<int>(floor_quotient(top, step));
  const int end = static_cast<int>(floor_quotient(bottom - 1, step)) + 1;
  std::array<Span, kSplatBandRows> spans;
  for (int row = begin; row < end; ++row) {
    spans[static_cast<std::size_t>(row - begin)] = span_of_row(seen, row, step);
  }
  for (int level = seen.least_level; level <= seen.most_level; ++level) {
    if (level == 0) {
      for (int row = begin; row < end; ++row) {
        add_sharp_row(source, seen, row, spans[static_cast<std::size_t>(row - begin)], band);
      }
      continue;
    }
    const int down = (1 << level) / step;
    for (int row = begin; row < end;) {
      const int next = std::min(end, static_cast<int>((floor_quotient(row, down) + 1) * down));
      add_cell_row(source, seen, level, step, {row, next},
                   std::span{spans}.subspan(static_cast<std::size_t>(row - begin),
                                            static_cast<std::size_t>(next - row)),
                   band);
      row = next;
    }
  }
}

// The background, a surface at the far distance.
void add_background(const PointSource& source, std::uint32_t surface, glm::vec3 colour,
                    Band& band) {
  const SplatCamera& camera = source.camera;
  const double inverse = 1.0 / camera.far_m;
  const float radius = camera.radius_px(inverse);
  const int cell = splat_cell_px(radius), margin = static_cast<int>(splat_reach_px(radius)) + 1;
  const int step = std::max(cell / kPointsAcross, 1);
  const int end = std::min(band.top_px + kSplatBandRows, camera.height + margin);
  for (int top = band.top_px; top < end; top += cell) {
    if (top + cell < -margin) continue;
    for (int left = -((margin + cell - 1) / cell) * cell; left < camera.width + margin;
         left += cell) {
      CellSum sum;
      for (int i = 0; i < cell / step * (cell / step); ++i) {
        const double x = left + (i % (cell / step) + 0.5) * step;
        const int line = i / (cell / step);
        const double y = top + (line + 0.5) * step;
        if (is_hidden(source.farthest, camera.radius_per_inverse, x, y, inverse, step)) continue;
        ++sum.points;
        sum.x += x;
        sum.y += y;
      }
      if (sum.points == 0) continue;
      band.splats.push_back({static_cast<float>(sum.x / sum.points),
                             static_cast<float>(sum.y / sum.points), static_cast<float>(inverse),
                             radius, static_cast<float>(sum.points * step * step), surface,
                             colour});
    }
  }
}

}  // namespace

int splat_cell_px(float radius_px) { return 1 << splat_level(radius_px); }

std::vector<Splat> surface_splats(const LensViewInput& input, ThreadPool& pool) {
  const SplatCamera camera = splat_camera(input);
  const std::vector<SeenMesh> meshes = seen_meshes(input);
  const Farthest farthest = farthest_of(input.pinhole);
  const std::vector<SeenTriangle> triangles = seen_triangles(camera, meshes);
  const int margin = margin_of_level(kSplatLevels - 1) / kSplatBandRows + 1;
  const int bands = (camera.height + kSplatBandRows - 1) / kSplatBandRows + 2 * margin;
  std::vector<std::vector<Splat>> found(static_cast<std::size_t>(bands));
  const PointSource source{camera, meshes, farthest, input.profile};
  pool.for_each(bands, [&](int number) {
    Band band = make_band(camera, number - margin);
    for (const SeenTriangle& seen : triangles) {
      if (seen.top_px < band.top_px + kSplatBandRows && seen.bottom_px > band.top_px) {
        add_triangle(source, seen, band);
      }
    }
    add_background(source, static_cast<std::uint32_t>(meshes.size()), input.scene.background, band);
    found[static_cast<std::size_t>(number)] = std::move(band.splats);
  });
  std::vector<Splat> splats;
  std::size_t count = 0;
  for (const auto& some : found) count += some.size();
  splats.reserve(count);
  for (const auto& some : found) splats.insert(splats.end(), some.begin(), some.end());
  return splats;
}

}  // namespace softfocus
