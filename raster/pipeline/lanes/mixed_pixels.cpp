#ifndef SOFTFOCUS_ISA

#include "raster/pipeline/lanes/mixed_pixels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "raster/images/texel.h"

#define SOFTFOCUS_KERNELS "raster/pipeline/lanes/mixed_pixels.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void find_mixed(Isa isa, VisibilityTile& tile) { SOFTFOCUS_KERNEL(isa, find_mixed_in)(tile); }

void find_edge_pixels(Isa isa, VisibilityTile& tile) { SOFTFOCUS_KERNEL(isa, find_edges_in)(tile); }

void store_edges(Isa isa, const VisibilityTile& tile, const EdgeTargets& to, glm::vec4 clear,
                 const Profile& profile) {
  if (tile.mixed.empty()) return;
  Image cleared = make_image(Format::rgba16f, 1, 1);
  store_texel(cleared, 0, 0, clear, profile);
  std::uint64_t texel = 0;
  std::memcpy(&texel, cleared.bytes.data(), sizeof texel);
  SOFTFOCUS_KERNEL(isa, store_edges_of)(tile, to, texel, profile);
}

}  // namespace softfocus

#else  // once a vector unit

#include "raster/pipeline/lanes/block_lanes.inl"

namespace {

// Appends the places of a part's pixels that are in the mask and in the tile's area.
SOFTFOCUS_INLINE void append_mixed(std::uint32_t place, Mask mixed, VisibilityTile& tile) {
  const int width = tile.area.x_end - tile.area.x_begin;
  const int height = tile.area.y_end - tile.area.y_begin;
  const glm::ivec2 first = pixel_of_place(place);
  mixed &= (first.x + lane_x() < width) & (first.y + lane_y() < height);
  for (unsigned rest = lane_bits(mixed); rest != 0; rest &= rest - 1) {
    tile.mixed.push_back(
        static_cast<std::uint16_t>(place + static_cast<unsigned>(std::countr_zero(rest))));
  }
}

}  // namespace

void find_mixed_in(VisibilityTile& tile) {
  tile.mixed.clear();
  for (std::uint32_t place = 0; place < kTilePixels; place += kLanes) {
    std::array<Ints, kMaxSamples> ids;
    ids[0] = load(&tile.front.ids[place]);
    Mask mixed{};
    for (std::size_t s = 1; s < tile.layers; ++s) {
      ids[s] = load(&tile.layer(s).ids[place]);
      mixed |= ~(ids[s] == ids[0]);
    }
    if (!any(mixed)) {
      const Ints as_first = select(ids[0] > 0, splat(-1), Ints{});
      for (std::size_t s = 1; s < tile.layers; ++s) store(&tile.layer(s).ids[place], as_first);
      continue;
    }
    for (std::size_t s = 1; s < tile.layers; ++s) {
      Ints marked = ids[s];
      for (std::size_t r = s; r-- > 0;) {
        const Mask same = (ids[r] == ids[s]) & (ids[s] > 0);
        marked = select(same, splat(-1 - static_cast<std::int32_t>(r)), marked);
      }
      store(&tile.layer(s).ids[place], marked);
    }
    append_mixed(place, mixed, tile);
  }
}

void find_edges_in(VisibilityTile& tile) {
  tile.mixed.clear();
  for (std::uint32_t place = 0; place < kTilePixels; place += kLanes) {
    const Ints centre = load(&tile.front.ids[place]);
    Mask mixed{};
    for (std::size_t s = 0; s < tile.edge_samples; ++s) {
      mixed |= ~(load(&tile.layer(tile.layers + s).ids[place]) == centre);
    }
    if (any(mixed)) append_mixed(place, mixed, tile);
  }
}

