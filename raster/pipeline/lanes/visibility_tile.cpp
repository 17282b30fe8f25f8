#include "raster/pipeline/lanes/visibility_tile.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <utility>

#include "raster/pipeline/multisample.h"

namespace softfocus {
namespace {

constexpr std::size_t kColourBytes = bytes_per_texel(Format::rgba16f);

// Calls `visit` with two pixels beside each other at a time, which lie together in a quad, or with
// the last one of an odd row.
template <class Visit>
void for_each_pair(const VisibilityTile& tile, const Visit& visit) {
  const int width = tile.area.x_end - tile.area.x_begin;
  for (int y = 0; y < tile.area.y_end - tile.area.y_begin; ++y) {
    int x = 0;
    for (; x + 2 <= width; x += 2) visit(x, y, place_of_pixel(x, y), std::size_t{2});
    if (x < width) visit(x, y, place_of_pixel(x, y), std::size_t{1});
  }
}

// Texels that were there before, and that nearer triangles have moved back to this layer.
void move_back(const VisibilityTile& tile, std::size_t number) {
  const TileLayer& layer = tile.layer(number);
  for_each_pair(tile, [&](int x, int y, std::size_t place, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t id = layer.ids[place + i];
      if (id >= 0) continue;
      const auto before = static_cast<std::size_t>(-1 - id);
      if (before == number) continue;
      const int column = x + static_cast<int>(i);
      std::memcpy(texel_at(layer, {column, y}), texel_at(tile.layer(before), {column, y}),
                  kColourBytes);
    }
  });
}

// By lines of a cache: compilers write a loop of single stores.
template <class Number>
void fill(std::array<Number, kTilePixels>& of_tile, Number value) {
  std::array<Number, 16> line;
  line.fill(value);
  for (std::size_t i = 0; i < kTilePixels; i += line.size()) {
    std::memcpy(&of_tile[i], line.data(), sizeof line);
  }
}

// The row of a layer's or sample's depths.
std::span<float> depth_row(const RenderTargets& targets, std::size_t layer, int y) {
  if (targets.samples == 1) return row<float>(*layer_target(targets, layer).depth, y);
  return row<float>(*targets.depth, y * targets.samples + static_cast<int>(layer));
}

// No triangle yet: what the layers show is to be cleared, or to be kept.
void show_none(VisibilityTile& tile, bool cleared) {
  for (std::size_t i = 0; i < tile.layers + tile.edge_samples; ++i) {
    const bool keeps = tile.layers > 1 && !tile.has_samples && !cleared;
    fill(tile.layer(i).ids, keeps ? -1 - static_cast<std::int32_t>(i) : 0);
  }
  tile.triangles.clear();
  tile.runs.clear();
}

}  // namespace

void forget_seen(VisibilityTile& tile) { show_none(tile, false); }

void begin_tile(VisibilityTile& tile, const Rectangle& area, const RenderTargets& targets,
                std::optional<float> clear_depth, int edge_samples) {
  tile.area = area;
  tile.has_samples = targets.samples > 1;
  tile.layers = tile.has_samples ? static_cast<std::size_t>(targets.samples) : layer_count(targets);
  tile.edge_samples = static_cast<std::size_t>(edge_samples);
  const std::size_t layers = tile.layers + tile.edge_samples;
  if (layers > tile.behind_room + 1) {
    tile.behind_room = layers - 1;
    tile.behind.reset(new TileLayer[tile.behind_room]);
  }
  for (std::size_t s = 0; s < tile.edge_samples; ++s) {
    fill(tile.layer(tile.layers + s).depth, *clear_depth);
  }
  show_none(tile, clear_depth.has_value());
  for (std::size_t i = 0; i < tile.layers; ++i) {
    TileLayer& layer = tile.layer(i);
    if (clear_depth) {
      fill(layer.depth, *clear_depth);
      continue;
    }
    for_each_pair(tile, [&](int x, int y, std::size_t place, std::size_t count) {
      std::copy_n(depth_row(targets, i, area.y_begin + y).data() + area.x_begin + x, count,
                  &layer.depth[place]);
    });
  }
}

