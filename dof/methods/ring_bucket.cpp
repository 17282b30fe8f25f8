#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).
// There is no scalar form: Isa::scalar runs the baseline kernels, which need no vector unit.

#include "dof/methods/ring_bucket.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/numbers/exact_math.h"

namespace softfocus {

// All in half-resolution pixels.
struct BucketTap {
  int dx, dy;
  float distance_px;
};

// A row of a tile and its neighbours.
struct BucketRow {
  // rows[dy] points at the row's first pixel, dy rows away. Planes, `plane` floats apart: red,
  // green, blue, size, 1 / size^2, share in the near field. Every tap lies inside a row.
  const float* const* rows;
  std::ptrdiff_t plane;
  int count;

  const BucketTap* taps;  // from the outermost ring in
  int rings;
  float spacing_px;
  float inverse_density;  // 1 / D
  float gain;
  bool near_field;  // whether any share is more than 0

  // Planes of the background's colour, the near colour and the near opacity.
  float* result;
  std::ptrdiff_t result_plane;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/methods/ring_bucket.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kTileSize = 16;
constexpr int kMostRings = 5;
constexpr int kResults = 7;

// Planes of the half picture, after the colours.
constexpr int kSize = 3;
constexpr int kLight = 4;  // 1 / size^2
constexpr int kShare = 5;
constexpr int kHalfPlanes = 6;

// The size of a sample that reaches no neighbour.
constexpr float kLeastSize = 0.5f;

// The square of the radius by which half resolution itself blurs.
constexpr float kHalfSquare = 4.0f;

// t(r): how much of a pixel half resolution shows.
float half_share(float radius_px) {
  return std::clamp((radius_px * radius_px - 0.25f) * (1.0f / (kHalfSquare - 0.25f)), 0.0f, 1.0f);
}

// A picture of half the size. The ends of its rows repeat for `margin` pixels and a vector.
struct HalfPicture {
  int width, height, margin;
  Planes planes;

  const float* at(int x, int y) const {
    return plane_row(planes, 0, std::clamp(y, 0, height - 1)) + margin + x;
  }
};

void halve_row(const Planes& full, int y, float* to, std::ptrdiff_t plane, int width) {
  const float* rows[] = {plane_row(full, 0, std::min(2 * y, full.height - 1)),
                         plane_row(full, 0, std::min(2 * y + 1, full.height - 1))};
  for (int x = 0; x < width; ++x) {
    const int columns[] = {std::min(2 * x, full.width - 1), std::min(2 * x + 1, full.width - 1)};
    std::array<const float*, 4> texels;
    float nearest = 0.0f;
    for (std::size_t i = 0; i < 4; ++i) {
      texels[i] = rows[i / 2] + columns[i % 2];
      const float radius = texels[i][3 * full.plane];
      nearest = i == 0 || radius < nearest ? radius : nearest;
    }
    // Pairs first, so that a mirrored picture has the same sums.
    std::array<float, 4> sum{};
    for (const std::size_t first : {std::size_t{0}, std::size_t{2}}) {
      std::array<float, 4> pair{};
      for (const std::size_t i : {first, first + 1}) {
        if (texels[i][3 * full.plane] - nearest > 1.0f) continue;
        for (int c = 0; c < 3; ++c) pair[static_cast<std::size_t>(c)] += texels[i][c * full.plane];
        pair[3] += 1.0f;
      }
      for (std::size_t c = 0; c < 4; ++c) sum[c] += pair[c];
    }
    for (int c = 0; c < 3; ++c) to[c * plane + x] = sum[static_cast<std::size_t>(c)] / sum[3];
    const float size =
        std::max(0.5f * std::sqrt(std::max(nearest * nearest - kHalfSquare, 0.0f)), kLeastSize);
    to[kSize * plane + x] = size;
    to[kLight * plane + x] = 1.0f / (size * size);
    to[kShare * plane + x] = nearest < 0.0f ? half_share(nearest) : 0.0f;
  }
}

HalfPicture halve(const Planes& full, int margin, ThreadPool& pool) {
  HalfPicture half{(full.width + 1) / 2, (full.height + 1) / 2, margin, {}};
  const int padded = half.width + 2 * margin + 2 * kTileSize;
  half.planes = make_planes(kHalfPlanes, padded, half.height);
  pool.for_each(half.height, [&](int y) {
    float* first = plane_row(half.planes, 0, y);
    halve_row(full, y, first + margin, half.planes.plane, half.width);
    for (int c = 0; c < kHalfPlanes; ++c, first += half.planes.plane) {
      std::fill_n(first, margin, first[margin]);
      std::fill(first + margin + half.width, first + half.planes.stride,
                first[margin + half.width - 1]);
    }
  });
  return half;
}

struct Tiles {
  int columns, rows;
  std::vector<float> largest;            // size in a tile
  std::vector<std::uint8_t> near_field;  // whether a tile has any of it

