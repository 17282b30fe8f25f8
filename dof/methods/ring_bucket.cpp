#include "dof/methods/ring_bucket.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "dof/methods/ring_bucket_tile.h"
#include "dof/picture_planes.h"
#include "raster/numbers/exact_math.h"

#define SOFTFOCUS_KERNELS "dof/methods/ring_bucket_kernels.inl"
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

// The size of a sample that is not spread: it reaches no neighbour.
constexpr float kLeastSize = 0.5f;

// The radius squared that half resolution has by itself.
constexpr float kHalfSquare = 4.0f;

// How much of a pixel half resolution shows.
float half_share(float radius_px) {
  return std::clamp((radius_px * radius_px - 0.25f) * (1.0f / (kHalfSquare - 0.25f)), 0.0f, 1.0f);
}

// 2x2 pixels as one, in rows whose ends repeat for `margin` pixels and a vector.
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
  std::vector<float> largest;            // size inside
  std::vector<std::uint8_t> near_field;  // whether anything inside belongs there

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

// What reaches a tile: K, in quarters of a pixel, and whether any of it is near.
struct Reach {
  int quarters = 0;
  bool near_field = false;
};

// `farthest` is the largest size of all.
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

// Halves go outwards, those too that a cosine's last bit has made smaller: rings are
// symmetric.
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

// The seven planes of results, with a pixel more at either end of a row.
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

// A row of full resolution from rows of half: three quarters of the pixel that it lies in,
// and one of the next one's. `blended` has room for a pixel more at either end.
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
