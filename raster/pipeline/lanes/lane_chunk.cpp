#include "raster/pipeline/lanes/lane_chunk.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "raster/numbers/fixed_point.h"
#include "raster/pipeline/planes.h"

namespace softfocus {
namespace {

struct TileRange {
  int x_first, y_first, x_last, y_last;
};

// Bounds lie in the target: shifts divide them.
TileRange tiles_of(const LaneTriangle& t) {
  constexpr int kTileBits = 6;
  static_assert(1 << kTileBits == kTileSize);
  return {t.bounds[0] >> kTileBits, t.bounds[1] >> kTileBits, (t.bounds[2] - 1) >> kTileBits,
          (t.bounds[3] - 1) >> kTileBits};
}

template <class Visit>
void for_each_tile(const TileRange& tiles, const Visit& visit) {
  for (int y = tiles.y_first; y <= tiles.y_last; ++y) {
    for (int x = tiles.x_first; x <= tiles.x_last; ++x) visit(x, y);
  }
}

bool extends_to(const EdgeFunctions& functions, std::int64_t extent) {
  const std::int64_t largest = extent * kSubpixelOne;
  return std::all_of(functions.edges.begin(), functions.edges.end(), [&](const EdgeFunction& edge) {
    return std::abs(edge.per_x) <= largest && std::abs(edge.per_y) <= largest;
  });
}

LargeEdges large_edges(const EdgeFunctions& functions, int x_origin, int y_origin) {
  LargeEdges large{functions, {}, {}, {}, extends_to(functions, kWideExtent)};
  for (std::size_t i = 0; i < 3; ++i) {
    const EdgeFunction& edge = functions.edges[i];
    large.edge[i] = static_cast<double>(edge_at(edge, x_origin, y_origin));
    large.per_x[i] = static_cast<double>(edge.per_x);
    large.per_y[i] = static_cast<double>(edge.per_y);
  }
  return large;
}

std::array<float, 3> depth_fields(const TriangleSetup& setup, std::size_t provoking,
                                  const Profile& profile) {
  const auto& v = setup.vertices;
  if (profile.attributes == AttributeSetup::planes_from_origin) {
    const Plane plane =
        PlanesFromOrigin{setup, provoking, profile}.plane({v[0].depth, v[1].depth, v[2].depth});
    return {plane.at_origin, plane.per_x, plane.per_y};
  }
  return {v[0].depth, v[1].depth - v[0].depth, v[2].depth - v[0].depth};
}

}  // namespace

void clear(LaneChunk& chunk) {
  chunk.triangle_count = 0;
  chunk.bins.clear();
  chunk.tiles.clear();
  chunk.new_vertices.clear();
  chunk.large.clear();
}

void enlarge(LaneChunk& chunk) {
  const std::uint32_t room = chunk.triangle_room + kChunkTriangles;
  std::unique_ptr<LaneTriangle[]> triangles{new LaneTriangle[room]};  // not zeroed
  std::copy_n(chunk.triangles.get(), chunk.triangle_count, triangles.get());
  chunk.triangles = std::move(triangles);
  chunk.triangle_room = room;
}

LaneTriangle& add_set_up_triangle(LaneChunk& chunk, const TriangleSetup& setup,
                                  std::size_t provoking, const Profile& profile) {
  const auto& functions = std::get<EdgeFunctions>(setup.coverage);
  LaneTriangle t{};
  t.origin = packed_pixel(setup.bounds.x_begin, setup.bounds.y_begin);
  if (!extends_to(functions, kSmallExtent)) {
    t.large = &chunk.large.emplace_back(
        large_edges(functions, setup.bounds.x_begin, setup.bounds.y_begin));
    t.is_large = true;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const EdgeFunction& edge = functions.edges[i];
    t.thresholds[i] = edge.owns_centres ? 0 : 1;
    if (t.large != nullptr) continue;
    t.edge[i] =
        static_cast<std::int32_t>(edge_at(edge, setup.bounds.x_begin, setup.bounds.y_begin));
    t.slopes[i] =
        packed_slopes(static_cast<std::int32_t>(edge.per_x), static_cast<std::int32_t>(edge.per_y));
  }
  t.inverse_area = 1.0f / static_cast<float>(functions.area);
  t.depth = depth_fields(setup, provoking, profile);
  t.bounds = {static_cast<std::int16_t>(setup.bounds.x_begin),
              static_cast<std::int16_t>(setup.bounds.y_begin),
              static_cast<std::int16_t>(setup.bounds.x_end),
              static_cast<std::int16_t>(setup.bounds.y_end)};
  t.clockwise = setup.clockwise;
  t.front_facing = setup.front_facing;
  return next_triangle(chunk) = t;
}

void bin_triangles(LaneChunk& chunk, int tiles_x) {
  if (chunk.triangle_count == 0) return;
  const auto triangles = std::span{chunk.triangles.get(), chunk.triangle_count};
  TileRange all = tiles_of(triangles.front());
  for (const LaneTriangle& t : triangles) {
    const TileRange tiles = tiles_of(t);
    all = {std::min(all.x_first, tiles.x_first), std::min(all.y_first, tiles.y_first),
           std::max(all.x_last, tiles.x_last), std::max(all.y_last, tiles.y_last)};
  }
  // A counting sort, which keeps a tile's triangles in order.
  const int columns = all.x_last - all.x_first + 1;
  const auto place = [&](int x, int y) {
    return static_cast<std::size_t>((y - all.y_first) * columns + (x - all.x_first));
  };
  std::vector<std::uint32_t> next(
      static_cast<std::size_t>(columns * (all.y_last - all.y_first + 1)));
  std::uint32_t total = 0;
  for (const LaneTriangle& t : triangles) {
    for_each_tile(tiles_of(t), [&](int x, int y) {
      ++next[place(x, y)];
      ++total;
    });
  }
  std::uint32_t begin = 0;
  for (int y = all.y_first; y <= all.y_last; ++y) {
    for (int x = all.x_first; x <= all.x_last; ++x) {
      const std::uint32_t count = std::exchange(next[place(x, y)], begin);
      if (count == 0) continue;
      chunk.tiles.push_back({static_cast<std::uint32_t>(y * tiles_x + x), begin, begin + count});
      begin += count;
    }
  }
  chunk.bins.resize(total);
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for_each_tile(tiles_of(triangles[i]), [&](int x, int y) {
      chunk.bins[next[place(x, y)]++] = {static_cast<std::uint32_t>(y * tiles_x + x), i};
    });
  }
}

}  // namespace softfocus
