// The oracle of disc-layers: the equations of disc_layers.h, pixel by pixel.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "dof/disc_layers/disc_ladder.h"
#include "dof/disc_layers/disc_layers.h"
#include "dof/picture_planes.h"

namespace softfocus {
namespace {

constexpr std::size_t kWeight = 3, kSquare = 4;
using Pixel = std::array<float, 5>;  // colour times weight, weight, square
using Seen = std::array<float, 4>;   // colour, transmittance

enum class Side { near, far };

struct Level {
  int width, height;
  std::array<std::vector<Pixel>, 2> sides;  // before and behind the focus; equal in level 0
  std::array<std::vector<Seen>, 2> seen;

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, height - 1)) *
               static_cast<std::size_t>(width) +
           static_cast<std::size_t>(std::clamp(x, 0, width - 1));
  }
};

Level picture_level(const DofInput& input) {
  Level level{input.scene.width, input.scene.height, {}, {}};
  for (int y = 0; y < level.height; ++y) {
    for (int x = 0; x < level.width; ++x) {
      const SplitTexel texel = split_texel(input, x, y);
      const float square = texel.radius_px * texel.radius_px;
      const Pixel pixel{texel.r, texel.g, texel.b, 1.0f, texel.radius_px < 0.0f ? -square : square};
      for (std::vector<Pixel>& side : level.sides) side.push_back(pixel);
    }
  }
  return level;
}

Pixel halved(const Level& from, std::size_t side, float sign, RungStep beyond, float least, int x,
             int y) {
  std::array<Pixel, 2> columns{};
  for (int i = 0; i < 4; ++i) {
    const Pixel& pixel = from.sides[side][from.at(2 * x + i / 2, 2 * y + i % 2)];
    Pixel& sum = columns[static_cast<std::size_t>(i / 2)];
    const float square = sign * pixel[kSquare];
    const float share = share_from(beyond, square);
    const float weight = pixel[kWeight] * share;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += pixel[c] * share;
    sum[kWeight] += weight;
    sum[kSquare] += weight * std::max(square, least);
  }
  Pixel result;
  for (std::size_t c = 0; c < 4; ++c) result[c] = 0.25f * (columns[0][c] + columns[1][c]);
  const float weight = columns[0][kWeight] + columns[1][kWeight];
  const float square = columns[0][kSquare] + columns[1][kSquare];
  result[kSquare] = weight > 0.0f ? square / weight : 0.0f;
  return result;
}

Level halve(const Level& from, bool whole, RungStep beyond, float least) {
  Level level{(from.width + 1) / 2, (from.height + 1) / 2, {}, {}};
  for (std::size_t side = 0; side < 2; ++side) {
    for (int y = 0; y < level.height; ++y) {
      for (int x = 0; x < level.width; ++x) {
        level.sides[side].push_back(
            halved(from, side, whole && side == 0 ? -1.0f : 1.0f, beyond, least, x, y));
      }
    }
  }
  return level;
}

// The sum of value_at(pixel) over a disc.
template <class ValueAt>
float disc_sum(const std::vector<LadderSpan>& spans, int x, int y, const ValueAt& value_at) {
  const auto column = [&](int dx) {
    const LadderSpan& span = spans[static_cast<std::size_t>(std::abs(dx))];
    float sum = value_at(x + dx, y);
    for (int dy = 1; dy <= span.whole; ++dy) {
      sum += value_at(x + dx, y - dy) + value_at(x + dx, y + dy);
    }
    return span.centre * sum +
           span.end * (value_at(x + dx, y - span.whole - 1) + value_at(x + dx, y + span.whole + 1));
  };
  float sum = column(0);
  for (int dx = 1; dx < static_cast<int>(spans.size()); ++dx) sum += column(-dx) + column(dx);
  return sum;
}

// The shares of a pixel that belong to a rung, and to the rung and all behind it.
struct Shares {
  float own, seen;
};

struct Layers {
  std::vector<LevelRungs> ladder;
  std::vector<Level> levels;

  RungStep step_after(std::size_t level, std::size_t rung) const {
    const LevelRungs& rungs = ladder[level];
    return rung + 1 < rungs.rungs.size() ? rungs.rungs[rung + 1].step : rungs.beyond;
  }

  Shares shares(std::size_t level, Side side, std::size_t rung, const Pixel& pixel) const {
    const RungStep end = step_after(level, rung);
    if (level == 0 && rung == 0) {
      return {1.0f - share_from(end, std::fabs(pixel[kSquare])),
              1.0f - share_from(end, -pixel[kSquare])};
    }
    const float sign = level == 0 && side == Side::near ? -1.0f : 1.0f;
    const float square = sign * pixel[kSquare];
    const float begun = share_from(ladder[level].rungs[rung].step, square);
    const float ended = share_from(end, square);
    return {begun - ended,
            side == Side::near ? 1.0f - pixel[kWeight] * ended : pixel[kWeight] * begun};
  }

