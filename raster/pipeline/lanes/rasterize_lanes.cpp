// Coverage and depth of triangles in a tile, block by block.

#ifndef SOFTFOCUS_ISA

#include "raster/pipeline/lanes/rasterize_lanes.h"

#include <algorithm>
#include <array>
#include <limits>

#include "raster/images/texel.h"
#include "raster/pipeline/multisample.h"

#define SOFTFOCUS_KERNELS "raster/pipeline/lanes/rasterize_lanes.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void rasterize_lanes(Isa isa, const LaneChunk& chunk, std::span<const Bin> bins,
                     const DrawCall& draw, const Profile& profile, VisibilityTile& tile) {
  SOFTFOCUS_KERNEL(isa, rasterize)(chunk, bins, draw, profile, tile);
}

void clear_unseen(Isa isa, const VisibilityTile& tile, std::size_t layers, glm::vec4 value,
                  const Profile& profile) {
  Image row = make_image(Format::rgba16f, kBlockSize, 1);
  clear_image(row, 0, 0, kBlockSize, 1, value, profile);
  for (std::size_t i = 0; i < layers; ++i) {
    SOFTFOCUS_KERNEL(isa, set_unseen)(tile, tile.layer(i), row.bytes.data());
  }
}

}  // namespace softfocus

#else  // once a vector unit

#include "raster/pipeline/lanes/block_lanes.inl"
#include "raster/pipeline/lanes/edge_lanes.inl"

namespace {

SOFTFOCUS_INLINE Mask passes(Compare test, Floats incoming, Floats stored) {
  switch (test) {
    case Compare::never: return Mask{};
    case Compare::less: return incoming < stored;
    case Compare::equal: return incoming == stored;
    case Compare::less_equal: return incoming <= stored;
    case Compare::greater: return incoming > stored;
    case Compare::not_equal: return ~(incoming == stored);
    case Compare::greater_equal: return incoming >= stored;
    case Compare::always: return ~Mask{};
  }
  return Mask{};
}

// clamped_depth() of draw.h, for planes_from_origin and barycentric weights.
SOFTFOCUS_INLINE Floats clamped_depth(Floats depth) {
  return select(depth <= 1.0f, select(depth < 0.0f, splat(0.0f), depth), splat(1.0f));
}

/// How a triangle's depths are found.
enum class DepthForm { barycentric, planes, by_profile };

/// A triangle's depths.
template <DepthForm form>
struct TriangleDepths {
  const Profile& profile;
  Floats z0, z1, z2;
  Floats inverse_area;
  bool needs_no_clamp = false;

  // Depths of a part of a block. Lane 0 is pixel (x, y).
  SOFTFOCUS_INLINE Floats at(int x, int y, Floats e1, Floats e2) const {
    if (form == DepthForm::barycentric ||
        (form == DepthForm::by_profile &&
         profile.attributes == AttributeSetup::exact_barycentric)) {
      return clamped_depth((z0 + (e1 * inverse_area) * z1) + (e2 * inverse_area) * z2);
    }
    const Floats column = to_floats(x + lane_x());
    const Floats line = to_floats(y + lane_y());
    return on_planes(column, line);
  }

  // At a sample, whose edge functions are given. `centre`: of pixel (0, 0), from the planes'
  // origin.
  SOFTFOCUS_INLINE Floats at_sample(int x, int y, Floats e1, Floats e2, const glm::ivec2& place,
                                    float centre) const {
    if (form == DepthForm::barycentric) {
      const Floats depth = (z0 + (e1 * inverse_area) * z1) + (e2 * inverse_area) * z2;
      return needs_no_clamp ? depth : clamped_depth(depth);
    }
    if (form == DepthForm::by_profile && profile.attributes == AttributeSetup::exact_barycentric) {
      return at(x, y, e1, e2);
    }
    const auto from_origin = [&](int from_centre) {
      return centre + static_cast<float>(from_centre) / 256.0f;
    };
    return on_planes(to_floats(x + lane_x()) + from_origin(place.x),
                     to_floats(y + lane_y()) + from_origin(place.y));
  }

