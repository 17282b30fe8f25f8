#include "dof/scatter/layer_planes.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "dof/scatter/scatter_discs.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

// Neighbours of one surface differ by at most half a pixel in radius.
constexpr int kSurfaceStepQuarters = 2;

// Cuts lie between neighbouring radii of scatter_discs.h, in quarters of a pixel.
constexpr int kMostQuarters = 4 * static_cast<int>(kLargestMaxCoc);

int signed_quarters(float radius_px) {
  return radius_px < 0.0f ? -disc_of(radius_px) : disc_of(radius_px);
}

// For each cut, at -kMostQuarters + 1/2 quarters and so on: the steps in radius of neighbours of
// different surfaces that it parts, and how many neighbours of one surface.
struct CutCounts {
  std::vector<std::int64_t> apart, through;
};

std::size_t cut_index(int quarters) { return static_cast<std::size_t>(quarters + kMostQuarters); }

// Adds a pair of neighbours to the first and takes it off past the last of the cuts between.
void add_pair(CutCounts& counts, float one_px, float other_px) {
  const int one = signed_quarters(one_px), other = signed_quarters(other_px);
  if (one == other) return;
  const int least = std::min(one, other), most = std::max(one, other);
  const bool is_apart = most - least > kSurfaceStepQuarters;
  std::vector<std::int64_t>& of = is_apart ? counts.apart : counts.through;
  const std::int64_t amount = is_apart ? most - least : 1;
  of[cut_index(least)] += amount;
  of[cut_index(most)] -= amount;
}

CutCounts count_cuts(const Planes& scene) {
  CutCounts counts{std::vector<std::int64_t>(cut_index(kMostQuarters) + 1, 0),
                   std::vector<std::int64_t>(cut_index(kMostQuarters) + 1, 0)};
  for (int y = 0; y < scene.height; ++y) {
    const float* here = plane_row(scene, 3, y);
    const float* below = plane_row(scene, 3, std::min(y + 1, scene.height - 1));
    for (int x = 0; x < scene.width; ++x) {
      if (x + 1 < scene.width) add_pair(counts, here[x], here[x + 1]);
      add_pair(counts, here[x], below[x]);
    }
  }
  for (std::size_t i = 1; i < counts.apart.size(); ++i) {
    counts.apart[i] += counts.apart[i - 1];
    counts.through[i] += counts.through[i - 1];
  }
  return counts;
}

// Planes of values that `write` sets, and the plane that tells where they are known.
template <class Write>
Planes guessed(const Planes& scene, int values, ThreadPool& pool, const Write& write) {
  Planes sheet = make_planes(values + 1, scene.width, scene.height, pool);
  pool.for_each(scene.height, [&](int y) {
    const float* from = plane_row(scene, 0, y);
    float* to = plane_row(sheet, 0, y);
    for (int x = 0; x < scene.width; ++x) write(from + x, from[x + 3 * scene.plane], to + x);
  });
  guess_hidden(sheet, values, pool);
  return sheet;
}

void copy_plane(const Planes& from, int plane, Planes& to, int to_plane) {
  std::copy_n(plane_row(from, plane, 0), from.plane, plane_row(to, to_plane, 0));
}

}  // namespace

LayerSplit split_layers(const Planes& scene) {
  const CutCounts counts = count_cuts(scene);
  LayerSplit split{-2.0f * kLargestMaxCoc, 2.0f * kLargestMaxCoc};
  std::int64_t best_near = 0, best_far = 0;
  for (int quarters = 2; quarters < kMostQuarters; ++quarters) {
    const auto gain = [&](std::size_t cut) {
      return counts.apart[cut] - quarters * counts.through[cut];
    };
    const float radius_px = 0.25f * static_cast<float>(quarters) + 0.125f;
    const std::int64_t near = gain(cut_index(-quarters - 1)), far = gain(cut_index(quarters));
    if (near > best_near) {
      best_near = near;
      split.near_px = -radius_px;
    }
    if (far > best_far) {
      best_far = far;
      split.far_px = radius_px;
    }
  }
  return split;
}

Planes near_layer(const Planes& scene, const LayerSplit& split, ThreadPool& pool) {
  const std::ptrdiff_t plane = scene.plane;
  const Planes radius = guessed(scene, 1, pool, [&](const float*, float radius_px, float* to) {
    to[0] = radius_px;
    to[plane] = radius_px < split.near_px ? 1.0f : 0.0f;
  });
  Planes layer = make_planes(kLayerPlanes, scene.width, scene.height, pool);
  for (int i = 0; i < 3; ++i) copy_plane(scene, i, layer, i);
  copy_plane(radius, 1, layer, kLayerOpacity);
  copy_plane(radius, 0, layer, kLayerRadius);
  return layer;
}

Planes mid_layer(const Planes& scene, const LayerSplit& split, ThreadPool& pool) {
  const std::ptrdiff_t plane = scene.plane;
  const auto is_mid = [&](float radius_px) {
    return radius_px >= split.near_px && radius_px <= split.far_px;
  };
  Planes layer = guessed(scene, 4, pool, [&](const float* from, float radius_px, float* to) {
    const float opacity = is_mid(radius_px) ? 1.0f : 0.0f;
    for (int i = 0; i < 3; ++i) to[i * plane] = from[i * plane] * opacity;
    to[kLayerOpacity * plane] = opacity;
    to[4 * plane] = radius_px >= split.near_px ? 1.0f : 0.0f;
  });
  const Planes radius = guessed(scene, 1, pool, [&](const float*, float radius_px, float* to) {
    to[0] = radius_px;
    to[plane] = is_mid(radius_px) ? 1.0f : 0.0f;
  });
  copy_plane(radius, 0, layer, kLayerRadius);
  return layer;
}

