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
#include "dof/disc_layers/disc_slopes.h"
#include "dof/disc_layers/lit_discs.h"
#include "dof/level_oracle.h"
#include "dof/picture_planes.h"

namespace softfocus {
namespace {

using Pixel = SideGrid::Pixel;
using Seen = SeenGrid::Pixel;

enum class SlowDiscSide { near, far };

struct SlowDiscLevel {
  int width, height;
  std::array<SideGrid, 2> sides;  // before the focus, and behind it with what is hidden
  std::array<SeenGrid, 2> seen;
  std::vector<Grid<1>> gains;  // of each of DiscHighlights::rungs
};

SideGrid picture_side(const DofInput& input, const ConstImageView& scene) {
  DofInput of = input;
  of.scene = scene;
  SideGrid side(scene.width, scene.height);
  for_each_pixel(scene.width, scene.height, [&](int x, int y) {
    const SplitTexel texel = split_texel(of, x, y);
    const float square = texel.radius_px * texel.radius_px;
    side.at(x, y) = {texel.r, texel.g, texel.b, 1.0f, texel.radius_px < 0.0f ? -square : square};
  });
  return side;
}

SlowDiscLevel picture_level(const DofInput& input, const HiddenPicture& hidden) {
  SlowDiscLevel level{input.scene.width, input.scene.height, {}, {}, {}};
  level.sides[0] = picture_side(input, input.scene);
  level.sides[1] = hidden.empty() ? level.sides[0] : picture_side(input, hidden.picture);
  return level;
}

SlowDiscLevel halve(const SlowDiscLevel& from, bool whole, RungStep beyond, float least) {
  const float near = whole ? -1.0f : 1.0f;
  return {(from.width + 1) / 2,
          (from.height + 1) / 2,
          {next_level(from.sides[0], near, beyond, least),
           next_level(from.sides[1], 1.0f, beyond, least)},
          {},
          {}};
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

struct SlowDiscLayers {
  std::vector<LevelRungs> ladder;
  std::vector<SlowDiscLevel> levels;
  DiscHighlights highlights;

  RungStep step_after(std::size_t level, std::size_t rung) const {
    const LevelRungs& rungs = ladder[level];
    return rung + 1 < rungs.rungs.size() ? rungs.rungs[rung + 1].step : rungs.beyond;
  }

  Shares shares(std::size_t level, SlowDiscSide side, std::size_t rung, const Pixel& pixel) const {
    const RungStep end = step_after(level, rung);
    if (level == 0 && rung == 0) {
      return {1.0f - share_from(end, std::fabs(pixel[kLevelSquare])),
              1.0f - share_from(end, -pixel[kLevelSquare])};
    }
    const float sign = level == 0 && side == SlowDiscSide::near ? -1.0f : 1.0f;
    const float square = sign * pixel[kLevelSquare];
    const float begun = share_from(ladder[level].rungs[rung].step, square);
    const float ended = share_from(end, square);
    return {begun - ended, side == SlowDiscSide::near ? 1.0f - pixel[kLevelWeight] * ended
                                                      : pixel[kLevelWeight] * begun};
  }

  float sum_of(std::size_t number, SlowDiscSide side, std::size_t rung, int x, int y,
               std::size_t channel) const {
    const SlowDiscLevel& level = levels[number];
    const SideGrid& pixels = level.sides[side == SlowDiscSide::near ? 0 : 1];
    return disc_sum(ladder[number].rungs[rung].spans, x, y, [&](int px, int py) {
      const Pixel& pixel = pixels.at(px, py);
      const Shares of = shares(number, side, rung, pixel);
      const Pixel& behind = level.sides[1].at(px, py);
      if (number == 0 && side == SlowDiscSide::near &&
          behind[kLevelSquare] != pixel[kLevelSquare]) {
        Pixel moved = behind;
        moved[kLevelSquare] = std::max(moved[kLevelSquare], kLeastHidden);
        const Shares of_hidden = shares(number, side, rung, moved);
        return channel == kLevelSquare ? of.seen + of_hidden.own
                                       : pixel[channel] * of.own + behind[channel] * of_hidden.own;
      }
      return channel == kLevelSquare ? of.seen : pixel[channel] * of.own;
    });
  }

  void add_rung(std::size_t number, SlowDiscSide side, std::size_t rung, int x, int y,
                Seen& seen) const {
    const float own = sum_of(number, side, rung, x, y, kLevelWeight);
    if (own == 0.0f) return;
    const float scale = seen[3] / sum_of(number, side, rung, x, y, kLevelSquare);
    for (std::size_t c = 0; c < 3; ++c) {
      seen[c] += sum_of(number, side, rung, x, y, c) * scale;
    }
    seen[3] = std::max(seen[3] - own * scale, 0.0f);
  }

  // How much of a rung's highlights is seen behind what is seen so far.
  float gain_of(std::size_t number, SlowDiscSide side, std::size_t rung, int x, int y,
                const Seen& seen) const {
    const float open = seen[3] * ladder[number].rungs[rung].area;
    if (!(open > 0.0f)) return 0.0f;
    const float most = most_gain(number, side == SlowDiscSide::near ? 0 : 1);
    return open / std::max(sum_of(number, side, rung, x, y, kLevelSquare), open * (1.0f / most));
  }

  void set_own_gains(std::size_t level, SlowDiscSide side, std::size_t rung, int x, int y,
                     const Seen& seen) {
    for (std::size_t i = 0; i < highlights.rungs.size(); ++i) {
      const LitRung& lit = highlights.rungs[i];
      if (lit.level != level || lit.number != rung ||
          lit.side != (side == SlowDiscSide::near ? 0 : 1)) {
        continue;
      }
      levels[level].gains[i].at(x, y) = {gain_of(level, side, rung, x, y, seen)};
    }
  }

  void set_larger_gains(std::size_t number, SlowDiscSide side, int x, int y, float open) {
    SlowDiscLevel& level = levels[number];
    for (std::size_t i = 0; i < highlights.rungs.size(); ++i) {
      const LitRung& lit = highlights.rungs[i];
      if (lit.level <= number || lit.side != (side == SlowDiscSide::near ? 0 : 1)) continue;
      const float gain = enlarged(levels[number + 1].gains[i], x, y)[0];
      level.gains[i].at(
          x, y) = {side == SlowDiscSide::near ? gain : std::min(open * gain, most_gain(number, 1))};
    }
  }

  void add_near(std::size_t level, int x, int y, Seen& seen) {
    set_larger_gains(level, SlowDiscSide::near, x, y, 1.0f);
    for (std::size_t i = ladder[level].rungs.size(); i-- > (level == 0 ? 1u : 0u);) {
      set_own_gains(level, SlowDiscSide::near, i, x, y, seen);
      add_rung(level, SlowDiscSide::near, i, x, y, seen);
    }
  }
  void add_far(std::size_t level, int x, int y, Seen& seen) {
    for (std::size_t i = level == 0 ? 1 : 0; i < ladder[level].rungs.size(); ++i) {
      set_own_gains(level, SlowDiscSide::far, i, x, y, seen);
      add_rung(level, SlowDiscSide::far, i, x, y, seen);
    }
    set_larger_gains(level, SlowDiscSide::far, x, y, seen[3]);
    if (level + 1 == levels.size()) return;
    add_behind(seen, enlarged(levels[level + 1].seen[1], x, y));
  }
  Seen nothing_before(std::size_t level, int x, int y) const {
    return level + 1 < levels.size() ? enlarged(levels[level + 1].seen[0], x, y)
                                     : Seen{0.0f, 0.0f, 0.0f, 1.0f};
  }

  void make_room_for_gains() {
    for (SlowDiscLevel& level : levels) {
      level.gains.assign(highlights.rungs.size(), Grid<1>(level.width, level.height));
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
      sum += levels[0].gains[i].at(x, y)[0] * light[channel];
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
  SlowDiscLayers layers;
  layers.ladder = disc_ladder_of(input);
  layers.highlights = find_highlights(input, layers.ladder, pool);
  DofInput rest = input;
  if (layers.highlights.rest.width != 0) rest.scene = layers.highlights.rest;
  const CentredDiscs centred = centre_discs(rest, pool);
  rest.scene = centred.picture;
  layers.levels.push_back(picture_level(rest, find(rest, pool)));
  for (std::size_t i = 1; i < layers.ladder.size(); ++i) {
    layers.levels.push_back(halve(layers.levels[i - 1], i == 1, layers.ladder[i - 1].beyond,
                                  layers.ladder[i].rungs[0].square));
  }
  layers.make_room_for_gains();
  for (std::size_t i = layers.levels.size(); i-- > 1;) {
    SlowDiscLevel& level = layers.levels[i];
    std::array<SeenGrid, 2> seen;
    seen.fill(SeenGrid(level.width, level.height));
    pool.for_each(level.height, [&](int y) {
      for (int x = 0; x < level.width; ++x) {
        Seen& near = seen[0].at(x, y);
        near = layers.nothing_before(i, x, y);
        layers.add_near(i, x, y, near);
        Seen& far = seen[1].at(x, y);
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
      layers.add_rung(0, SlowDiscSide::far, 0, x, y, seen);
      layers.add_far(0, x, y, seen);
      const float scale = 1.0f / (1.0f - seen[3]);
      for (std::size_t c = 0; c < 3; ++c) seen[c] *= scale;
      layers.add_lights(x, y, seen);
      store_span(input, result, x, y, 1, &seen[0], &seen[1], &seen[2], Isa::scalar);
    }
  });
}

}  // namespace softfocus