 private:
  SOFTFOCUS_INLINE Floats on_planes(Floats column, Floats line) const {
    if (profile.interpolation == Contraction::fused) {
      return clamped_depth(fused_multiply_add(z2, line, fused_multiply_add(z1, column, z0)));
    }
    return clamped_depth(z2 * line + (z1 * column + z0));
  }
};

// Those of the fragments that the stage does not discard.
SOFTFOCUS_INLINE Mask kept(const DrawCall& draw, const LaneTriangle& triangle, int x, int y,
                           Mask fragments) {
  const unsigned bits =
      draw.lane_steps->keep(draw.recorded.get(), triangle, x, y, lane_bits(fragments));
  return (splat(static_cast<std::int32_t>(bits)) >> lane_numbers() & 1) != 0;
}

SOFTFOCUS_INLINE std::size_t first_sample_layer(const VisibilityTile& tile) {
  return tile.has_samples ? 0 : tile.layers;
}

SOFTFOCUS_INLINE std::span<const glm::ivec2> places_of(const VisibilityTile& tile) {
  return sample_places(static_cast<int>(tile.has_samples ? tile.layers : tile.edge_samples));
}

// A writer tests the covered lanes of a part of a block, and keeps the triangle's id where it is
// seen.

/// For a tile of one layer. Scenes are drawn with Compare::less, which has code of its own.
template <bool kLess, bool kDiscards, DepthForm form>
struct DepthWriter {
  static constexpr bool kHasCentre = true, kHasSamples = false;
  const DrawCall& draw;
  const LaneTriangle& triangle;
  VisibilityTile& tile;
  std::int32_t id;
  TriangleDepths<form> depths;

  SOFTFOCUS_INLINE void write(int x, int y, std::size_t at, Mask covered, Floats e1, Floats e2) {
    const Floats depth = depths.at(x, y, e1, e2);
    TileLayer& front = tile.front;
    const Floats stored = load(&front.depth[at]);
    Mask seen = covered & passes(kLess ? Compare::less : draw.depth.test, depth, stored);
    if (kDiscards && draw.lane_steps->keep != nullptr) {
      // The test first: it costs less, and a fragment is discarded whatever the test says.
      if (!any(seen)) return;
      seen = kept(draw, triangle, x, y, seen);
    }
    if (draw.depth.write) store(&front.depth[at], select(seen, depth, stored));
    store(&front.ids[at], select(seen, splat(id), load(&front.ids[at])));
  }
};

/// For the samples of pixels, each with a layer.
template <bool kLess, bool kDiscards, DepthForm form>
struct SampleWriter {
  static constexpr bool kHasCentre = false, kHasSamples = true;
  const DrawCall& draw;
  const LaneTriangle& triangle;
  VisibilityTile& tile;
  std::int32_t id;
  TriangleDepths<form> depths;
  std::size_t first_layer = first_sample_layer(tile);
  float centre = tile.has_samples ? 0.5f : 0.0f;
  std::span<const glm::ivec2> places = places_of(tile);
  Mask keeps{};  ///< of the part, once it is known
  bool knows_kept = false;

  SOFTFOCUS_INLINE void begin_part() { knows_kept = false; }

  SOFTFOCUS_INLINE void write_sample(int x, int y, std::size_t at, Mask covered, Floats e1,
                                     Floats e2, std::size_t sample) {
    const Floats depth = depths.at_sample(x, y, e1, e2, places[sample], centre);
    TileLayer& layer = tile.layer(first_layer + sample);
    const Floats stored = load(&layer.depth[at]);
    Mask seen = covered & passes(kLess ? Compare::less : draw.depth.test, depth, stored);
    if (kDiscards && draw.lane_steps->keep != nullptr) {
      if (!any(seen)) return;
      if (!knows_kept) keeps = kept(draw, triangle, x, y, ~Mask{});
      knows_kept = true;
      seen &= keeps;
    }
    if (draw.depth.write) store(&layer.depth[at], select(seen, depth, stored));
    store(&layer.ids[at], select(seen, splat(id), load(&layer.ids[at])));
  }
};

/// For pixels' centres and the samples of edges.
template <class Centre, class Samples>
struct EdgeWriter {
  static constexpr bool kHasCentre = true, kHasSamples = true;
  Centre of_centre;
  Samples of_samples;

