#include "dof/auto/scene_traits.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "dof/auto/cell_means.h"
#include "dof/auto/depth_range.h"
#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/numbers/random_bits.h"

namespace softfocus {
namespace {

constexpr int kPointsAcross = 40;
constexpr std::array kRingsPx{1, 2, 4, 8, 16, 32, 64};
// sqrt(1/2) D, rounded: taps on the diagonals.
constexpr std::array kDiagonalsPx{1, 1, 3, 6, 11, 23, 45};
// Rings from here on see the means of cells, nearer ones those of as many pixels as their radius
// has, made on the spot.
constexpr std::size_t kFirstRingOfCells = 3;
constexpr float kHalfAPixel = 0.5f;
constexpr float kSquareRootOfPi = 1.7724539f;
constexpr float kGhostsSeenPx = 3.0f;  // ghosts so far apart are seen in full

using Colour = std::array<float, 3>;

/// The radii that circles are cut to, and last no cut; padded, so that one operation on
/// all of them is a vector's.
constexpr std::size_t kCuts = kFilterRadiiPx.size() + 1;
constexpr std::size_t kUncut = kCuts - 1;
using ByCut = std::array<float, 8>;
static_assert(kCuts <= std::tuple_size_v<ByCut>);

struct Point {
  Colour colour;
  float radius_px;  // signed
};

struct Tap {
  Colour colour;
  std::size_t ring;
  float weight;  // W without a cut
  float reach_px;
  float near_edge;  // |C_q - C_p| across an edge whose nearer side is blurred before the focus
  float far_edge;   // across any other edge
};

// Light as an eye sees it, about, on a screen that shows 0 to 1.
float seen(float light) { return std::sqrt(light < 1.0f ? light : 1.0f); }

float seen_difference(const Colour& a, const Colour& b) {
  return std::max({std::fabs(seen(a[0]) - seen(b[0])), std::fabs(seen(a[1]) - seen(b[1])),
                   std::fabs(seen(a[2]) - seen(b[2]))});
}

float difference(const Colour& a, const Colour& b) {
  return std::max({std::fabs(a[0] - b[0]), std::fabs(a[1] - b[1]), std::fabs(a[2] - b[2])});
}

float brightest(const Colour& colour) { return std::max({colour[0], colour[1], colour[2]}); }

// How far off a light is seen if it is off by `error`, up or down.
float seen_error(float light, float error) {
  const float here = seen(light);
  return std::max(seen(light + error) - here, here - seen(std::max(light - error, 0.0f)));
}

// d^(3/4)
float felt(float difference) {
  const float root = std::sqrt(difference);
  return root * std::sqrt(root);
}

// The part of a ring within a reach, 0 to 1.
float within(float reach_px, float distance_px) {
  const float part = reach_px - 0.75f * distance_px + 0.5f;
  return part > 0.0f && reach_px >= kHalfAPixel ? (part < 1.0f ? part : 1.0f) : 0.0f;
}

float ring_area(float distance_px) { return 0.75f * distance_px * distance_px; }

/// By ring: its area as far as a cut lets it in. within() grows with the reach, so that W of a
/// cut reach is the lesser of the reach's and of this.
using CutAreas = std::array<ByCut, kRingsPx.size()>;

CutAreas cut_areas() {
  CutAreas areas{};
  for (std::size_t ring = 0; ring < kRingsPx.size(); ++ring) {
    const auto distance_px = static_cast<float>(kRingsPx[ring]);
    for (std::size_t cut = 0; cut < kCuts; ++cut) {
      const float part = cut == kUncut ? 1.0f : within(kFilterRadiiPx[cut], distance_px);
      areas[ring][cut] = part * ring_area(distance_px);
    }
  }
  return areas;
}

struct Sight {
  const ConstImageView& picture;
  const PixelCoc& coc;
  const CellMeans& cells;
  std::size_t rings;  // that any circle of the picture reaches
  CutAreas cut_areas;
};

Point point_of(const Sight& sight, const std::uint16_t* texel) {
  return {{trait_light(half_to_float(texel[0])), trait_light(half_to_float(texel[1])),
           trait_light(half_to_float(texel[2]))},
          signed_trait_radius(sight.coc, half_to_float(texel[3]))};
}

const std::uint16_t* texel_at(const Sight& sight, int x, int y) {
  x = std::clamp(x, 0, sight.picture.width - 1);
  y = std::clamp(y, 0, sight.picture.height - 1);
  return row<std::uint16_t>(sight.picture, y).data() + 4 * x;
}

Point mean_of_square(const Sight& sight, int left, int top, int size) {
  Point sum{};
  for (int y = top; y < top + size; ++y) {
    for (int x = left; x < left + size; ++x) {
      const Point one = point_of(sight, texel_at(sight, x, y));
      for (std::size_t i = 0; i < 3; ++i) sum.colour[i] += one.colour[i];
      sum.radius_px += one.radius_px;
    }
  }
  const float scale = 1.0f / static_cast<float>(size * size);
  for (float& channel : sum.colour) channel *= scale;
  sum.radius_px *= scale;
  return sum;
}

struct Taps {
  std::array<Tap, 4 * kRingsPx.size()> all;
  std::size_t count = 0;
};

// Appends the tap if it can matter to anything.
void add_tap(const Point& p, const Point& q, std::size_t ring, Taps& taps) {
  const auto distance_px = static_cast<float>(kRingsPx[ring]);
  const float radius_px = q.radius_px;
  const float here = std::fabs(p.radius_px), there = std::fabs(radius_px);
  const bool edge = std::fabs(radius_px - p.radius_px) > 1.0f + 0.25f * distance_px;
  const bool before = radius_px < p.radius_px;
  const float reach_px = edge && before               ? there
                         : edge && p.radius_px < 0.0f ? here
                                                      : std::min(here, there);
  const float part = within(reach_px, distance_px);
  if (part == 0.0f) return;
  Tap& tap = taps.all[taps.count++];
  tap.colour = q.colour;
  tap.ring = ring;
  tap.weight = part * ring_area(distance_px);
  tap.reach_px = reach_px;
  const bool near = edge && (before ? radius_px : p.radius_px) < -kHalfAPixel;
  const float step = edge ? difference(tap.colour, p.colour) : 0.0f;
  tap.near_edge = near ? step : 0.0f;
  tap.far_edge = near ? 0.0f : step;
}

/// Places of a point and its taps: texels, and cells for the wide rings. Fetched one point ahead:
/// they lie far apart, and most of the time goes into waiting for them.
struct Places {
  const std::uint16_t* centre;
  /// Corners of the squares of pixels whose means are the taps near by, and the texel there.
  std::array<std::array<int, 2>, 4 * kFirstRingOfCells> corners;
  std::array<const std::uint16_t*, 4 * kFirstRingOfCells> texels;
  std::array<const CellMean*, 4 * (kRingsPx.size() - kFirstRingOfCells)> cells;
};

const CellMean* cell_at(const Sight& sight, int x, int y) {
  const int column = std::clamp(x, 0, sight.picture.width - 1) / kCellPx;
  const int row = std::clamp(y, 0, sight.picture.height - 1) / kCellPx;
  return &sight.cells.cells[static_cast<std::size_t>(row * sight.cells.columns + column)];
}

Places places_around(const Sight& sight, int x, int y, std::uint32_t hash) {
  Places places{texel_at(sight, x, y), {}, {}, {}};
  __builtin_prefetch(places.centre);
  for (std::size_t ring = 0; ring < sight.rings; ++ring) {
    const bool axes = (hash >> ring & 1u) != 0;
    const int dx = axes ? kRingsPx[ring] : kDiagonalsPx[ring];
    const int dy = axes ? 0 : kDiagonalsPx[ring];
    const std::array<std::array<int, 2>, 4> steps{{{dx, dy}, {-dy, dx}, {-dx, -dy}, {dy, -dx}}};
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const int to_x = x + steps[i][0], to_y = y + steps[i][1];
      if (ring < kFirstRingOfCells) {
        const int half = kRingsPx[ring] / 2;
        places.corners[4 * ring + i] = {to_x - half, to_y - half};
        places.texels[4 * ring + i] = texel_at(sight, to_x - half, to_y - half);
        __builtin_prefetch(places.texels[4 * ring + i]);
      } else {
        places.cells[4 * (ring - kFirstRingOfCells) + i] = cell_at(sight, to_x, to_y);
      }
    }
  }
  return places;
}

Point tap_at(const Sight& sight, const Places& places, std::size_t tap) {
  if (tap < 4) return point_of(sight, places.texels[tap]);
  if (tap < 4 * kFirstRingOfCells) {
    const auto [x, y] = places.corners[tap];
    return mean_of_square(sight, x, y, kRingsPx[tap / 4]);
  }
  const CellMean& cell = *places.cells[tap - 4 * kFirstRingOfCells];
  return {cell.colour, cell.radius_px};
}

/// A point through a lens, for each cut.
struct LensSums {
  ByCut red{}, green{}, blue{}, weights{}, near_edges{}, far_edges{};
};

LensSums lens_sums(const Sight& sight, const Point& p, std::span<const Tap> taps) {
  LensSums sums;
  sums.red.fill(p.colour[0]);
  sums.green.fill(p.colour[1]);
  sums.blue.fill(p.colour[2]);
  sums.weights.fill(1.0f);
  for (const Tap& tap : taps) {
    const ByCut& area = sight.cut_areas[tap.ring];
    for (std::size_t cut = 0; cut < area.size(); ++cut) {
      const float weight = tap.weight < area[cut] ? tap.weight : area[cut];
      sums.red[cut] += weight * tap.colour[0];
      sums.green[cut] += weight * tap.colour[1];
      sums.blue[cut] += weight * tap.colour[2];
      sums.weights[cut] += weight;
      sums.near_edges[cut] += weight * tap.near_edge;
      sums.far_edges[cut] += weight * tap.far_edge;
    }
  }
  return sums;
}

Colour mean_of(const LensSums& sums, std::size_t cut) {
  const float weight = sums.weights[cut];
  return {sums.red[cut] / weight, sums.green[cut] / weight, sums.blue[cut] / weight};
}

// Sums of what SceneTraits has means of.
struct Sums {
  double blurred_share = 0.0, blur = 0.0;
  std::array<double, kFilterRadiiPx.size()> lost{}, blurred{}, near_edges{}, far_edges{};
  std::array<double, kSampleCounts.size()> ghosts{};

