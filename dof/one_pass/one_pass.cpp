#include "dof/one_pass/one_pass.h"

#include <algorithm>
#include <cmath>

#include "dof/one_pass/one_pass_tiles.h"
#include "dof/weights.h"
#include "raster/passes/fullscreen_pass.h"

namespace softfocus {
namespace {

constexpr int kBandRows = 32;

// Rows y_begin - margin to y_end + margin of the picture as filter texels, with
// `margin` texels repeated around the picture's edge.
struct Band {
  int margin;
  int y_begin;
  int stride;
  std::vector<FilterTexel> texels;

  const FilterTexel* at(int x, int y) const {
    return &texels[static_cast<std::size_t>((y - y_begin + margin) * stride + x + margin)];
  }
};

Band fill_band(const DofInput& input, int y_begin, int y_end, int margin) {
  const ConstImageView& scene = input.scene;
  Band band{margin, y_begin, scene.width + 2 * margin, {}};
  const int rows = y_end - y_begin + 2 * margin;
  band.texels.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(band.stride));
  std::size_t next = 0;
  for (int y = y_begin - margin; y < y_end + margin; ++y) {
    const int inside_y = std::clamp(y, 0, scene.height - 1);
    for (int x = -margin; x < scene.width + margin; ++x) {
      const glm::vec4 texel =
          load_texel<Format::rgba16f>(scene, std::clamp(x, 0, scene.width - 1), inside_y);
      band.texels[next++] =
          filter_texel(input.settings, glm::vec3{texel.x, texel.y, texel.z}, texel.w);
    }
  }
  return band;
}

void one_pass_bands(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  const float radius = largest_filter_radius(input, pool);
  const std::vector<RingTap> taps = ring_taps(radius);

  pool.for_each((scene.height + kBandRows - 1) / kBandRows, [&](int number) {
    const int y_begin = number * kBandRows;
    const int y_end = std::min(y_begin + kBandRows, scene.height);
    const Band band = fill_band(input, y_begin, y_end, tap_count(radius));
    for (int y = y_begin; y < y_end; ++y) {
      for (int x = 0; x < scene.width; ++x) {
        const FilterTexel* centre = band.at(x, y);
        const float receiver_leakage = leakage(centre->radius_px, input.settings.leak);
        Gather gather = begin_gather(*centre);
        for (const RingTap& tap : taps) {
          add_neighbour(gather, *(centre + tap.dy * band.stride + tap.dx), tap.distance_px,
                        receiver_leakage);
        }
        const float depth = load_texel<Format::rgba16f>(scene, x, y).w;
        store_texel<Format::rgba16f>(result, x, y, glm::vec4{resolve(gather), depth},
                                     input.profile);
      }
    }
  });
}

}  // namespace

std::vector<RingTap> ring_taps(float radius_px) {
  const int reach = tap_count(radius_px);
  struct Ringed {
    int ring;
    RingTap tap;
  };
  std::vector<Ringed> found;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const float distance = std::sqrt(static_cast<float>(dx * dx + dy * dy));
      if ((dx == 0 && dy == 0) || !(distance < radius_px)) continue;
      found.push_back({static_cast<int>(distance + 0.5f), {dx, dy, distance}});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Ringed& a, const Ringed& b) { return a.ring < b.ring; });
  std::vector<RingTap> taps;
  taps.reserve(found.size());
  for (const Ringed& entry : found) taps.push_back(entry.tap);
  return taps;
}

void one_pass(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) {
    one_pass_bands(input, result, pool);
  } else {
    one_pass_tiles(input, result, pool);
  }
}

void one_pass_plain(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  const auto fetch = [&](int x, int y) {
    return load_texel<Format::rgba16f>(scene, std::clamp(x, 0, scene.width - 1),
                                       std::clamp(y, 0, scene.height - 1));
  };
  const auto neighbour = [&](int x, int y) {
    const glm::vec4 texel = fetch(x, y);
    return filter_texel(input.settings, glm::vec3{texel.x, texel.y, texel.z}, texel.w);
  };
  const std::vector<RingTap> taps = ring_taps(input.settings.max_coc_px);
  fullscreen_pass<Format::rgba16f>(result, input.profile, pool, [&](int x, int y) {
    const FilterTexel centre = neighbour(x, y);
    const float receiver_leakage = leakage(centre.radius_px, input.settings.leak);
    Gather gather = begin_gather(centre);
    for (const RingTap& tap : taps) {
      add_neighbour(gather, neighbour(x + tap.dx, y + tap.dy), tap.distance_px, receiver_leakage);
    }
    return glm::vec4{resolve(gather), fetch(x, y).w};
  });
}

}  // namespace softfocus