  EdgeWriter(const DrawCall& draw, const LaneTriangle& triangle, VisibilityTile& tile,
             std::int32_t id, const decltype(Centre::depths)& depths)
      : of_centre{draw, triangle, tile, id, depths}, of_samples{draw, triangle, tile, id, depths} {}

  SOFTFOCUS_INLINE void begin_part() { of_samples.begin_part(); }
  SOFTFOCUS_INLINE void write(int x, int y, std::size_t at, Mask covered, Floats e1, Floats e2) {
    of_centre.write(x, y, at, covered, e1, e2);
  }
  SOFTFOCUS_INLINE void write_sample(int x, int y, std::size_t at, Mask covered, Floats e1,
                                     Floats e2, std::size_t sample) {
    of_samples.write_sample(x, y, at, covered, e1, e2, sample);
  }
};

/// For a tile of kLayers: as insert_into_layers(), from the farthest layer to the nearest.
template <std::size_t kLayers>
struct LayerWriter {
  static constexpr bool kHasCentre = true, kHasSamples = false;
  const DrawCall& draw;
  const LaneTriangle& triangle;
  VisibilityTile& tile;
  std::int32_t id;
  TriangleDepths<DepthForm::by_profile> depths;

  SOFTFOCUS_INLINE void write(int x, int y, std::size_t at, Mask covered, Floats e1, Floats e2) {
    const Floats depth = depths.at(x, y, e1, e2);
    Floats stored = load(&tile.layer(kLayers - 1).depth[at]);
    Mask nearer = covered & (depth < stored);
    if (!any(nearer)) return;
    if (draw.lane_steps->keep != nullptr) {
      covered = nearer = kept(draw, triangle, x, y, nearer);
    }
#pragma GCC unroll 3
    for (std::size_t i = kLayers - 1; i > 0; --i) {
      TileLayer& layer = tile.layer(i);
      const TileLayer& before = tile.layer(i - 1);
      const Floats stored_before = load(&before.depth[at]);
      const Mask nearer_than_before = covered & (depth < stored_before);
      store(&layer.depth[at],
            select(nearer_than_before, stored_before, select(nearer, depth, stored)));
      store(&layer.ids[at], select(nearer_than_before, load(&before.ids[at]),
                                   select(nearer, splat(id), load(&layer.ids[at]))));
      stored = stored_before;
      nearer = nearer_than_before;
    }
    if (!any(nearer)) return;
    store(&tile.front.depth[at], select(nearer, depth, stored));
    store(&tile.front.ids[at], select(nearer, splat(id), load(&tile.front.ids[at])));
  }
};

struct BlockRange {
  int x_begin, y_begin, x_end, y_end;  // pixels, multiples of kBlockSize
};

SOFTFOCUS_INLINE BlockRange blocks_of(const LaneTriangle& t, const VisibilityTile& tile) {
  return {std::max<int>(t.bounds[0], tile.area.x_begin) & ~3,
          std::max<int>(t.bounds[1], tile.area.y_begin) & ~3,
          std::min<int>(t.bounds[2], tile.area.x_end), std::min<int>(t.bounds[3], tile.area.y_end)};
}

// The place in the tile of the part of a block that begins with pixel (x, y).
SOFTFOCUS_INLINE std::size_t place_in_tile(const VisibilityTile& tile, int x, int y) {
  return place_of_pixel(x - tile.area.x_begin, y - tile.area.y_begin);
}

/// What samples add to edge functions at a pixel's centre.
template <class Number>
struct SampleSteps {
  std::array<std::array<Number, 3>, kMaxSamples> of_sample;
  std::array<Number, 3> most;
  std::size_t count = 0;
};

// `slopes`: an edge function's differences over 1/256 pixel along x and y.
template <class Writer, class Number, class Slopes>
SOFTFOCUS_INLINE SampleSteps<Number> sample_steps(const VisibilityTile& tile,
                                                  const Slopes& slopes) {
  SampleSteps<Number> steps;
  if constexpr (Writer::kHasSamples) {
    const std::span<const glm::ivec2> places = places_of(tile);
    steps.count = places.size();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::array<Number, 2> slope = slopes(i);
      steps.most[i] = Writer::kHasCentre ? Number{0} : std::numeric_limits<Number>::lowest();
      for (std::size_t s = 0; s < places.size(); ++s) {
        const Number step = static_cast<Number>(places[s].x) * slope[0] +
                            static_cast<Number>(places[s].y) * slope[1];
        steps.of_sample[s][i] = step;
        steps.most[i] = std::max(steps.most[i], step);
      }
    }
  }
  return steps;
}