  void add(const Sums& other) {
    blurred_share += other.blurred_share;
    blur += other.blur;
    for (std::size_t i = 0; i < lost.size(); ++i) {
      lost[i] += other.lost[i];
      blurred[i] += other.blurred[i];
      near_edges[i] += other.near_edges[i];
      far_edges[i] += other.far_edges[i];
    }
    for (std::size_t i = 0; i < ghosts.size(); ++i) ghosts[i] += other.ghosts[i];
  }
};

void add_ghosts(const Point& p, std::span<const Tap> taps, const Colour& mean, Sums& sums) {
  float largest_px = std::fabs(p.radius_px);
  float squares = difference(p.colour, mean) * difference(p.colour, mean);
  float weights = 1.0f;
  for (const Tap& tap : taps) {
    const float off = difference(tap.colour, mean);
    squares += tap.weight * off * off;
    weights += tap.weight;
    largest_px = std::max(largest_px, tap.reach_px);
  }
  const float spread = std::sqrt(squares / weights);
  const float light = brightest(mean);
  for (std::size_t i = 0; i < kSampleCounts.size(); ++i) {
    const float root = std::sqrt(static_cast<float>(kSampleCounts[i]));
    const float apart_px = largest_px * kSquareRootOfPi / root;
    const float error = spread / root * std::min(apart_px / kGhostsSeenPx, 1.0f);
    sums.ghosts[i] += static_cast<double>(seen_error(light, error));
  }
}

void add_point(const Sight& sight, const Places& places, Sums& sums) {
  const Point p = point_of(sight, places.centre);
  if (std::fabs(p.radius_px) >= kHalfAPixel) sums.blurred_share += 1.0;
  Taps found;
  for (std::size_t i = 0; i < 4 * sight.rings; ++i) {
    add_tap(p, tap_at(sight, places, i), i / 4, found);
  }
  if (found.count == 0) return;  // nothing comes here: every sum would grow by 0
  const std::span taps{found.all.data(), found.count};
  const LensSums lens = lens_sums(sight, p, taps);
  const Colour mean = mean_of(lens, kUncut);
  sums.blur += static_cast<double>(felt(seen_difference(mean, p.colour)));
  for (std::size_t i = 0; i < kFilterRadiiPx.size(); ++i) {
    const Colour cut = mean_of(lens, i);
    const float light = brightest(cut);
    const float near = lens.near_edges[i] / lens.weights[i];
    const float far = lens.far_edges[i] / lens.weights[i];
    sums.lost[i] += static_cast<double>(felt(seen_difference(cut, mean)));
    sums.blurred[i] += static_cast<double>(felt(seen_difference(cut, p.colour)));
    sums.near_edges[i] += static_cast<double>(felt(seen_error(light, near)));
    sums.far_edges[i] += static_cast<double>(felt(seen_error(light, far)));
  }
  add_ghosts(p, taps, mean, sums);
}

// Places of the point that stands for a cell of the grid. The hash's upper bytes tell where in the
// cell, in 256ths, its lowest bits how the taps lie.
Places places_of_point(const Sight& sight, int column, int row, int columns, int rows) {
  const std::uint32_t hash = hash_of_place(column, row);
  const int right = static_cast<int>(hash >> 24), down = static_cast<int>(hash >> 16 & 0xFFu);
  return places_around(sight, (column * 256 + right) * sight.picture.width / (columns * 256),
                       (row * 256 + down) * sight.picture.height / (rows * 256), hash);
}

// Rings of which something lies within a circle.
std::size_t rings_within(float radius_px) {
  std::size_t rings = 0;
  while (rings < kRingsPx.size() && within(radius_px, static_cast<float>(kRingsPx[rings])) > 0.0f) {
    ++rings;
  }
  return rings;
}

}  // namespace