void clear_behind(VisibilityTile& tile, float before, float clear_depth) {
  for (std::size_t number = 1; number < tile.layers; ++number) {
    TileLayer& layer = tile.layer(number);
    for (std::size_t i = 0; i < kTilePixels; ++i) {
      const bool is_kept = tile.front.depth[i] < before;
      layer.ids[i] = is_kept ? layer.ids[i] : 0;
      layer.depth[i] = is_kept ? layer.depth[i] : clear_depth;
    }
  }
}

void end_tile(const VisibilityTile& tile, const RenderTargets& targets) {
  const Rectangle& area = tile.area;
  for (std::size_t i = 0; i < tile.layers; ++i) {
    const float* depths = tile.layer(i).depth.data();
    for_each_pair(tile, [&](int x, int y, std::size_t place, std::size_t count) {
      std::copy_n(depths + place, count,
                  depth_row(targets, i, area.y_begin + y).data() + area.x_begin + x);
    });
  }
}

namespace {

bool share_corner(const LaneTriangle& a, const LaneTriangle& b) {
  const auto [a0, a1, a2] = a.vertices;
  const auto [b0, b1, b2] = b.vertices;
  // Without branches, which nothing would foretell.
  const int same = int{a0 == b0} | int{a0 == b1} | int{a0 == b2} | int{a1 == b0} | int{a1 == b1} |
                   int{a1 == b2} | int{a2 == b0} | int{a2 == b1} | int{a2 == b2};
  return same != 0 && a.front_facing == b.front_facing;
}

// Sorts further quads by run: a counting sort.
void sort_further(VisibilityTile& tile, const std::vector<FurtherQuad>& quads) {
  const auto run_of = [&](const FurtherQuad& quad) {
    return std::upper_bound(tile.runs.begin(), tile.runs.end(), quad.id,
                            [](std::int32_t id, const VisibleRun& run) { return id < run.end_id; });
  };
  for (VisibleRun& run : tile.runs) run.further_end = 0;
  for (const FurtherQuad& quad : quads) ++run_of(quad)->further_end;
  std::size_t begin = 0;
  for (VisibleRun& run : tile.runs) {
    run.further_begin = begin;
    begin += std::exchange(run.further_end, begin);
  }
  tile.further.resize(quads.size());
  for (const FurtherQuad& quad : quads) tile.further[run_of(quad)->further_end++] = quad;
}

const LaneTriangle& triangle_of(const VisibilityTile& tile, std::int32_t id) {
  return *tile.triangles[static_cast<std::size_t>(id - 1)];
}

// Which triangles of a tile share a corner.
class JoinedTriangles {
 public:
  explicit JoinedTriangles(const VisibilityTile& tile) : tile_(tile) {}

  bool are_joined(std::int32_t a, std::int32_t b) {
    if (a == b) return true;
    // Neighbouring pixels mostly ask for the same two.
    Pair& pair = known_[static_cast<std::size_t>(a + 7 * b) % known_.size()];
    if (pair.a != a || pair.b != b) {
      pair = {a, b, share_corner(triangle_of(tile_, a), triangle_of(tile_, b))};
    }
    return pair.is_joined;
  }

 private:
  struct Pair {
    std::int32_t a = 0, b = 0;
    bool is_joined = false;
  };
  const VisibilityTile& tile_;
  std::array<Pair, 256> known_{};
};

// What shades the samples, a bit each, of a pixel that show one surface.
FurtherQuad shaded_surface(std::uint16_t place, std::span<const std::int32_t> ids,
                           unsigned samples) {
  const std::span<const glm::ivec2> places = sample_places(static_cast<int>(ids.size()));
  FurtherQuad quad{0, static_cast<std::uint16_t>(place / kQuadPixels),
                   static_cast<std::uint8_t>(1u << place % kQuadPixels),
                   static_cast<std::uint8_t>(std::countr_zero(samples)), 0};
  int most = 0;
  for (unsigned rest = samples; rest != 0;) {
    const std::int32_t id = ids[static_cast<std::size_t>(std::countr_zero(rest))];
    int count = 0;
    glm::ivec2 sum{};
    for (std::size_t s = 0; s < ids.size(); ++s) {
      if ((rest >> s & 1u) == 0 || ids[s] != id) continue;
      rest &= ~(1u << s);
      sum += places[s];
      ++count;
    }
    if (count <= most) continue;
    most = count;
    quad.id = id;
    quad.shift = packed_pixel(sum.x / count, sum.y / count);
  }
  return quad;
}

}  // namespace