template <class Writer>
SOFTFOCUS_INLINE void rasterize_small(const LaneTriangle& t, const VisibilityTile& tile,
                                      Writer& writer) {
  BlockRange range = blocks_of(t, tile);
  // Parts of a block that lie before the bounds.
  range.x_begin = std::max<int>(t.bounds[0], tile.area.x_begin) & -kPartColumns;
  range.y_begin = std::max<int>(t.bounds[1], tile.area.y_begin) & -kPartRows;
  const int dx = range.x_begin - t.bounds[0];
  const int dy = range.y_begin - t.bounds[1];
  const Ints steps = ((lane_x() + dx) & 0xFFFF) | (lane_y() + dy) << 16;
  // Edge functions less their thresholds, over the first part of a block in a row; and steps to
  // the next part and row.
  std::array<Ints, 3> row, per_part, per_row;
#pragma GCC unroll 3
  for (std::size_t i = 0; i < 3; ++i) {
    row[i] = (multiply_add_pairs(steps, splat(t.slopes[i])) << 8) +
             (t.edge[i] - std::int32_t{t.thresholds[i]});
    per_part[i] = splat(slope_x(t.slopes[i]) * kPartColumns);
    per_row[i] = splat(slope_y(t.slopes[i]) * kPartRows);
  }
  const Ints threshold1 = splat(std::int32_t{t.thresholds[1]});
  const Ints threshold2 = splat(std::int32_t{t.thresholds[2]});
  const auto steps_of = sample_steps<Writer, std::int32_t>(tile, [&](std::size_t i) {
    return std::array{slope_x(t.slopes[i]) / 256, slope_y(t.slopes[i]) / 256};
  });
  for (int y = range.y_begin; y < range.y_end; y += kPartRows) {
    Ints e0 = row[0], e1 = row[1], e2 = row[2];
    std::size_t place = place_in_tile(tile, range.x_begin, y);
    for (int x = range.x_begin; x < range.x_end; x += kPartColumns) {
      if constexpr (Writer::kHasCentre) {
        const Ints signs = e0 | e1 | e2;
        if (sign_bits(signs) != kAllLaneBits) {
          writer.write(x, y, place, signs >= 0, to_floats(e1 + threshold1),
                       to_floats(e2 + threshold2));
        }
      }
      if constexpr (Writer::kHasSamples) {
        if (sign_bits((e0 + steps_of.most[0]) | (e1 + steps_of.most[1]) |
                      (e2 + steps_of.most[2])) != kAllLaneBits) {
          writer.begin_part();
          for (std::size_t s = 0; s < steps_of.count; ++s) {
            const auto& step = steps_of.of_sample[s];
            const Ints own1 = e1 + step[1], own2 = e2 + step[2];
            const Ints signs = (e0 + step[0]) | own1 | own2;
            writer.write_sample(x, y, place, signs >= 0, to_floats(own1 + threshold1),
                                to_floats(own2 + threshold2), s);
          }
        }
      }
      place = next_part_place(place);
      e0 += per_part[0];
      e1 += per_part[1];
      e2 += per_part[2];
    }
    for (std::size_t i = 0; i < 3; ++i) row[i] += per_row[i];
  }
}

struct Columns {
  int begin, end;
};