Planes far_layer(const Planes& scene, const LayerSplit& split, ThreadPool& pool) {
  const std::ptrdiff_t plane = scene.plane;
  const Planes whole = guessed(scene, 4, pool, [&](const float* from, float radius_px, float* to) {
    for (int i = 0; i < 4; ++i) to[i * plane] = from[i * plane];
    to[4 * plane] = radius_px > split.far_px ? 1.0f : 0.0f;
  });
  Planes layer = make_planes(kLayerPlanes, scene.width, scene.height, pool);
  for (int i = 0; i < 3; ++i) copy_plane(whole, i, layer, i);
  std::fill_n(plane_row(layer, kLayerOpacity, 0), layer.plane, 1.0f);
  copy_plane(whole, 3, layer, kLayerRadius);
  return layer;
}

namespace {

constexpr int kPlaneTaskRows = 16;

bool all_known(const Planes& level, int values) {
  for (int y = 0; y < level.height; ++y) {
    const float* known = plane_row(level, values, y);
    if (std::any_of(known, known + level.width, [](float is) { return is == 0.0f; })) return false;
  }
  return true;
}

void pull_row(const Planes& fine, int values, int y, Planes& coarse) {
  const PullPair rows = pull_pair(y, fine.height);
  const float* known = plane_row(fine, values, rows.first);
  const std::ptrdiff_t down = (rows.second - rows.first) * fine.stride;
  for (int x = 0; x < coarse.width; ++x) {
    const PullPair columns = pull_pair(x, fine.width);
    const std::ptrdiff_t at[] = {columns.first, columns.second, columns.first + down,
                                 columns.second + down};
    float* to = plane_row(coarse, 0, y) + x;
    const float count = (known[at[0]] + known[at[1]]) + (known[at[2]] + known[at[3]]);
    to[values * coarse.plane] = count > 0.0f ? 1.0f : 0.0f;
    for (int i = 0; i < values; ++i) {
      const float* from = plane_row(fine, i, rows.first);
      const auto value = [&](std::ptrdiff_t place) {
        return known[place] != 0.0f ? from[place] : 0.0f;
      };
      const float sum = (value(at[0]) + value(at[1])) + (value(at[2]) + value(at[3]));
      to[i * coarse.plane] = count > 0.0f ? sum / count : 0.0f;
    }
  }
}

// Every pixel of `coarse` has a value. `taps` are those of the columns.
void push_row(const Planes& coarse, const std::vector<PushTap>& taps, int values, int y,
              Planes& fine) {
  const PushTap down = push_tap(y, fine.height);
  const float* known = plane_row(fine, values, y);
  for (int x = 0; x < fine.width; ++x) {
    if (known[x] != 0.0f) continue;
    const PushTap across = taps[static_cast<std::size_t>(x)];
    for (int i = 0; i < values; ++i) {
      const auto between = [&](int row) {
        const float* from = plane_row(coarse, i, row);
        return across.near_share * from[across.near] +
               (1.0f - across.near_share) * from[across.far];
      };
      plane_row(fine, i, y)[x] =
          down.near_share * between(down.near) + (1.0f - down.near_share) * between(down.far);
    }
  }
}

}  // namespace

PullPair pull_pair(int coarse, int fine_size) {
  // With a middle that counts as two, what lies past it comes one pixel sooner.
  const int middle = fine_size % 2 == 1 ? fine_size / 2 : fine_size;
  const auto place = [&](int i) { return i > middle ? i - 1 : i; };
  return {place(2 * coarse), place(2 * coarse + 1)};
}

PushTap push_tap(int fine, int fine_size) {
  const int middle = fine_size / 2, coarse_size = (fine_size + 1) / 2;
  if (fine_size % 2 == 1 && fine == middle) {
    return middle % 2 == 0 ? PushTap{middle / 2, middle / 2, 0.75f}
                           : PushTap{middle / 2, middle / 2 + 1, 0.5f};
  }
  const int place = fine_size % 2 == 1 && fine > middle ? fine + 1 : fine;
  const int far = place / 2 + (place % 2 == 0 ? -1 : 1);
  return {place / 2, std::clamp(far, 0, coarse_size - 1), 0.75f};
}

void guess_hidden(Planes& sheet, int values, ThreadPool& pool) {
  std::vector<Planes> coarser;
  const auto level = [&](std::size_t i) -> Planes& { return i == 0 ? sheet : coarser[i - 1]; };
  std::size_t top = 0;
  while (!all_known(level(top), values)) {
    const Planes& fine = level(top);
    if (fine.width == 1 && fine.height == 1) return;
    Planes coarse = make_planes(values + 1, (fine.width + 1) / 2, (fine.height + 1) / 2, pool);
    for_each_row(pool, coarse.height, kPlaneTaskRows,
                 [&](int y) { pull_row(fine, values, y, coarse); });
    coarser.push_back(std::move(coarse));
    ++top;
  }
  for (; top > 0; --top) {
    Planes& fine = level(top - 1);
    std::vector<PushTap> taps(static_cast<std::size_t>(fine.width));
    for (int x = 0; x < fine.width; ++x)
      taps[static_cast<std::size_t>(x)] = push_tap(x, fine.width);
    for_each_row(pool, fine.height, kPlaneTaskRows,
                 [&](int y) { push_row(level(top), taps, values, y, fine); });
  }
}

}  // namespace softfocus
