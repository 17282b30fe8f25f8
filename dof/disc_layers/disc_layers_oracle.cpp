// The oracle of disc-layers: the equations of disc_layers.h, pixel by pixel.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "dof/disc_layers/disc_highlights.h"
#include "dof/disc_layers/disc_ladder.h"
#include "dof/disc_layers/disc_layers.h"
#include "dof/disc_layers/disc_levels.h"
#include "dof/disc_layers/lit_discs.h"
#include "dof/picture_planes.h"

namespace softfocus {
namespace {

constexpr std::size_t kWeight = 3, kSquare = 4;
using Pixel = std::array<float, 5>;  // colour times weight, weight, square
using Seen = std::array<float, 4>;   // colour, transmittance

enum class Side { near, far };

struct Level {
  int width, height;
  std::array<std::vector<Pixel>, 2> sides;  // before the focus, and behind it with what is hidden
  std::array<std::vector<Seen>, 2> seen;
  std::vector<std::vector<float>> gains;  // of each of DiscHighlights::rungs

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, height - 1)) *
               static_cast<std::size_t>(width) +
           static_cast<std::size_t>(std::clamp(x, 0, width - 1));
  }
};

std::vector<Pixel> picture_side(const DofInput& input, const ConstImageView& scene) {
  DofInput of = input;
  of.scene = scene;
  std::vector<Pixel> side;
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      const SplitTexel texel = split_texel(of, x, y);
      const float square = texel.radius_px * texel.radius_px;
      side.push_back({texel.r, texel.g, texel.b, 1.0f, texel.radius_px < 0.0f ? -square : square});
    }
  }
  return side;
}