// The columns of a row of parts, from the first on, beyond which an edge function is below its
// threshold. `most`: each function less its threshold, at that of the places in the first column
// where it is largest. One column more on each side makes up for rounding.
SOFTFOCUS_INLINE Columns reached_columns(const std::array<double, 3>& most,
                                         const std::array<double, 3>& per_x, int columns) {
  double begin = 0.0, end = columns;
  for (std::size_t i = 0; i < 3; ++i) {
    if (per_x[i] > 0.0) {
      begin = std::max(begin, -most[i] / per_x[i] - 1.0);
    } else if (per_x[i] < 0.0) {
      end = std::min(end, -most[i] / per_x[i] + 2.0);
    } else if (most[i] < 0.0) {
      end = 0.0;
    }
  }
  return {static_cast<int>(std::min(begin, static_cast<double>(columns))) & -kPartColumns,
          static_cast<int>(std::max(end, 0.0))};
}

template <class Writer>
SOFTFOCUS_INLINE void rasterize_wide(const LaneTriangle& t, const VisibilityTile& tile,
                                     Writer& writer) {
  const BlockRange range = blocks_of(t, tile);
  const WideLanes x = widen(lane_x() + (range.x_begin - t.bounds[0]));
  const WideLanes y = widen(lane_y() + (range.y_begin - t.bounds[1]));
  std::array<WideLanes, 3> row, per_part, per_row;
  std::array<Floats, 3> thresholds;
#pragma GCC unroll 3
  for (std::size_t i = 0; i < 3; ++i) {
    const double per_x = t.large->per_x[i], per_y = t.large->per_y[i];
    row[i] = wide_splat(t.large->edge[i]) + (x * wide_splat(per_x) + y * wide_splat(per_y));
    per_part[i] = wide_splat(per_x * kPartColumns);
    per_row[i] = wide_splat(per_y * kPartRows);
    thresholds[i] = splat(static_cast<float>(t.thresholds[i]));
  }
  const auto steps_of = sample_steps<Writer, double>(tile, [&](std::size_t i) {
    return std::array{t.large->per_x[i] / 256.0, t.large->per_y[i] / 256.0};
  });
  for (int top = range.y_begin; top < range.y_end; top += kPartRows) {
    std::array<double, 3> most;
    for (std::size_t i = 0; i < 3; ++i) {
      most[i] = row[i].low[0] + std::max(t.large->per_y[i] * (kPartRows - 1), 0.0) -
                static_cast<double>(t.thresholds[i]);
      if constexpr (Writer::kHasSamples) most[i] += steps_of.most[i];
    }
    const auto [begin, end] = reached_columns(most, t.large->per_x, range.x_end - range.x_begin);
    std::array<WideLanes, 3> e;
    for (std::size_t i = 0; i < 3; ++i) {
      e[i] = row[i] + per_part[i] * wide_splat(begin / kPartColumns);
    }
    for (int left = range.x_begin + begin; left < range.x_begin + end; left += kPartColumns) {
      const std::size_t place = place_in_tile(tile, left, top);
      const auto write = [&](const std::array<WideLanes, 3>& at, const auto& to) {
        const Floats e0 = narrow(at[0]), e1 = narrow(at[1]), e2 = narrow(at[2]);
        const Mask covered = (e0 >= thresholds[0]) & (e1 >= thresholds[1]) & (e2 >= thresholds[2]);
        if (any(covered)) to(covered, e1, e2);
      };
      if constexpr (Writer::kHasCentre) {
        write(e, [&](Mask covered, Floats e1, Floats e2) {
          writer.write(left, top, place, covered, e1, e2);
        });
      }
      if constexpr (Writer::kHasSamples) {
        writer.begin_part();
        for (std::size_t s = 0; s < steps_of.count; ++s) {
          const auto& step = steps_of.of_sample[s];
          write(
              {e[0] + wide_splat(step[0]), e[1] + wide_splat(step[1]), e[2] + wide_splat(step[2])},
              [&](Mask covered, Floats e1, Floats e2) {
                writer.write_sample(left, top, place, covered, e1, e2, s);
              });
        }
      }
#pragma GCC unroll 3
      for (std::size_t i = 0; i < 3; ++i) e[i] = e[i] + per_part[i];
    }
#pragma GCC unroll 3
    for (std::size_t i = 0; i < 3; ++i) row[i] = row[i] + per_row[i];
  }
}

