#include "dof/object_layers/hidden_parts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "dof/object_layers/object_rungs.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

constexpr int kVisibleRadius = 3;
constexpr float kAsFarPx = 0.75f;
constexpr int kHiddenTaskRows = 8, kHiddenTaskColumns = 64;

constexpr std::size_t kToLeft = 0, kToRight = 1, kUpwards = 2, kDownwards = 3;
constexpr int kStepX[] = {-1, 1, 0, 0}, kStepY[] = {0, 0, -1, 1};

/// How far away, in pixels, each pixel finds a hidden surface in each direction; 0: nowhere.
using Distances = std::array<std::vector<std::uint16_t>, 4>;

// The surface that goes on behind the pixels of a line.
struct Walk {
  int border = -1;  // its last visible pixel's place on the line
  float radius_px = 0.0f;
  float before_px = 0.0f;  // the radius of the pixel before

  // The distance of the border at the next pixel.
  std::uint16_t step(int place, float next_px, bool linked) {
    if (place > 0 && !linked) {
      if (before_px > next_px) {
        border = place - 1;
        radius_px = before_px;
      } else if (next_px >= radius_px) {
        border = -1;
      }
    }
    before_px = next_px;
    if (border < 0) return 0;
    const int distance = place - border;
    if (static_cast<float>(distance) < radius_px - next_px + 1.0f) {
      return static_cast<std::uint16_t>(distance);
    }
    border = -1;
    return 0;
  }
};

void walk_row(const Planes& visible, const PictureObjects& objects, int y, Distances& distances) {
  const float* radii = plane_row(visible, kVisibleRadius, y);
  const std::size_t begin = objects.at(0, y);
  const std::uint8_t* links = &objects.links[begin];
  Walk from_left, from_right;
  for (int x = 0; x < objects.width; ++x) {
    distances[kToLeft][begin + static_cast<std::size_t>(x)] =
        from_left.step(x, radii[x], x > 0 && (links[x - 1] & kLinkedRight) != 0);
  }
  for (int i = 0; i < objects.width; ++i) {
    const int x = objects.width - 1 - i;
    distances[kToRight][begin + static_cast<std::size_t>(x)] =
        from_right.step(i, radii[x], (links[x] & kLinkedRight) != 0);
  }
}

void walk_columns(const Planes& visible, const PictureObjects& objects, int first,
                  Distances& distances) {
  const int count = std::min(kHiddenTaskColumns, objects.width - first), height = objects.height;
  std::array<Walk, kHiddenTaskColumns> walks{};
  for (int y = 0; y < height; ++y) {
    const float* radii = plane_row(visible, kVisibleRadius, y) + first;
    const std::size_t at = objects.at(first, y);
    const std::uint8_t* above = y > 0 ? &objects.links[objects.at(first, y - 1)] : nullptr;
    for (int i = 0; i < count; ++i) {
      const auto column = static_cast<std::size_t>(i);
      distances[kUpwards][at + column] =
          walks[column].step(y, radii[i], above != nullptr && (above[i] & kLinkedDown) != 0);
    }
  }
  walks.fill({});
  for (int y = height - 1; y >= 0; --y) {
    const float* radii = plane_row(visible, kVisibleRadius, y) + first;
    const std::size_t at = objects.at(first, y);
    const std::uint8_t* links = &objects.links[at];
    for (int i = 0; i < count; ++i) {
      const auto column = static_cast<std::size_t>(i);
      distances[kDownwards][at + column] =
          walks[column].step(height - 1 - y, radii[i], (links[i] & kLinkedDown) != 0);
    }
  }
}

struct Found {
  int distance;  // 0: nothing
  float radius_px;
  std::uint32_t object;
  float r, g, b;
};

Found find(const Planes& visible, const PictureObjects& objects, int x, int y, int distance,
           std::size_t direction) {
  if (distance == 0) return {};
  const int border_x = x + distance * kStepX[direction],
            border_y = y + distance * kStepY[direction];
  const float* texel = plane_row(visible, 0, border_y) + border_x;
  return {distance,
          texel[kVisibleRadius * visible.plane],
          objects.numbers[objects.at(border_x, border_y)],
          texel[0],
          texel[visible.plane],
          texel[2 * visible.plane]};
}

// The hidden surface of a pixel, from what it finds in the four directions.
void mix_found(const std::array<Found, 4>& found, float radius_px, float* to,
               std::ptrdiff_t plane) {
  Found nearest{};
  for (const Found& one : found) {
    if (one.distance == 0) continue;
    if (nearest.distance == 0 || one.distance < nearest.distance ||
        (one.distance == nearest.distance && one.radius_px > nearest.radius_px)) {
      nearest = one;
    }
  }
  std::array<float, 4> weights;
  for (std::size_t i = 0; i < 4; ++i) {
    const Found& one = found[i];
    const bool counts =
        one.distance > 0 &&
        (one.object == nearest.object || std::fabs(one.radius_px - nearest.radius_px) <= kAsFarPx);
    weights[i] = counts ? 1.0f / static_cast<float>(one.distance) : 0.0f;
  }
  const float all =
      (weights[kToLeft] + weights[kToRight]) + (weights[kUpwards] + weights[kDownwards]);
  const auto mean = [&](auto value) {
    return ((weights[kToLeft] * value(found[kToLeft]) +
             weights[kToRight] * value(found[kToRight])) +
            (weights[kUpwards] * value(found[kUpwards]) +
             weights[kDownwards] * value(found[kDownwards]))) /
           all;
  };
  const float distance = static_cast<float>(nearest.distance);
  to[0] = mean([](const Found& one) { return one.r; });
  to[plane] = mean([](const Found& one) { return one.g; });
  to[2 * plane] = mean([](const Found& one) { return one.b; });
  to[hidden_plane::kRadius * plane] = mean([](const Found& one) { return one.radius_px; });
  to[hidden_plane::kShare * plane] =
      std::min(1.0f, nearest.radius_px - radius_px + 1.0f - distance);
}

