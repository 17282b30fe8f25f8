#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/level_stack.h"

#include <cstdint>
#include <cstring>

#include "dof/picture_planes.h"

#define SOFTFOCUS_KERNELS "dof/level_stack.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

LevelPlanes take_planes(int count, int width, int height, float* memory, std::size_t& used,
                        RowRoom room) {
  LevelPlanes planes;
  planes.stride = plane_stride(width + room.before + room.after);
  planes.plane = planes.stride * height;
  planes.before = room.before;
  if (memory != nullptr) planes.values = memory + used + room.before;
  used += static_cast<std::size_t>(count * planes.plane);
  return planes;
}

void repeat_ends(const LevelPlanes& planes, int count, int width, int y) {
  for (int i = 0; i < count; ++i) {
    float* row = plane_row(planes, i, y);
    std::fill(row - planes.before, row, row[0]);
    std::fill(row + width, row - planes.before + planes.stride, row[width - 1]);
  }
}

void keep_row(const LevelPlanes& planes, int width, int plane, const LevelRectangle& at, int row,
              const float* from) {
  float* to = plane_row(planes, plane, at.y + row) + at.x;
  std::copy_n(from, at.width, to);
  if (at.x == 0) to[-1] = to[0];
  if (at.x + at.width == width) to[at.width] = to[at.width - 1];
}

void enlarge_seen(const LevelPlanes& seen, int rows, const LevelRectangle& at, bool behind,
                  SeenTile& tile, Isa isa) {
  SOFTFOCUS_KERNEL(isa, enlarge_seen)(seen, rows, at, behind, tile);
}