// Exact for any triangle: these are far larger than pictures.
template <class Writer>
void rasterize_huge(const LaneTriangle& t, const VisibilityTile& tile, Writer& writer) {
  const BlockRange range = blocks_of(t, tile);
  const auto& edges = t.large->exact.edges;
  for (int y = range.y_begin; y < range.y_end; y += kBlockSize) {
    for (int x = range.x_begin; x < range.x_end; x += kBlockSize) {
      // An edge function is largest in one corner of the block, samples half a pixel around it
      // included.
      constexpr int kAround = Writer::kHasSamples ? 1 : 0;
      bool outside = false;
      for (std::size_t i = 0; i < 3; ++i) {
        const int corner_x = edges[i].per_x > 0 ? x + kBlockSize - 1 + kAround : x - kAround;
        const int corner_y = edges[i].per_y > 0 ? y + kBlockSize - 1 + kAround : y - kAround;
        outside = outside || edge_at(edges[i], corner_x, corner_y) < t.thresholds[i];
      }
      if (outside) continue;
      for (int part = 0; part < kBlockParts; ++part) {
        const int left = x + part * kPartColumns % kBlockSize;
        const int top = y + part * kPartColumns / kBlockSize * kPartRows;
        const auto write = [&](const glm::ivec2& place, const auto& to) {
          Ints covered = ~Ints{};
          std::array<Floats, 3> e{};
          for (std::size_t i = 0; i < 3; ++i) {
            for (int lane = 0; lane < kLanes; ++lane) {
              const std::int64_t value =
                  edge_at(edges[i], left + lane_x(lane), top + lane_y(lane), place);
              e[i][lane] = static_cast<float>(value);
              if (value < t.thresholds[i]) covered[lane] = 0;
            }
          }
          if (any(covered)) to(covered, e[1], e[2]);
        };
        const std::size_t at = place_in_tile(tile, left, top);
        if constexpr (Writer::kHasCentre) {
          write({}, [&](Mask covered, Floats e1, Floats e2) {
            writer.write(left, top, at, covered, e1, e2);
          });
        }
        if constexpr (Writer::kHasSamples) {
          writer.begin_part();
          const std::span<const glm::ivec2> places = places_of(tile);
          for (std::size_t s = 0; s < places.size(); ++s) {
            write(places[s], [&](Mask covered, Floats e1, Floats e2) {
              writer.write_sample(left, top, at, covered, e1, e2, s);
            });
          }
        }
      }
    }
  }
}

// Whether barycentric depths are from 0 to 1 wherever the triangle covers: its corners' are, by
// more than is rounded.
SOFTFOCUS_INLINE bool lies_between_planes(const LaneTriangle& t) {
  const float a = t.depth[0], b = a + t.depth[1], c = a + t.depth[2];
  constexpr float kMargin = 0x1p-16f;
  return std::min(std::min(a, b), c) > kMargin && std::max(std::max(a, b), c) < 1.0f - kMargin;
}

template <class Writer>
void rasterize_all(const LaneChunk& chunk, std::span<const Bin> bins, const DrawCall& draw,
                   const Profile& profile, VisibilityTile& tile) {
  // Triangles were written long ago, perhaps by another thread.
  constexpr std::size_t kAhead = 6;
  for (std::size_t i = 0; i < std::min(kAhead, bins.size()); ++i) {
    __builtin_prefetch(&chunk.triangles[bins[i].triangle]);
  }
  for (std::size_t i = 0; i < bins.size(); ++i) {
    __builtin_prefetch(&chunk.triangles[bins[std::min(i + kAhead, bins.size() - 1)].triangle]);
    const LaneTriangle& t = chunk.triangles[bins[i].triangle];
    tile.triangles.push_back(&t);
    Writer writer{draw,
                  t,
                  tile,
                  static_cast<std::int32_t>(tile.triangles.size()),
                  {profile, splat(t.depth[0]), splat(t.depth[1]), splat(t.depth[2]),
                   splat(t.inverse_area), lies_between_planes(t)}};
    if (!t.is_large) {
      rasterize_small(t, tile, writer);
    } else if (t.large->fits_doubles) {
      rasterize_wide(t, tile, writer);
    } else {
      rasterize_huge(t, tile, writer);
    }
  }
}

}  // namespace