Level picture_level(const DofInput& input, const HiddenPicture& hidden) {
  Level level{input.scene.width, input.scene.height, {}, {}, {}};
  level.sides[0] = picture_side(input, input.scene);
  level.sides[1] = hidden.empty() ? level.sides[0] : picture_side(input, hidden.picture);
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
  Level level{(from.width + 1) / 2, (from.height + 1) / 2, {}, {}, {}};
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
  DiscHighlights highlights;

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

  float sum_of(std::size_t number, Side side, std::size_t rung, int x, int y,
               std::size_t channel) const {
    const Level& level = levels[number];
    const std::vector<Pixel>& pixels = level.sides[side == Side::near ? 0 : 1];
    return disc_sum(ladder[number].rungs[rung].spans, x, y, [&](int px, int py) {
      const Pixel& pixel = pixels[level.at(px, py)];
      const Shares of = shares(number, side, rung, pixel);
      const Pixel& behind = level.sides[1][level.at(px, py)];
      if (number == 0 && side == Side::near && behind[kSquare] != pixel[kSquare]) {
        Pixel moved = behind;
        moved[kSquare] = std::max(moved[kSquare], kLeastHidden);
        const Shares of_hidden = shares(number, side, rung, moved);
        return channel == kSquare ? of.seen + of_hidden.own
                                  : pixel[channel] * of.own + behind[channel] * of_hidden.own;
      }
      return channel == kSquare ? of.seen : pixel[channel] * of.own;
    });
  }

  void add_rung(std::size_t number, Side side, std::size_t rung, int x, int y, Seen& seen) const {
    const float own = sum_of(number, side, rung, x, y, kWeight);
    if (own == 0.0f) return;
    const float scale = seen[3] / sum_of(number, side, rung, x, y, kSquare);
    for (std::size_t c = 0; c < 3; ++c) {
      seen[c] += sum_of(number, side, rung, x, y, c) * scale;
    }
    seen[3] = std::max(seen[3] - own * scale, 0.0f);
  }

  // How much of a rung's highlights is seen behind what is seen so far.
  float gain_of(std::size_t number, Side side, std::size_t rung, int x, int y,
                const Seen& seen) const {
    const float open = seen[3] * ladder[number].rungs[rung].area;
    if (!(open > 0.0f)) return 0.0f;
    const float most = most_gain(number, side == Side::near ? 0 : 1);
    return open / std::max(sum_of(number, side, rung, x, y, kSquare), open * (1.0f / most));
  }

  void set_own_gains(std::size_t level, Side side, std::size_t rung, int x, int y,
                     const Seen& seen) {
    for (std::size_t i = 0; i < highlights.rungs.size(); ++i) {
      const LitRung& lit = highlights.rungs[i];
      if (lit.level != level || lit.number != rung || lit.side != (side == Side::near ? 0 : 1)) {
        continue;
      }
      levels[level].gains[i][levels[level].at(x, y)] = gain_of(level, side, rung, x, y, seen);
    }
  }

  void set_larger_gains(std::size_t number, Side side, int x, int y, float open) {
    Level& level = levels[number];
    for (std::size_t i = 0; i < highlights.rungs.size(); ++i) {
      const LitRung& lit = highlights.rungs[i];
      if (lit.level <= number || lit.side != (side == Side::near ? 0 : 1)) continue;
      const Level& next = levels[number + 1];
      const float gain = enlarged(next, x, y, [&](std::size_t at) { return next.gains[i][at]; });
      level.gains[i][level.at(x, y)] =
          side == Side::near ? gain : std::min(open * gain, most_gain(number, 1));
    }
  }

  // A value of a level at a pixel of the level before.
  template <class ValueAt>
  static float enlarged(const Level& level, int x, int y, const ValueAt& value_at) {
    const int other_y = y / 2 + (y % 2 == 0 ? -1 : 1);
    const auto row = [&](int at) {
      return 0.75f * value_at(level.at(at, y / 2)) + 0.25f * value_at(level.at(at, other_y));
    };
    return 0.75f * row(x / 2) + 0.25f * row(x / 2 + (x % 2 == 0 ? -1 : 1));
  }
  Seen enlarged_seen(std::size_t number, std::size_t side, int x, int y) const {
    const Level& level = levels[number];
    Seen result;
    for (std::size_t c = 0; c < 4; ++c) {
      result[c] = enlarged(level, x, y, [&](std::size_t at) { return level.seen[side][at][c]; });
    }
    return result;
  }

  void add_near(std::size_t level, int x, int y, Seen& seen) {
    set_larger_gains(level, Side::near, x, y, 1.0f);
    for (std::size_t i = ladder[level].rungs.size(); i-- > (level == 0 ? 1u : 0u);) {
      set_own_gains(level, Side::near, i, x, y, seen);
      add_rung(level, Side::near, i, x, y, seen);
    }
  }
  void add_far(std::size_t level, int x, int y, Seen& seen) {
    for (std::size_t i = level == 0 ? 1 : 0; i < ladder[level].rungs.size(); ++i) {
      set_own_gains(level, Side::far, i, x, y, seen);
      add_rung(level, Side::far, i, x, y, seen);
    }
    set_larger_gains(level, Side::far, x, y, seen[3]);
    if (level + 1 == levels.size()) return;
    const Seen behind = enlarged_seen(level + 1, 1, x, y);
    const float open = seen[3];
    for (std::size_t c = 0; c < 3; ++c) seen[c] += open * behind[c];
    seen[3] = open * behind[3];
  }
  Seen nothing_before(std::size_t level, int x, int y) const {
    return level + 1 < levels.size() ? enlarged_seen(level + 1, 0, x, y)
                                     : Seen{0.0f, 0.0f, 0.0f, 1.0f};
  }

  void make_room_for_gains() {
    for (Level& level : levels) {
      level.gains.assign(highlights.rungs.size(), std::vector<float>(level.sides[0].size()));
    }
  }

  void add_lights(int x, int y, Seen& seen) const {
    for (std::size_t c = 0; c < 3; ++c) seen[c] += lit_at(x, y, c);
  }
  float lit_at(int x, int y, std::size_t channel) const {
    float sum = 0.0f;
    for (std::size_t i = 0; i < highlights.rungs.size(); ++i) {
      float light[3];
      light_at(highlights, highlights.rungs[i], x, y, light);
      sum += levels[0].gains[i][levels[0].at(x, y)] * light[channel];
    }
    return sum;
  }
};

}  // namespace

void disc_layers_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  blur_discs_oracle(input, result, pool,
                    [](const DofInput& rest, ThreadPool&) { return find_hidden_oracle(rest); });
}

void blur_discs_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool,
                       FindHidden find) {
  Layers layers;
  layers.ladder = disc_ladder_of(input);
  layers.highlights = find_highlights(input, layers.ladder, pool);
  DofInput rest = input;
  if (layers.highlights.rest.width != 0) rest.scene = layers.highlights.rest;
  layers.levels.push_back(picture_level(rest, find(rest, pool)));
  for (std::size_t i = 1; i < layers.ladder.size(); ++i) {
    layers.levels.push_back(halve(layers.levels[i - 1], i == 1, layers.ladder[i - 1].beyond,
                                  layers.ladder[i].rungs[0].square));
  }
  layers.make_room_for_gains();
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
      layers.add_lights(x, y, seen);
      store_span(input, result, x, y, 1, &seen[0], &seen[1], &seen[2], Isa::scalar);
    }
  });
}

}  // namespace softfocus