void fill_row(const Planes& visible, const PictureObjects& objects, const Distances& distances,
              int y, Planes& hidden) {
  float* to = plane_row(hidden, 0, y);
  const float* radii = plane_row(visible, kVisibleRadius, y);
  const std::size_t begin = objects.at(0, y);
  for (int i = 0; i < hidden_plane::kFarthest; ++i) {
    std::fill_n(to + i * hidden.plane, hidden.stride, 0.0f);
  }
  float* farthest = to + hidden_plane::kFarthest * hidden.plane;
  std::uint32_t last = objects.numbers[begin];
  float farthest_px = objects.farthest_px[last];
  for (int x = 0; x < objects.width; ++x) {
    const std::size_t at = begin + static_cast<std::size_t>(x);
    if (objects.numbers[at] != last) {
      last = objects.numbers[at];
      farthest_px = objects.farthest_px[last];
    }
    farthest[x] = farthest_px;
    int any = 0;
    for (const auto& direction : distances) any |= direction[at];
    if (any == 0) continue;
    std::array<Found, 4> found;
    for (std::size_t i = 0; i < 4; ++i) {
      found[i] = find(visible, objects, x, y, distances[i][at], i);
    }
    mix_found(found, radii[x], to + x, hidden.plane);
  }
  for (int i = 0; i < hidden_plane::kCount; ++i) {
    float* row = to + i * hidden.plane;
    std::fill(row + hidden.width, row + hidden.stride, row[hidden.width - 1]);
  }
}

}  // namespace

Surfaces find_surfaces(const DofInput& input, ThreadPool& pool) {
  const int width = input.scene.width, height = input.scene.height;
  Surfaces surfaces{split_picture(input, pool),
                    make_planes(hidden_plane::kCount, width, height, pool)};
  const Planes& visible = surfaces.visible;
  const PictureObjects objects = find_objects(visible, kVisibleRadius, input.objects, pool);
  Distances distances;
  for (auto& direction : distances) direction.resize(objects.numbers.size());
  for_each_row(pool, height, kHiddenTaskRows,
               [&](int y) { walk_row(visible, objects, y, distances); });
  pool.for_each((width + kHiddenTaskColumns - 1) / kHiddenTaskColumns, [&](int task) {
    walk_columns(visible, objects, task * kHiddenTaskColumns, distances);
  });
  for_each_row(pool, height, kHiddenTaskRows,
               [&](int y) { fill_row(visible, objects, distances, y, surfaces.hidden); });
  return surfaces;
}

namespace {

// The rungs of some surfaces, before the focus and behind it.
struct Marked {
  std::uint64_t rungs[2] = {0, 0};
  std::uint32_t last = ~0u;  // what the rungs of the last surface come from

  void add(float radius_px) {
    const float square = radius_px * radius_px;
    const auto bits = std::bit_cast<std::uint32_t>(square);
    const std::uint32_t key = bits >> 22 << 2 | ((bits & 0x3FFFFFu) == 0 ? 2u : 0u) |
                              std::bit_cast<std::uint32_t>(radius_px) >> 31;
    if (key == last) return;
    last = key;
    rungs[radius_px < 0.0f ? 0 : 1] |= rungs_of(square);
  }
};

}  // namespace

std::uint64_t LayerMarks::rungs_in(int side, int x, int y, int width, int height) const {
  const int left = std::clamp(x / kBlock, 0, columns - 1);
  const int right = std::clamp((x + width - 1) / kBlock, 0, columns - 1);
  const int top = std::clamp(y / kBlock, 0, rows - 1);
  const int bottom = std::clamp((y + height - 1) / kBlock, 0, rows - 1);
  std::uint64_t rungs = 0;
  for (int row = top; row <= bottom; ++row) {
    const auto begin = static_cast<std::size_t>(row * columns);
    for (int column = left; column <= right; ++column) {
      rungs |= blocks[side][begin + static_cast<std::size_t>(column)];
    }
  }
  return rungs;
}

LayerMarks mark_layers(const Surfaces& surfaces, ThreadPool& pool) {
  const Planes& visible = surfaces.visible;
  const Planes& hidden = surfaces.hidden;
  LayerMarks marks{};
  marks.columns = (visible.width + LayerMarks::kBlock - 1) / LayerMarks::kBlock;
  marks.rows = (visible.height + LayerMarks::kBlock - 1) / LayerMarks::kBlock;
  for (auto& blocks : marks.blocks) {
    blocks.assign(static_cast<std::size_t>(marks.columns * marks.rows), 0);
  }
  pool.for_each(marks.rows, [&](int row) {
    const int end = std::min((row + 1) * LayerMarks::kBlock, visible.height);
    for (int y = row * LayerMarks::kBlock; y < end; ++y) {
      const float* radii = plane_row(visible, 3, y);
      const float* hidden_radii = plane_row(hidden, hidden_plane::kRadius, y);
      const float* shares = plane_row(hidden, hidden_plane::kShare, y);
      for (int column = 0; column < marks.columns; ++column) {
        Marked marked;
        const int begin = column * LayerMarks::kBlock;
        for (int x = begin; x < std::min(begin + LayerMarks::kBlock, visible.width); ++x) {
          marked.add(radii[x]);
          if (shares[x] > 0.0f) marked.add(hidden_radii[x]);
        }
        const auto block = static_cast<std::size_t>(row * marks.columns + column);
        for (std::size_t side = 0; side < 2; ++side)
          marks.blocks[side][block] |= marked.rungs[side];
      }
    }
  });
  return marks;
}

}  // namespace softfocus
