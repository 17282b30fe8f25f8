#ifndef SOFTFOCUS_ISA

#include "raster/pipeline/lanes/resolve_lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "raster/images/texel.h"

#define SOFTFOCUS_KERNELS "raster/pipeline/lanes/resolve_lanes.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

void find_mixed(Isa isa, VisibilityTile& tile, bool marks_all) {
  SOFTFOCUS_KERNEL(isa, find_mixed_in)(tile, marks_all);
}

void resolve_surfaces(Isa isa, VisibilityTile& tile, const SurfaceTargets& to, glm::vec4 clear,
                      const Profile& profile) {
  Rectangle area = tile.area;  // of the images
  area.y_begin -= to.y_begin;
  area.y_end -= to.y_begin;
  for (int y = area.y_begin; y < area.y_end; ++y) {
    std::memset(row<std::uint8_t>(*to.coverage, y).data() + area.x_begin, 0,
                static_cast<std::size_t>(area.x_end - area.x_begin));
  }
  if (!tile.mixed.empty()) {
    Image cleared = make_image(Format::rgba16f, 1, 1);
    store_texel(cleared, 0, 0, clear, profile);
    std::uint64_t texel = 0;
    std::memcpy(&texel, cleared.bytes.data(), sizeof texel);
    SOFTFOCUS_KERNEL(isa, resolve_mixed)(tile, to, texel, profile);
  }
  if (to.depth == nullptr) return;
  for (int y = area.y_begin; y < area.y_end; ++y) {
    float* depths = row<float>(*to.depth, y).data() + area.x_begin;
    for (int x = 0; x < area.x_end - area.x_begin; ++x) {
      depths[x] = tile.front.depth[place_of_pixel(x, y - area.y_begin)];
    }
  }
}

}  // namespace softfocus

#else  // once a vector unit

#include "raster/pipeline/lanes/block_lanes.inl"