namespace {

using Colours = std::array<Floats, 4>;

/// As OtherSurface.
struct OtherLanes {
  Colours texel;
  Ints samples{};
};

// other_surface() of the samples that are `present`, of kLanes pixels.
SOFTFOCUS_INLINE OtherLanes other_lanes(Floats centre_depth,
                                        const std::array<Colours, kMaxSamples>& of,
                                        const std::array<Mask, kMaxSamples>& present,
                                        std::size_t samples) {
  const Floats centre = 1.0f / centre_depth;
  Floats farthest = centre;
  Mask is_one = ~Mask{};
  for (std::size_t s = 0; s < samples; ++s) {
    const Floats inverse = 1.0f / of[s][3];
    const Mask is_farther = present[s] & (absolute(inverse - centre) > absolute(farthest - centre));
    farthest = select(is_farther, inverse, farthest);
    is_one &= ~present[s] |
              ((of[s][3] <= centre_depth * kOneSurface) & (centre_depth <= of[s][3] * kOneSurface));
  }
  const Floats border = 0.5f * (centre + farthest);
  const Mask is_beyond = farthest > centre;
  std::array<Mask, kMaxSamples> is_other;
  for (std::size_t s = 0; s < samples; ++s) {
    const Floats inverse = 1.0f / of[s][3];
    is_other[s] = present[s] &
                  (is_one | (is_beyond & (inverse > border)) | (~is_beyond & (inverse <= border)));
  }
  OtherLanes other;
  other.texel.fill(Floats{});
  Ints most{};
  for (std::size_t s = 0; s < samples; ++s) {
    for (std::size_t k = 0; k < 3; ++k) {
      other.texel[k] = select(is_other[s], other.texel[k] + of[s][k], other.texel[k]);
    }
    other.samples -= is_other[s];
    Ints alike{};
    for (std::size_t r = 0; r < samples; ++r) alike -= is_other[r] & (of[r][3] == of[s][3]);
    const Mask is_first = is_other[s] & (alike > most);
    other.texel[3] = select(is_first, of[s][3], other.texel[3]);
    most = select(is_first, alike, most);
  }
  const Floats share = 1.0f / to_floats(other.samples);
  for (std::size_t k = 0; k < 3; ++k) other.texel[k] *= share;
  return other;
}

using Texels = std::array<std::uint64_t, kLanes>;

SOFTFOCUS_INLINE void to_texels(const std::array<Floats, 4>& colour, HalfRounding rounding,
                                Texels& texels) {
  std::array<Bits, 4> halves;
  for (std::size_t k = 0; k < 4; ++k) {
    switch (rounding) {
      case HalfRounding::nearest_even:
        halves[k] = float_to_half<HalfRounding::nearest_even>(colour[k]);
        break;
      case HalfRounding::toward_zero:
        halves[k] = float_to_half<HalfRounding::toward_zero>(colour[k]);
        break;
      case HalfRounding::swiftshader:
        halves[k] = float_to_half<HalfRounding::swiftshader>(colour[k]);
        break;
    }
  }
  store_half_texels(reinterpret_cast<std::uint16_t*>(texels.data()),
                    {halves[0], halves[1], halves[2], halves[3]});
}

}  // namespace

void store_edges_of(const VisibilityTile& tile, const EdgeTargets& to, std::uint64_t cleared,
                    const Profile& profile) {
  alignas(64) std::array<Texels, kMaxSamples> texels;
  alignas(64) std::array<std::array<std::int32_t, kLanes>, kMaxSamples> present;
  alignas(64) Texels centre, other;
  alignas(64) std::array<std::int32_t, kLanes> counts;
  std::array<Colours, kMaxSamples> colours;
  std::array<Mask, kMaxSamples> masks;
  for (std::size_t begin = 0; begin < tile.mixed.size(); begin += kLanes) {
    const std::size_t lanes = std::min<std::size_t>(kLanes, tile.mixed.size() - begin);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::uint16_t place = tile.mixed[begin + std::min(lane, lanes - 1)];
      std::memcpy(&centre[lane], texel_at(tile.front, pixel_of_place(place)), sizeof centre[lane]);
    }
    for (std::size_t s = 0; s < tile.edge_samples; ++s) {
      const TileLayer& layer = tile.layer(tile.layers + s);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::uint16_t place = tile.mixed[begin + std::min(lane, lanes - 1)];
        const std::int32_t id = layer.ids[place];
        present[s][lane] = id != -1 ? -1 : 0;
        std::uint64_t& texel = texels[s][lane];
        if (id > 0) {
          std::memcpy(&texel, texel_at(layer, pixel_of_place(place)), sizeof texel);
        } else if (id < -1) {
          texel = texels[static_cast<std::size_t>(-2 - id)][lane];
        } else {
          texel = cleared;
        }
      }
      const HalfTexels halves =
          load_half_texels(reinterpret_cast<const std::uint16_t*>(texels[s].data()));
      colours[s] = {half_to_float(halves.r), half_to_float(halves.g), half_to_float(halves.b),
                    half_to_float(halves.a)};
      masks[s] = load(present[s].data()) != 0;
    }
    const HalfTexels halves =
        load_half_texels(reinterpret_cast<const std::uint16_t*>(centre.data()));
    const OtherLanes found =
        other_lanes(half_to_float(halves.a), colours, masks, tile.edge_samples);
    to_texels(found.texel, profile.half_store, other);
    store(counts.data(), found.samples);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (counts[lane] == 0) continue;
      const glm::ivec2 at = pixel_of_place(tile.mixed[begin + lane]);
      const auto x = static_cast<std::size_t>(tile.area.x_begin + at.x);
      const int y = tile.area.y_begin + at.y - to.y_begin;
      std::memcpy(&row<std::uint16_t>(*to.other, y)[4 * x], &other[lane], sizeof other[lane]);
      row<std::uint8_t>(*to.coverage, y)[x] =
          coverage_byte(counts[lane], static_cast<int>(tile.edge_samples));
    }
  }
}

#endif