  void add_rung(std::size_t number, Side side, std::size_t rung, int x, int y, Seen& seen) const {
    const Level& level = levels[number];
    const std::vector<Pixel>& pixels = level.sides[side == Side::near ? 0 : 1];
    const std::vector<LadderSpan>& spans = ladder[number].rungs[rung].spans;
    const auto sum_of = [&](std::size_t channel) {
      return disc_sum(spans, x, y, [&](int px, int py) {
        const Pixel& pixel = pixels[level.at(px, py)];
        const Shares of = shares(number, side, rung, pixel);
        return channel == kSquare ? of.seen : pixel[channel] * of.own;
      });
    };
    const float own = sum_of(kWeight);
    if (own == 0.0f) return;
    const float scale = seen[3] / sum_of(kSquare);
    for (std::size_t c = 0; c < 3; ++c) seen[c] += sum_of(c) * scale;
    seen[3] = std::max(seen[3] - own * scale, 0.0f);
  }

  // What is seen of one side of a level at a pixel of the level before.
  Seen enlarged(std::size_t number, std::size_t side, int x, int y) const {
    const Level& level = levels[number];
    const std::vector<Seen>& seen = level.seen[side];
    const int other_y = y / 2 + (y % 2 == 0 ? -1 : 1);
    const auto row = [&](int at, std::size_t c) {
      return 0.75f * seen[level.at(at, y / 2)][c] + 0.25f * seen[level.at(at, other_y)][c];
    };
    Seen result;
    for (std::size_t c = 0; c < 4; ++c) {
      result[c] = 0.75f * row(x / 2, c) + 0.25f * row(x / 2 + (x % 2 == 0 ? -1 : 1), c);
    }
    return result;
  }

  void add_near(std::size_t level, int x, int y, Seen& seen) const {
    for (std::size_t i = ladder[level].rungs.size(); i-- > (level == 0 ? 1u : 0u);) {
      add_rung(level, Side::near, i, x, y, seen);
    }
  }
  void add_far(std::size_t level, int x, int y, Seen& seen) const {
    for (std::size_t i = level == 0 ? 1 : 0; i < ladder[level].rungs.size(); ++i) {
      add_rung(level, Side::far, i, x, y, seen);
    }
    if (level + 1 == levels.size()) return;
    const Seen behind = enlarged(level + 1, 1, x, y);
    const float open = seen[3];
    for (std::size_t c = 0; c < 3; ++c) seen[c] += open * behind[c];
    seen[3] = open * behind[3];
  }
  Seen nothing_before(std::size_t level, int x, int y) const {
    return level + 1 < levels.size() ? enlarged(level + 1, 0, x, y) : Seen{0.0f, 0.0f, 0.0f, 1.0f};
  }
};

}  // namespace

void disc_layers_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  Layers layers;
  layers.ladder = disc_ladder_of(input);
  layers.levels.push_back(picture_level(input));
  for (std::size_t i = 1; i < layers.ladder.size(); ++i) {
    layers.levels.push_back(halve(layers.levels[i - 1], i == 1, layers.ladder[i - 1].beyond,
                                  layers.ladder[i].rungs[0].square));
  }
  for (std::size_t i = layers.levels.size(); i-- > 1;) {
    Level& level = layers.levels[i];
    const std::size_t pixels = level.sides[0].size();
    std::array<std::vector<Seen>, 2> seen{std::vector<Seen>(pixels), std::vector<Seen>(pixels)};
    pool.for_each(level.height, [&](int y) {
      for (int x = 0; x < level.width; ++x) {
        Seen& near = seen[0][level.at(x, y)];
        near = layers.nothing_before(i, x, y);
        layers.add_near(i, x, y, near);
        Seen& far = seen[1][level.at(x, y)];
        far = {0.0f, 0.0f, 0.0f, 1.0f};
        layers.add_far(i, x, y, far);
      }
    });
    level.seen = std::move(seen);
  }
  pool.for_each(result.height, [&](int y) {
    for (int x = 0; x < result.width; ++x) {
      Seen seen = layers.nothing_before(0, x, y);
      layers.add_near(0, x, y, seen);
      layers.add_rung(0, Side::far, 0, x, y, seen);
      layers.add_far(0, x, y, seen);
      const float scale = 1.0f / (1.0f - seen[3]);
      for (std::size_t c = 0; c < 3; ++c) seen[c] *= scale;
      store_span(input, result, x, y, 1, &seen[0], &seen[1], &seen[2], Isa::scalar);
    }
  });
}

}  // namespace softfocus