void store_tile(const DofInput& input, const ImageView& result, const LevelRectangle& at,
                const SeenTile& tile, const LitTile* lit, Isa isa) {
  SOFTFOCUS_KERNEL(isa, store_tile)
  (tile, lit, row<std::uint16_t>(input.scene, at.y).data() + 4 * at.x, input.scene.stride_bytes / 2,
   at.width, at.height, input.profile.half_store,
   row<std::uint16_t>(result, at.y).data() + 4 * at.x, result.stride_bytes / 2);
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/level_lanes.inl"

// Lanes from `from` on, of `a` and then `b`.
template <std::size_t from, std::size_t... lane>
SOFTFOCUS_INLINE Floats lanes_from(Floats a, Floats b, std::index_sequence<lane...>) {
  return __builtin_shufflevector(a, b, (from + lane)...);
}

// Vectors of large pixels that reach into a tile, from kSeenRoom.before on.
inline constexpr int kLargeVectors = (kLevelTileWidth / 2 + 2 * kSeenRoom.before) / kLanes;

// enlarge() of a tile's row from aligned vectors, each made once.
SOFTFOCUS_INLINE void enlarge_tile_row(const float* inside, const float* other,
                                       TwoVectors (&to)[kLevelTileWidth / 2 / kLanes]) {
  using Lanes = std::make_index_sequence<SOFTFOCUS_LANES>;
  constexpr std::size_t kFirst = kSeenRoom.before % kLanes, kSkipped = kSeenRoom.before / kLanes;
  constexpr std::size_t kLeft = (kFirst + kLanes - 1) % kLanes;
  Floats large[kLargeVectors];
  for (std::size_t i = 0; i < kLargeVectors; ++i) {
    large[i] = 0.75f * load(inside + i * kLanes) + 0.25f * load(other + i * kLanes);
  }
  for (std::size_t i = 0; i < kLevelTileWidth / 2 / kLanes; ++i) {
    const Floats* at = large + i + kSkipped;
    const Floats* before = kFirst == 0 ? at - 1 : at;
    const Floats own = 0.75f * lanes_from<kFirst>(at[0], at[1], Lanes{});
    const Floats left = lanes_from<kLeft>(before[0], before[1], Lanes{});
    const Floats right = lanes_from<kFirst + 1>(at[0], at[1], Lanes{});
    to[i] = zip(own + 0.25f * left, own + 0.25f * right);
  }
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE void store_tile_rounded(const SeenTile& tile, const LitTile* lit,
                                         const std::uint16_t* scene, std::ptrdiff_t scene_row,
                                         int width, int height, std::uint16_t* to,
                                         std::ptrdiff_t row) {
  constexpr int kAhead = 4;  // rows
  for (int y = 0; y < height; ++y, scene += scene_row, to += row) {
    if (y + kAhead < height) {
      const std::uint16_t* ahead = scene + kAhead * scene_row;
      for (int x = 0; x < width; x += kTexelsOfLine) __builtin_prefetch(ahead + 4 * x);
    }
    const bool aligned = reinterpret_cast<std::uintptr_t>(to) % sizeof(Bits) == 0;
    for (int x = 0; x < width; x += kLanes) {
      const Floats scale = 1.0f / (1.0f - load(tile.channel[kTransmitted][y] + x));
      Floats colour[3];
      for (int i = 0; i < 3; ++i) {
        colour[i] = load(tile.channel[i][y] + x) * scale;
        if (lit != nullptr) colour[i] += load(lit->light[i][y] + x);
      }
      const HalfTexels texels{float_to_half<rounding>(clamp_to_half(colour[0])),
                              float_to_half<rounding>(clamp_to_half(colour[1])),
                              float_to_half<rounding>(clamp_to_half(colour[2])),
                              stored_depth(load_repeating(scene, x, width).a, rounding)};
      if (x + kLanes <= width) {
        const TexelWords words = interleave(texels);
        aligned ? stream_texel_words(to + 4 * x, words) : store_texel_words(to + 4 * x, words);
      } else {
        std::uint16_t last[4 * kLanes];
        store_half_texels(last, texels);
        std::memcpy(to + 4 * x, last, 4 * sizeof *last * static_cast<std::size_t>(width - x));
      }
    }
  }
  finish_streaming();
}

}  // namespace

void enlarge_seen(const LevelPlanes& seen, int rows, const LevelRectangle& at, bool behind,
                  SeenTile& tile) {
  const int first = at.x / 2 - kSeenRoom.before;
  for (int row = 0; row < at.height; ++row) {
    const int inside = (at.y + row) / 2;
    const int other = (at.y + row) % 2 == 0 ? (inside > 0 ? inside - 1 : 0)
                                            : (inside + 1 < rows ? inside + 1 : rows - 1);
    for (int i = 0; i < kSeenChannels; ++i) {
      // Rows of a tile are too far apart for the CPU to foresee.
      constexpr int kAhead = 3;
      const float* ahead = plane_row(seen, i, inside + kAhead < rows ? inside + kAhead : inside);
      for (int part = 0; row % 2 == 0 && part < kLargeVectors * kLanes; part += 2 * kTexelsOfLine) {
        __builtin_prefetch(ahead + first + part);
      }
      TwoVectors large[kLevelTileWidth / 2 / kLanes];
      enlarge_tile_row(plane_row(seen, i, inside) + first, plane_row(seen, i, other) + first,
                       large);
      float* to = tile.channel[i][row];
      const float* open = tile.channel[kTransmitted][row];
      for (const TwoVectors& part : large) {
        TwoVectors sum = part;
        if (behind) sum = {load(open) * sum.first, load(open + kLanes) * sum.second};
        if (behind && i < kTransmitted) {
          sum = {load(to) + sum.first, load(to + kLanes) + sum.second};
        }
        store(to, sum.first);
        store(to + kLanes, sum.second);
        to += 2 * kLanes;
        open += 2 * kLanes;
      }
    }
  }
}

/// Rows are `scene_row` and `row` halves apart.
void store_tile(const SeenTile& tile, const LitTile* lit, const std::uint16_t* scene,
                std::ptrdiff_t scene_row, int width, int height, HalfRounding rounding,
                std::uint16_t* to, std::ptrdiff_t row) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even:
      return store_tile_rounded<nearest_even>(tile, lit, scene, scene_row, width, height, to, row);
    case toward_zero:
      return store_tile_rounded<toward_zero>(tile, lit, scene, scene_row, width, height, to, row);
    case swiftshader:
      return store_tile_rounded<swiftshader>(tile, lit, scene, scene_row, width, height, to, row);
  }
}

#endif