void rasterize(const LaneChunk& chunk, std::span<const Bin> bins, const DrawCall& draw,
               const Profile& profile, VisibilityTile& tile) {
  using enum DepthForm;
  const bool is_plain = draw.depth.test == Compare::less && draw.lane_steps->keep == nullptr;
  const bool on_planes = profile.attributes == AttributeSetup::planes_from_origin;
  using AnySamples = SampleWriter<false, true, by_profile>;
  using SamplesOnPlanes = SampleWriter<true, false, planes>;
  using BarycentricSamples = SampleWriter<true, false, barycentric>;
  if (tile.has_samples) {
    if (!is_plain) return rasterize_all<AnySamples>(chunk, bins, draw, profile, tile);
    if (on_planes) return rasterize_all<SamplesOnPlanes>(chunk, bins, draw, profile, tile);
    return rasterize_all<BarycentricSamples>(chunk, bins, draw, profile, tile);
  }
  // With edges if the tile has them.
  const auto with = [&]<class Centre, class Samples>(Centre*, Samples*) {
    if (tile.edge_samples > 0) {
      rasterize_all<EdgeWriter<Centre, Samples> >(chunk, bins, draw, profile, tile);
    } else {
      rasterize_all<Centre>(chunk, bins, draw, profile, tile);
    }
  };
  constexpr AnySamples* kAny = nullptr;
  static_assert(kMaxLayers == 4);
  switch (tile.layers) {
    case 2: return with(static_cast<LayerWriter<2>*>(nullptr), kAny);
    case 3: return with(static_cast<LayerWriter<3>*>(nullptr), kAny);
    case 4: return with(static_cast<LayerWriter<4>*>(nullptr), kAny);
    default: break;
  }
  if (!is_plain) return with(static_cast<DepthWriter<false, true, by_profile>*>(nullptr), kAny);
  if (on_planes) {
    return with(static_cast<DepthWriter<true, false, planes>*>(nullptr),
                static_cast<SamplesOnPlanes*>(nullptr));
  }
  with(static_cast<DepthWriter<true, false, barycentric>*>(nullptr),
       static_cast<BarycentricSamples*>(nullptr));
}

// `texels`: a row of a block, four halves a texel.
void set_unseen(const VisibilityTile& tile, const TileLayer& layer, const std::byte* texels) {
  constexpr std::size_t kTexelBytes = 8;
  const int width = tile.area.x_end - tile.area.x_begin;
  const int height = tile.area.y_end - tile.area.y_begin;
  for (std::uint32_t place = 0; place < kTilePixels; place += kLanes) {
    const Ints ids = load(&layer.ids[place]);
    const unsigned unseen = equal_lane_bits(ids, Ints{});
    if (unseen == 0) continue;
    const int left = pixel_of_place(place).x, top = pixel_of_place(place).y;
    if (unseen == kAllLaneBits && left + kPartColumns <= width && top + kPartRows <= height) {
      std::byte* to = layer.texels + static_cast<std::size_t>(top) * layer.stride_bytes +
                      static_cast<std::size_t>(left) * kTexelBytes;
      for (int row = 0; row < kPartRows; ++row, to += layer.stride_bytes) {
        std::memcpy(to, texels, kPartColumns * kTexelBytes);
      }
      continue;
    }
    for (unsigned rest = unseen; rest != 0; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      const int x = left + lane_x(lane), y = top + lane_y(lane);
      if (x >= width || y >= height) continue;
      std::memcpy(layer.texels + static_cast<std::size_t>(y) * layer.stride_bytes +
                      static_cast<std::size_t>(x) * kTexelBytes,
                  texels, kTexelBytes);
    }
  }
}

#endif