void list_edges(VisibilityTile& tile) {
  JoinedTriangles joined{tile};
  std::vector<FurtherQuad> quads;
  std::size_t kept = 0;
  std::array<std::int32_t, kMaxSamples> all{};
  const std::span ids = std::span{all}.first(tile.edge_samples);
  const auto is_one = [&](std::int32_t a, std::int32_t b) {
    return a == b || (a > 0 && b > 0 && joined.are_joined(a, b));
  };
  for (const std::uint16_t place : tile.mixed) {
    const std::int32_t centre = tile.front.ids[place];
    unsigned rest = 0;
    for (std::size_t s = 0; s < ids.size(); ++s) {
      std::int32_t& id = tile.layer(tile.layers + s).ids[place];
      ids[s] = id;
      if (is_one(centre, id)) {
        id = -1;
      } else {
        rest |= 1u << s;
      }
    }
    if (rest == 0) continue;
    tile.mixed[kept++] = place;
    while (rest != 0) {
      const auto first = static_cast<std::size_t>(std::countr_zero(rest));
      unsigned samples = 0;
      for (std::size_t s = first; s < ids.size(); ++s) {
        if ((rest >> s & 1u) == 0 || !is_one(ids[first], ids[s])) continue;
        samples |= 1u << s;
        if (s > first && ids[first] != 0) {
          tile.layer(tile.layers + s).ids[place] = -2 - static_cast<std::int32_t>(first);
        }
      }
      rest &= ~samples;
      if (ids[first] != 0) quads.push_back(shaded_surface(place, ids, samples));
    }
  }
  tile.mixed.resize(kept);
  sort_further(tile, quads);
}

void list_further(VisibilityTile& tile) {
  std::vector<FurtherQuad> quads;
  for (std::size_t i = 0; i < tile.mixed.size();) {
    // The mixed pixels of a quad follow each other.
    const unsigned number = tile.mixed[i] / unsigned{kQuadPixels};
    unsigned pixels = 0;
    for (; i < tile.mixed.size() && tile.mixed[i] / unsigned{kQuadPixels} == number; ++i) {
      pixels |= 1u << tile.mixed[i] % unsigned{kQuadPixels};
    }
    for (std::size_t s = 1; s < tile.layers; ++s) {
      const std::int32_t* ids = &tile.layer(s).ids[std::size_t{number} * kQuadPixels];
      for (unsigned rest = pixels; rest != 0;) {
        const std::int32_t id = ids[std::countr_zero(rest)];
        unsigned own = 0;
        for (unsigned p = 0; p < kQuadPixels; ++p) {
          if ((rest >> p & 1u) != 0 && ids[p] == id) own |= 1u << p;
        }
        rest &= ~own;
        if (id <= 0) continue;
        quads.push_back({id, static_cast<std::uint16_t>(number), static_cast<std::uint8_t>(own),
                         static_cast<std::uint8_t>(s), 0});
      }
    }
  }
  sort_further(tile, quads);
}

void copy_to_samples(const VisibilityTile& tile) {
  for_each_pair(tile, [&](int x, int y, std::size_t place, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t s = 1; s < tile.layers; ++s) {
        const std::int32_t id = tile.layer(s).ids[place + i];
        if (id >= 0) continue;
        const auto from = static_cast<std::size_t>(-1 - id);
        const int column = x + static_cast<int>(i);
        std::memcpy(texel_at(tile.layer(s), {column, y}), texel_at(tile.layer(from), {column, y}),
                    kColourBytes);
      }
    }
  });
}

void shade_tile(const VisibilityTile& tile) {
  // Of several samples the first layer has what all pixels show.
  for (std::size_t i = tile.has_samples ? 1 : tile.layers; i-- > 0;) {
    if (i > 0) move_back(tile, i);
    for (const VisibleRun& run : tile.runs) {
      run.draw->lane_steps->shade_seen(run.draw->recorded.get(), tile, i, run);
    }
  }
  for (const VisibleRun& run : tile.runs) {
    if (run.further_begin == run.further_end) continue;
    run.draw->lane_steps->shade_seen(run.draw->recorded.get(), tile, kFurther, run);
  }
}

}  // namespace softfocus
