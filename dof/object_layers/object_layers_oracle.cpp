// The oracle of object-identification: the equations of object_layers.h, pixel by pixel, on the
// surfaces that hidden_parts.h gives.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "dof/disc_layers/disc_slopes.h"
#include "dof/level_oracle.h"
#include "dof/object_layers/hidden_parts.h"
#include "dof/object_layers/object_layers.h"
#include "dof/object_layers/object_rungs.h"

namespace softfocus {
namespace {

constexpr std::size_t kOwn = 3, kSeen = 4;
using Channels = std::array<float, 5>;  // light, own, seen
using Shown = SeenGrid::Pixel;

// A level, and what is seen of it and of larger ones before the focus and behind it.
struct SlowLevel {
  int width, height;
  std::array<SeenGrid, 2> shown;
};

float signed_square(float radius) { return radius * std::fabs(radius); }

struct SlowObjectLayers {
  Surfaces surfaces;
  ObjectLadder ladder;
  std::vector<SlowLevel> levels;

  Channels of_pixel(const ObjectRung& layer, int x, int y) const {
    const int inside_x = std::clamp(x, 0, surfaces.visible.width - 1);
    const int inside_y = std::clamp(y, 0, surfaces.visible.height - 1);
    const float* seen = plane_row(surfaces.visible, 0, inside_y) + inside_x;
    const float* hidden = plane_row(surfaces.hidden, 0, inside_y) + inside_x;
    const std::ptrdiff_t seen_plane = surfaces.visible.plane, hidden_plane = surfaces.hidden.plane;
    const float v = signed_square(seen[3 * seen_plane]);
    const float h = signed_square(hidden[hidden_plane::kRadius * hidden_plane]);
    const float f = hidden[hidden_plane::kShare * hidden_plane];
    const float farthest = signed_square(hidden[hidden_plane::kFarthest * hidden_plane]);
    const float b_v = share_behind(layer.begin, v), b_h = share_behind(layer.begin, h);
    const float v_k = b_v - share_behind(layer.next, v);
    const float h_k = f * (b_h - share_behind(layer.next, h)) * (1.0f - v_k);
    Channels channels;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto plane = static_cast<std::ptrdiff_t>(i);
      channels[i] = v_k * seen[plane * seen_plane] + h_k * hidden[plane * hidden_plane];
    }
    channels[kOwn] = v_k + h_k;
    const float join = share_behind(layer.before, farthest);
    channels[kSeen] = std::max(channels[kOwn], b_v + std::max(f * b_h - b_v, 0.0f) * (1.0f - join));
    return channels;
  }

  // The mean of the picture's pixels in a pixel of a level; outside it, in one of its border.
  Channels of_level(std::size_t level, const ObjectRung& layer, int at_x, int at_y) const {
    const int x = std::clamp(at_x, 0, levels[level].width - 1);
    const int y = std::clamp(at_y, 0, levels[level].height - 1);
    const int size = 1 << level;
    std::vector<Channels> columns;
    for (int column = 0; column < size; ++column) {
      Channels sum = of_pixel(layer, x * size + column, y * size);
      for (int row = 1; row < size; ++row) {
        const Channels more = of_pixel(layer, x * size + column, y * size + row);
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += more[i];
      }
      columns.push_back(sum);
    }
    for (std::size_t count = columns.size(); count > 1; count /= 2) {
      for (std::size_t column = 0; column < count / 2; ++column) {
        for (std::size_t i = 0; i < 5; ++i) {
          columns[column][i] = columns[2 * column][i] + columns[2 * column + 1][i];
        }
      }
    }
    for (float& channel : columns[0]) channel *= 1.0f / static_cast<float>(size * size);
    return columns[0];
  }

  // The sum over a layer's disc.
  Channels disc_sum(std::size_t level, const ObjectRung& layer, int x, int y) const {
    const std::vector<LadderSpan>& spans = layer.rung->spans;
    const auto add = [](Channels a, const Channels& b) {
      for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
      return a;
    };
    const auto column = [&](int dx) {
      const LadderSpan& span = spans[static_cast<std::size_t>(std::abs(dx))];
      Channels sum = of_level(level, layer, x + dx, y);
      for (int dy = 1; dy <= span.whole; ++dy) {
        sum = add(sum, add(of_level(level, layer, x + dx, y - dy),
                           of_level(level, layer, x + dx, y + dy)));
      }
      const Channels ends = add(of_level(level, layer, x + dx, y - span.whole - 1),
                                of_level(level, layer, x + dx, y + span.whole + 1));
      for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] = span.centre * sum[i] + span.end * ends[i];
      return sum;
    };
    Channels sum = column(0);
    for (int dx = 1; dx < static_cast<int>(spans.size()); ++dx) {
      sum = add(sum, add(column(-dx), column(dx)));
    }
    return sum;
  }

  void add_layers(std::size_t level, const std::vector<ObjectRung>& layers, int x, int y,
                  Shown& shown) const {
    for (const ObjectRung& layer : layers) {
      const Channels sum = disc_sum(level, layer, x, y);
      if (sum[kOwn] == 0.0f) continue;
      const float scale = shown[3] / sum[kSeen];
      for (std::size_t i = 0; i < 3; ++i) shown[i] += sum[i] * scale;
      shown[3] = std::max(shown[3] - sum[kOwn] * scale, 0.0f);
    }
  }

  Shown near(std::size_t level, int x, int y) const {
    Shown shown{0.0f, 0.0f, 0.0f, 1.0f};
    if (level + 1 < levels.size()) shown = enlarged(levels[level + 1].shown[0], x, y);
    add_layers(level, ladder.near[level], x, y, shown);
    return shown;
  }

  void add_far(std::size_t level, int x, int y, Shown& shown) const {
    add_layers(level, ladder.far[level], x, y, shown);
    if (level + 1 == levels.size()) return;
    add_behind(shown, enlarged(levels[level + 1].shown[1], x, y));
  }
};

}  // namespace

void object_layers_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const CentredDiscs centred = centre_discs(input, pool);
  DofInput of_centred = input;
  of_centred.scene = centred.picture;
  SlowObjectLayers layers{
      find_surfaces(of_centred, pool), make_object_ladder(input.settings.max_coc_px), {}};
  int width = result.width, height = result.height;
  for (std::size_t i = 0; i < layers.ladder.levels.size(); ++i) {
    layers.levels.push_back({width, height, {}});
    width = (width + 1) / 2;
    height = (height + 1) / 2;
  }
  for (std::size_t i = layers.levels.size(); i-- > 1;) {
    SlowLevel& level = layers.levels[i];
    std::array<SeenGrid, 2> shown;
    shown.fill(SeenGrid(level.width, level.height));
    pool.for_each(level.height, [&](int y) {
      for (int x = 0; x < level.width; ++x) {
        shown[0].at(x, y) = layers.near(i, x, y);
        Shown& far = shown[1].at(x, y);
        far = {0.0f, 0.0f, 0.0f, 1.0f};
        layers.add_far(i, x, y, far);
      }
    });
    level.shown = std::move(shown);
  }
  pool.for_each(result.height, [&](int y) {
    for (int x = 0; x < result.width; ++x) {
      Shown shown = layers.near(0, x, y);
      layers.add_far(0, x, y, shown);
      const float scale = 1.0f / (1.0f - shown[3]);
      for (std::size_t i = 0; i < 3; ++i) shown[i] *= scale;
      store_span(input, result, x, y, 1, &shown[0], &shown[1], &shown[2], Isa::scalar);
    }
  });
}

}  // namespace softfocus