void find_mixed_in(VisibilityTile& tile, bool marks_all) {
  tile.mixed.clear();
  const int width = tile.area.x_end - tile.area.x_begin;
  const int height = tile.area.y_end - tile.area.y_begin;
  for (std::uint32_t place = 0; place < kTilePixels; place += kLanes) {
    std::array<Ints, kMaxSamples> ids;
    ids[0] = load(&tile.front.ids[place]);
    Mask mixed{};
    for (std::size_t s = 1; s < tile.layers; ++s) {
      ids[s] = load(&tile.layer(s).ids[place]);
      mixed |= ~(ids[s] == ids[0]);
    }
    if (!any(mixed)) {
      if (!marks_all) continue;
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
    const glm::ivec2 first = pixel_of_place(place);
    mixed &= (first.x + lane_x() < width) & (first.y + lane_y() < height);
    for (unsigned rest = lane_bits(mixed); rest != 0; rest &= rest - 1) {
      tile.mixed.push_back(
          static_cast<std::uint16_t>(place + static_cast<unsigned>(std::countr_zero(rest))));
    }
  }
}

namespace {

/// As PixelSurfaces.
struct SurfaceLanes {
  std::array<Floats, 4> texel, other;
  Ints other_samples, first;
};

struct GroupLanes {
  std::array<Floats, 4> sum;
  Ints count{}, first{};

  SOFTFOCUS_INLINE GroupLanes() { sum.fill(splat(-0.0f)); }
  SOFTFOCUS_INLINE void add(const std::array<Floats, 4>& sample, Mask here, int number) {
    first = select(here & (count == 0), splat(number), first);
    for (std::size_t k = 0; k < 4; ++k) sum[k] = select(here, sum[k] + sample[k], sum[k]);
    count -= here;
  }
};

SOFTFOCUS_INLINE SurfaceLanes
surface_lanes(const std::array<std::array<Floats, 4>, kMaxSamples>& of, std::size_t samples) {
  Floats nearest = of[0][3], farthest = of[0][3];
  for (std::size_t s = 1; s < samples; ++s) {
    nearest = select(of[s][3] < nearest, of[s][3], nearest);
    farthest = select(farthest < of[s][3], of[s][3], farthest);
  }
  const Mask is_one = farthest <= nearest * kOneSurface;
  const Floats border = 2.0f / (1.0f / nearest + 1.0f / farthest);
  GroupLanes near_group, far_group;
  for (std::size_t s = 0; s < samples; ++s) {
    const Mask is_near = is_one | (of[s][3] < border);
    near_group.add(of[s], is_near, static_cast<int>(s));
    far_group.add(of[s], ~is_near, static_cast<int>(s));
  }
  const Mask shows_near = near_group.count >= far_group.count;
  const Floats near_share = 1.0f / to_floats(near_group.count);
  const Floats far_share = 1.0f / to_floats(far_group.count);
  SurfaceLanes surfaces;
  for (std::size_t k = 0; k < 4; ++k) {
    const Floats near_mean = near_group.sum[k] * near_share;
    const Floats far_mean = far_group.sum[k] * far_share;
    surfaces.texel[k] = select(shows_near, near_mean, far_mean);
    surfaces.other[k] = select(shows_near, far_mean, near_mean);
  }
  surfaces.other_samples = select(shows_near, far_group.count, near_group.count);
  surfaces.first = select(shows_near, near_group.first, far_group.first);
  return surfaces;
}

using Texels = std::array<std::uint64_t, kLanes>;

// Of a sample's texels in the tile's memory.
SOFTFOCUS_INLINE std::uint64_t texel_in(const std::byte* texels, const glm::ivec2& at) {
  std::uint64_t texel = 0;
  std::memcpy(&texel, texels + static_cast<std::size_t>(at.y * kTileSize + at.x) * sizeof texel,
              sizeof texel);
  return texel;
}

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

void resolve_mixed(VisibilityTile& tile, const SurfaceTargets& to, std::uint64_t cleared,
                   const Profile& profile) {
  const Rectangle& area = tile.area;
  alignas(64) std::array<Texels, kMaxSamples> texels;
  alignas(64) Texels shown, other;
  std::array<std::array<Floats, 4>, kMaxSamples> colours;
  for (std::size_t begin = 0; begin < tile.mixed.size(); begin += kLanes) {
    const std::size_t count = std::min<std::size_t>(kLanes, tile.mixed.size() - begin);
    for (std::size_t s = 0; s < tile.layers; ++s) {
      const TileLayer& layer = tile.layer(s);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::uint16_t place = tile.mixed[begin + std::min(lane, count - 1)];
        const std::int32_t id = layer.ids[place];
        if (s == 0 && id < 0) {
          texels[s][lane] = texel_in(tile.sample_texels.get(), pixel_of_place(place));
        } else if (id <= 0) {
          texels[s][lane] = id == 0 ? cleared : texels[static_cast<std::size_t>(-1 - id)][lane];
        } else {
          std::memcpy(&texels[s][lane], texel_at(layer, pixel_of_place(place)),
                      sizeof texels[s][lane]);
        }
      }
      const HalfTexels halves =
          load_half_texels(reinterpret_cast<const std::uint16_t*>(texels[s].data()));
      colours[s] = {half_to_float(halves.r), half_to_float(halves.g), half_to_float(halves.b),
                    half_to_float(halves.a)};
    }
    const SurfaceLanes surfaces = surface_lanes(colours, tile.layers);
    to_texels(surfaces.texel, profile.half_store, shown);
    to_texels(surfaces.other, profile.half_store, other);
    alignas(64) std::array<std::int32_t, kLanes> other_samples, first;
    store(other_samples.data(), surfaces.other_samples);
    store(first.data(), surfaces.first);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const std::uint16_t place = tile.mixed[begin + lane];
      const glm::ivec2 at = pixel_of_place(place);
      std::memcpy(texel_at(tile.front, at), &shown[lane], sizeof shown[lane]);
      if (first[lane] > 0) {
        tile.front.depth[place] = tile.layer(static_cast<std::size_t>(first[lane])).depth[place];
      }
      if (other_samples[lane] == 0) continue;
      const auto x = static_cast<std::size_t>(area.x_begin + at.x);
      const int y = area.y_begin + at.y - to.y_begin;
      std::memcpy(&row<std::uint16_t>(*to.other, y)[4 * x], &other[lane], sizeof other[lane]);
      row<std::uint8_t>(*to.coverage, y)[x] =
          coverage_byte(other_samples[lane], static_cast<int>(tile.layers));
    }
  }
}

#endif