float largest_px(const SceneTraits& traits) {
  return std::max(std::fabs(traits.nearest_px), std::fabs(traits.farthest_px));
}

SceneTraits scene_traits(const ConstImageView& pinhole, const PixelCoc& coc, ThreadPool& pool) {
  SceneTraits traits{.width = pinhole.width, .height = pinhole.height};
  // The radius grows with depth, so its ends are those of depth.
  const DepthRange depths = depth_range(pinhole, pool);
  traits.nearest_px = signed_trait_radius(coc, half_to_float(depths.least));
  traits.farthest_px = signed_trait_radius(coc, half_to_float(depths.most));
  if (largest_px(traits) < kHalfAPixel) return traits;

  const int columns = std::min(kPointsAcross, pinhole.width);
  const int rows = std::min(kPointsAcross, pinhole.height);
  const CellMeans cells = cell_means(pinhole, coc, pool);
  const Sight sight{pinhole, coc, cells, rings_within(largest_px(traits)), cut_areas()};
  std::vector<Sums> of_rows(static_cast<std::size_t>(rows));
  pool.for_each(rows, [&](int j) {
    Sums& sums = of_rows[static_cast<std::size_t>(j)];
    Places places = places_of_point(sight, 0, j, columns, rows);
    for (int i = 0; i < columns; ++i) {
      const Places next = places_of_point(sight, std::min(i + 1, columns - 1), j, columns, rows);
      add_point(sight, places, sums);
      places = next;
    }
  });
  Sums sums;
  for (const Sums& of_row : of_rows) sums.add(of_row);
  const auto mean = [points = static_cast<double>(columns) * rows](double sum) {
    return static_cast<float>(sum / points);
  };
  for (const CellMean& cell : cells.cells) {
    traits.brightest = std::max(traits.brightest, cell.brightest);
  }
  traits.blurred_share = mean(sums.blurred_share);
  traits.blur = mean(sums.blur);
  for (std::size_t i = 0; i < kFilterRadiiPx.size(); ++i) {
    traits.by_radius[i] = {mean(sums.lost[i]), mean(sums.blurred[i]), mean(sums.near_edges[i]),
                           mean(sums.far_edges[i])};
  }
  for (std::size_t i = 0; i < kSampleCounts.size(); ++i) traits.ghosts[i] = mean(sums.ghosts[i]);
  return traits;
}

}  // namespace softfocus