  std::size_t at(int column, int row) const {
    return static_cast<std::size_t>(row * columns + column);
  }
};

Tiles make_tiles(const HalfPicture& half, ThreadPool& pool) {
  Tiles tiles{
      (half.width + kTileSize - 1) / kTileSize, (half.height + kTileSize - 1) / kTileSize, {}, {}};
  tiles.largest.assign(tiles.at(0, tiles.rows), 0.0f);
  tiles.near_field.assign(tiles.largest.size(), 0);
  pool.for_each(tiles.rows, [&](int row) {
    for (int y = row * kTileSize; y < std::min((row + 1) * kTileSize, half.height); ++y) {
      const float* size = half.at(0, y) + kSize * half.planes.plane;
      const float* share = half.at(0, y) + kShare * half.planes.plane;
      for (int x = 0; x < half.width; ++x) {
        const std::size_t tile = tiles.at(x / kTileSize, row);
        tiles.largest[tile] = std::max(tiles.largest[tile], size[x]);
        if (share[x] > 0.0f) tiles.near_field[tile] = 1;
      }
    }
  });
  return tiles;
}

// K of a tile, in quarters of a pixel, and whether anything near reaches it.
struct Reach {
  int quarters = 0;
  bool near_field = false;
};

// `farthest` is the largest size in the picture.
Reach reach_of_tile(const Tiles& tiles, int column, int row, float farthest) {
  const int steps = static_cast<int>(farthest) / kTileSize + 1;
  float largest = kLeastSize;
  Reach reach;
  for (int y = std::max(row - steps, 0); y <= std::min(row + steps, tiles.rows - 1); ++y) {
    for (int x = std::max(column - steps, 0); x <= std::min(column + steps, tiles.columns - 1);
         ++x) {
      const int apart = std::max(std::abs(x - column), std::abs(y - row));
      const float size = tiles.largest[tiles.at(x, y)];
      if (size + 0.5f < static_cast<float>((apart - 1) * kTileSize)) continue;
      largest = std::max(largest, size);
      reach.near_field = reach.near_field || tiles.near_field[tiles.at(x, y)] != 0;
    }
  }
  reach.quarters = static_cast<int>(std::ceil(4.0f * largest));
  return reach;
}

struct Rings {
  int count;
  float spacing_px, density, gain;
  std::vector<BucketTap> taps;
};

float covered(const Rings& rings, float radius) {
  float sum = 0.0f;
  for (const BucketTap& tap : rings.taps) {
    sum += std::clamp(radius - tap.distance_px + 0.5f, 0.0f, 1.0f);
  }
  return sum / std::max(radius * radius * rings.density, 1.0f);
}

// Rounds halves outwards, even where a cosine's last bit has made them smaller, so that rings
// are symmetric.
int nearest_pixel(double offset) {
  const int distance = static_cast<int>(std::fabs(offset) + (0.5 + 1e-9));
  return offset < 0.0 ? -distance : distance;
}

Rings make_rings(float reach) {
  Rings rings{};
  rings.count = std::clamp(static_cast<int>(std::ceil(reach)), 1, kMostRings);
  rings.spacing_px = std::max(reach / static_cast<float>(rings.count), 1.0f);
  for (int ring = rings.count; ring >= 0; --ring) {
    const int steps = ring > 0 ? 8 * ring : 1;
    for (int i = 0; i < steps; ++i) {
      const double degrees = 360.0 * i / steps;
      const double radius = static_cast<double>(rings.spacing_px) * ring;
      const int dx = nearest_pixel(radius * exact_math::cos_degrees(degrees));
      const int dy = nearest_pixel(radius * exact_math::sin_degrees(degrees));
      rings.taps.push_back({dx, dy, std::sqrt(static_cast<float>(dx * dx + dy * dy))});
    }
  }
  const float outer = (static_cast<float>(rings.count) + 0.5f) * rings.spacing_px;
  rings.density = static_cast<float>(rings.taps.size()) / (outer * outer);
  float least = 1.0f;
  for (int i = 1; i <= 32; ++i) {
    const float radius = reach * static_cast<float>(i) / 32.0f;
    if (radius >= kLeastSize) least = std::min(least, covered(rings, radius));
  }
  rings.gain = 1.0f / std::max(least, 0.25f);
  return rings;
}

// Planes as BucketRow::result, with one more pixel at either end of a row.
Planes gather(const HalfPicture& half, const Tiles& tiles, float farthest, ThreadPool& pool) {
  Planes results = make_planes(kResults, half.width + 2 + 2 * kTileSize, half.height);
  std::vector<Reach> reaches(tiles.largest.size());
  pool.for_each(tiles.rows, [&](int row) {
    for (int column = 0; column < tiles.columns; ++column) {
      reaches[tiles.at(column, row)] = reach_of_tile(tiles, column, row, farthest);
    }
  });
  std::map<int, Rings> rings_of;
  for (const Reach& reach : reaches) {
    if (!rings_of.contains(reach.quarters)) {
      rings_of.emplace(reach.quarters, make_rings(0.25f * static_cast<float>(reach.quarters)));
    }
  }
  pool.for_each(tiles.rows, [&](int tile_row) {
    std::vector<const float*> rows;
    const int first = tile_row * kTileSize;
    const int height = std::min(kTileSize, half.height - first);
    for (int column = 0; column < tiles.columns; ++column) {
      const int x = column * kTileSize;
      const Reach reach = reaches[tiles.at(column, tile_row)];
      const Rings& rings = rings_of.at(reach.quarters);
      const int margin = reach.quarters / 4 + 2;
      rows.clear();
      for (int y = -margin; y < height + margin; ++y) rows.push_back(half.at(x, first + y));
      for (int y = 0; y < height; ++y) {
        float* to = plane_row(results, 0, first + y) + 1 + x;
        if (reach.quarters <= static_cast<int>(4.0f * kLeastSize)) {
          for (int c = 0; c < 6; ++c) {
            std::copy_n(rows[static_cast<std::size_t>(y + margin)] + c % 3 * half.planes.plane,
                        kTileSize, to + c * results.plane);
          }
          std::copy_n(rows[static_cast<std::size_t>(y + margin)] + kShare * half.planes.plane,
                      kTileSize, to + 6 * results.plane);
          continue;
        }
        const BucketRow row{&rows[static_cast<std::size_t>(y + margin)],
                            half.planes.plane,
                            kTileSize,
                            rings.taps.data(),
                            rings.count,
                            rings.spacing_px,
                            1.0f / rings.density,
                            rings.gain,
                            reach.near_field,
                            to,
                            results.plane};
        SOFTFOCUS_KERNEL(pool.isa(), gather_rings)(row);
      }
    }
    for (int y = first; y < first + height; ++y) {
      for (int c = 0; c < kResults; ++c) {
        float* ends = plane_row(results, c, y);
        ends[0] = ends[1];
        ends[half.width + 1] = ends[half.width];
      }
    }
  });
  return results;
}

// A row of full resolution from two rows of half: three quarters of the row that it lies in
// and a quarter of the next; along x likewise. `blended` has room for a row of half with its
// extra pixels.
void enlarge_row(const Planes& half, int plane, int y, int half_width, int width, float* blended,
                 float* to) {
  const int inside = y / 2;
  const int other = std::clamp(y % 2 == 0 ? inside - 1 : inside + 1, 0, half.height - 1);
  const float* near_row = plane_row(half, plane, inside);
  const float* far_row = plane_row(half, plane, other);
  for (int x = 0; x < half_width + 2; ++x) {
    blended[x] = near_row[x] + 0.25f * (far_row[x] - near_row[x]);
  }
  for (int x = 0; x < width; ++x) {
    const float own = blended[x / 2 + 1];
    to[x] = own + 0.25f * (blended[x / 2 + 1 + (x % 2 == 0 ? -1 : 1)] - own);
  }
}

}  // namespace

void ring_bucket(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const Planes full = split_picture(input, pool);
  const std::vector<float> of_rows = largest_of_rows(full, 3, pool);
  const float farthest =
      std::max(0.5f * *std::max_element(of_rows.begin(), of_rows.end()), kLeastSize);
  const HalfPicture half = halve(full, static_cast<int>(farthest) + 4, pool);
  const Planes gathered = gather(half, make_tiles(half, pool), farthest, pool);

  Planes medians = make_planes(kResults, half.width + 2 + 2 * kTileSize, half.height);
  pool.for_each(half.height, [&](int y) {
    for (int c = 0; c < kResults; ++c) {
      float* to = plane_row(medians, c, y);
      SOFTFOCUS_KERNEL(pool.isa(), median_row)
      (plane_row(gathered, c, std::max(y - 1, 0)) + 1, plane_row(gathered, c, y) + 1,
       plane_row(gathered, c, std::min(y + 1, half.height - 1)) + 1, half.width, to + 1);
      to[0] = to[1];
      to[half.width + 1] = to[half.width];
    }
  });

  pool.for_each(full.height, [&](int y) {
    const auto width = static_cast<std::size_t>(full.stride);
    std::vector<float> rows((kResults + 4) * width);
    float* out = rows.data() + kResults * width;
    for (int c = 0; c < kResults; ++c) {
      enlarge_row(medians, c, y, half.width, full.width, out + 2 * width,
                  rows.data() + static_cast<std::size_t>(c) * width);
    }
    const float* radius = plane_row(full, 3, y);
    const float* opacity = rows.data() + 6 * width;
    for (int c = 0; c < 3; ++c) {
      const float* sharp = plane_row(full, c, y);
      const float* far = rows.data() + static_cast<std::size_t>(c) * width;
      const float* near = far + 3 * width;
      float* to = out + static_cast<std::size_t>(c) * width;
      for (int x = 0; x < full.width; ++x) {
        const float blur =
            radius[x] < 0.0f ? std::clamp(-radius[x] - 2.0f, 0.0f, 1.0f) : half_share(radius[x]);
        const float behind = sharp[x] + blur * (far[x] - sharp[x]);
        to[x] = behind + opacity[x] * (near[x] - behind);
      }
    }
    store_row(input, result, y, out, out + width, out + 2 * width, pool.isa());
  });
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

struct Bucket {
  Floats weight, r, g, b, radius;
};
SOFTFOCUS_INLINE Bucket empty_bucket() {
  const Floats none = splat(0.0f);
  return {none, none, none, none, none};
}

/// The mean of a bucket's quantity; 0 if it is empty.
SOFTFOCUS_INLINE Floats mean(Floats sum, Floats weight) {
  return sum / larger(weight, splat(1e-20f));
}

template <bool near_field>
SOFTFOCUS_INLINE void gather_fields(const BucketRow& row) {
  for (int x = 0; x < row.count; x += kLanes) {
    // Nothing that reaches a near pixel shows what lies behind it; so let all neighbours
    // count a little.
    Floats guess = splat(0.0f);
    if constexpr (near_field) guess = load(row.rows[0] + 5 * row.plane + x) * 1e-3f;
    Bucket previous = empty_bucket(), near = empty_bucket();
    const BucketTap* tap = row.taps;
    for (int ring = row.rings; ring >= 0; --ring) {
      const int count = ring > 0 ? 8 * ring : 1;
      const Floats border = splat((static_cast<float>(ring) + 0.5f) * row.spacing_px);
      Bucket current = empty_bucket();
      Floats hits = splat(0.0f);
      for (int i = 0; i < count; ++i, ++tap) {
        const float* from = row.rows[tap->dy] + tap->dx + x;
        const Floats r = load(from), g = load(from + row.plane), b = load(from + 2 * row.plane);
        const Floats size = load(from + 3 * row.plane);
        const Floats reached = saturate(size - splat(tap->distance_px - 0.5f));
        const Floats light = smaller(load(from + 4 * row.plane) * row.inverse_density, splat(1.0f));
        Floats far_reached = reached, far_weight = reached * light;
        if constexpr (near_field) {
          const Floats share = load(from + 5 * row.plane);
          const Floats near_weight = far_weight * share;
          near.weight = near.weight + near_weight;
          near.r = near.r + r * near_weight;
          near.g = near.g + g * near_weight;
          near.b = near.b + b * near_weight;
          far_weight = (far_weight + guess * light) * (1.0f - share);
          far_reached = reached * (1.0f - share);
        }
        const Mask outer = size > border;
        const Floats to_previous = select(outer, far_weight, splat(0.0f));
        const Floats to_current = far_weight - to_previous;
        previous.weight = previous.weight + to_previous;
        previous.r = previous.r + r * to_previous;
        previous.g = previous.g + g * to_previous;
        previous.b = previous.b + b * to_previous;
        previous.radius = previous.radius + size * to_previous;
        current.weight = current.weight + to_current;
        current.r = current.r + r * to_current;
        current.g = current.g + g * to_current;
        current.b = current.b + b * to_current;
        current.radius = current.radius + size * to_current;
        hits = hits + select(outer, splat(0.0f), far_reached);
      }
      const Floats occlusion =
          saturate(mean(previous.radius, previous.weight) - mean(current.radius, current.weight));
      const Floats opacity = hits / static_cast<float>(count);
      const Floats kept = 1.0f - opacity * occlusion;
      previous = {previous.weight * kept + current.weight, previous.r * kept + current.r,
                  previous.g * kept + current.g, previous.b * kept + current.b,
                  previous.radius * kept + current.radius};
    }
    const Mask any_far = previous.weight > 0.0f;
    const Mask any_near = near.weight > 0.0f;
    float* to = row.result + x;
    const float* own = row.rows[0] + x;
    store(to, select(any_far, mean(previous.r, previous.weight), load(own)));
    store(to + row.result_plane,
          select(any_far, mean(previous.g, previous.weight), load(own + row.plane)));
    store(to + 2 * row.result_plane,
          select(any_far, mean(previous.b, previous.weight), load(own + 2 * row.plane)));
    store(to + 3 * row.result_plane, select(any_near, mean(near.r, near.weight), load(own)));
    store(to + 4 * row.result_plane,
          select(any_near, mean(near.g, near.weight), load(own + row.plane)));
    store(to + 5 * row.result_plane,
          select(any_near, mean(near.b, near.weight), load(own + 2 * row.plane)));
    store(to + 6 * row.result_plane, saturate(near.weight * row.gain));
  }
}

}  // namespace

void gather_rings(const BucketRow& row) {
  row.near_field ? gather_fields<true>(row) : gather_fields<false>(row);
}

namespace {

SOFTFOCUS_INLINE void sort(Floats& a, Floats& b) {
  const Floats least = smaller(a, b);
  b = larger(a, b);
  a = least;
}
SOFTFOCUS_INLINE void sort(Floats& a, Floats& b, Floats& c) {
  sort(b, c);
  sort(a, b);
  sort(b, c);
}
SOFTFOCUS_INLINE Floats middle(Floats a, Floats b, Floats c) {
  sort(a, b, c);
  return b;
}

}  // namespace

/// Medians of 3x3 about `count` pixels of the row `here`.
void median_row(const float* above, const float* here, const float* below, int count, float* to) {
  for (int x = 0; x < count; x += kLanes) {
    Floats least[3], mid[3], most[3];
    for (int i = 0; i < 3; ++i) {
      least[i] = load(above + x + i - 1);
      mid[i] = load(here + x + i - 1);
      most[i] = load(below + x + i - 1);
      sort(least[i], mid[i], most[i]);
    }
    // The median of nine is the median of three: the largest of the columns' least, the middle
    // of their middle ones and the least of their largest.
    store(to + x,
          middle(larger(larger(least[0], least[1]), least[2]), middle(mid[0], mid[1], mid[2]),
                 smaller(smaller(most[0], most[1]), most[2])));
  }
}

#endif
