// The oracle of mipmap.h: whole levels, pixel by pixel.

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "dof/level_oracle.h"
#include "dof/mipmap/mip_levels.h"
#include "dof/mipmap/mipmap.h"
#include "dof/picture_planes.h"

namespace softfocus {
namespace {

// Red, green and blue times weight, square times weight, weight.
using Holed = Grid<kHoledChannels>;
using Filled = Grid<kFilledChannels>;

Holed without_near(const SideGrid& picture, RungStep near) {
  Holed result(picture.width, picture.height);
  for_each_pixel(result.width, result.height, [&](int x, int y) {
    const auto& from = std::as_const(picture).at(x, y);
    const float weight = 1.0f - share_from(near, -from[kLevelSquare]);
    result.at(x, y) = {from[0] * weight, from[1] * weight, from[2] * weight,
                       std::max(from[kLevelSquare], 0.0f) * weight, weight};
  });
  return result;
}

Holed halved(const Holed& from) {
  Holed result = from.half();
  for_each_pixel(result.width, result.height, [&](int x, int y) {
    for (std::size_t i = 0; i < kHoledChannels; ++i) {
      const float left = from.at(2 * x, 2 * y)[i] + from.at(2 * x, 2 * y + 1)[i];
      const float right = from.at(2 * x + 1, 2 * y)[i] + from.at(2 * x + 1, 2 * y + 1)[i];
      result.at(x, y)[i] = 0.25f * (left + right);
    }
  });
  return result;
}

Filled filled(const Holed& from, const Filled* next) {
  Filled result(from.width, from.height);
  for_each_pixel(result.width, result.height, [&](int x, int y) {
    const auto& own = from.at(x, y);
    const float weight = own[kHoledWeight];
    const float inverse = weight > 0.0f ? 1.0f / weight : 0.0f;
    const float share = next == nullptr ? 1.0f : std::min(kFillGain * weight, 1.0f);
    const Filled::Pixel around = next == nullptr ? Filled::Pixel{} : enlarged(*next, x, y);
    for (std::size_t i = 0; i < kFilledChannels; ++i) {
      result.at(x, y)[i] = around[i] + share * (own[i] * inverse - around[i]);
    }
  });
  return result;
}

// The picture without what lies before the focus, its holes filled.
SideGrid fill_picture(const SideGrid& picture, RungStep near) {
  std::vector<Holed> levels;
  for (Holed level = halved(without_near(picture, near));; level = halved(level)) {
    levels.push_back(level);
    if (level.width == 1 && level.height == 1) break;
  }
  Filled fill = filled(levels.back(), nullptr);
  for (std::size_t i = levels.size() - 1; i-- > 0;) fill = filled(levels[i], &fill);
  SideGrid result(picture.width, picture.height);
  for_each_pixel(result.width, result.height, [&](int x, int y) {
    const auto& own = picture.at(x, y);
    const float hole = share_from(near, -own[kLevelSquare]);
    const Filled::Pixel around = enlarged(fill, x, y);
    const auto mixed = [&](float value, std::size_t channel) {
      return value + hole * (around[channel] - value);
    };
    result.at(x, y) = {mixed(own[0], 0), mixed(own[1], 1), mixed(own[2], 2), 1.0f,
                       mixed(std::max(own[kLevelSquare], 0.0f), kFilledSquare)};
  });
  return result;
}

std::vector<SideGrid> levels_of(SideGrid picture, const std::vector<MipLevelRungs>& ladder) {
  std::vector<SideGrid> levels{std::move(picture)};
  for (std::size_t i = 1; i < ladder.size(); ++i) {
    levels.push_back(
        next_level(levels.back(), 1.0f, ladder[i - 1].beyond, ladder[i].rungs[0].square));
  }
  return levels;
}

// A rung's filter about a pixel. Pixels that mirror each other are added first.
float filtered(const MipRung& rung, const SideGrid& from, std::size_t channel, int x, int y) {
  float sum = 0.0f;
  for (int dy = 0; dy <= rung.reach; ++dy) {
    const auto column = [&](int dx) {
      const float lower = from.at(x + dx, y + dy)[channel];
      return dy == 0 ? lower : from.at(x + dx, y - dy)[channel] + lower;
    };
    sum = sum + rung.weights[dy][0] * column(0);
    for (int dx = 1; dx <= rung.reach && rung.weights[dy][dx] > 0.0f; ++dx) {
      sum = sum + rung.weights[dy][dx] * (column(-dx) + column(dx));
    }
  }
  return sum;
}

// Adds a rung behind what is seen of nearer ones.
void add_rung(const SideGrid& level, const MipRung& rung, RungStep end, bool near, SeenGrid& seen) {
  SideGrid products(level.width, level.height);
  for_each_pixel(level.width, level.height, [&](int x, int y) {
    const auto& from = level.at(x, y);
    const float begun = share_from(rung.step, from[kLevelSquare]);
    const float ended = share_from(end, from[kLevelSquare]);
    const float share = begun - ended, weight = from[kLevelWeight];
    products.at(x, y) = {from[0] * share, from[1] * share, from[2] * share, weight * share,
                         near ? 1.0f - weight * ended : weight * begun};
  });
  for_each_pixel(level.width, level.height, [&](int x, int y) {
    const float all = filtered(rung, products, 4, x, y);
    auto& to = seen.at(x, y);
    const float scale = all > 0.0f ? to[kTransmitted] / all : 0.0f;
    for (std::size_t i = 0; i < 3; ++i) to[i] += filtered(rung, products, i, x, y) * scale;
    to[kTransmitted] =
        std::max(to[kTransmitted] - filtered(rung, products, kLevelWeight, x, y) * scale, 0.0f);
  });
}

RungStep end_of(const MipLevelRungs& rungs, std::size_t number) {
  return number + 1 == rungs.rungs.size() ? rungs.beyond : rungs.rungs[number + 1].step;
}

SeenGrid see_near(const SideGrid& level, const MipLevelRungs& rungs, const SeenGrid* larger,
                  bool whole) {
  SeenGrid seen(level.width, level.height);
  for_each_pixel(seen.width, seen.height, [&](int x, int y) {
    seen.at(x, y) =
        larger != nullptr ? enlarged(*larger, x, y) : SeenGrid::Pixel{0.0f, 0.0f, 0.0f, 1.0f};
  });
  for (std::size_t i = rungs.rungs.size(); i-- > (whole ? 1u : 0u);) {
    add_rung(level, rungs.rungs[i], end_of(rungs, i), true, seen);
  }
  return seen;
}

void see_far(const SideGrid& level, const MipLevelRungs& rungs, const SeenGrid* larger,
             SeenGrid& seen) {
  for (std::size_t i = 0; i < rungs.rungs.size(); ++i) {
    add_rung(level, rungs.rungs[i], end_of(rungs, i), false, seen);
  }
  if (larger == nullptr) return;
  for_each_pixel(seen.width, seen.height,
                 [&](int x, int y) { add_behind(seen.at(x, y), enlarged(*larger, x, y)); });
}

}  // namespace

void mipmap_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const int width = input.scene.width, height = input.scene.height;
  const std::vector<MipLevelRungs> ladder = make_mip_ladder(input.settings.max_coc_px);
  SideGrid picture(width, height), before(width, height);
  for_each_pixel(width, height, [&](int x, int y) {
    const SplitTexel texel = split_texel(input, x, y);
    const float square = texel.radius_px * texel.radius_px;
    picture.at(x, y) = {texel.r, texel.g, texel.b, 1.0f, texel.radius_px < 0.0f ? -square : square};
    before.at(x, y) = picture.at(x, y);
    before.at(x, y)[kLevelSquare] = std::max(-picture.at(x, y)[kLevelSquare], 0.0f);
  });
  const std::vector<SideGrid> far =
      levels_of(fill_picture(picture, ladder[0].rungs[1].step), ladder);
  const std::vector<SideGrid> near = levels_of(std::move(before), ladder);
  SeenGrid seen, behind;
  for (std::size_t i = ladder.size(); i-- > 0;) {
    const bool last = i + 1 == ladder.size();
    seen = see_near(near[i], ladder[i], last ? nullptr : &seen, i == 0);
    SeenGrid own(far[i].width, far[i].height);
    if (i == 0) {
      own = seen;
    } else {
      for (auto& pixel : own.pixels) pixel[kTransmitted] = 1.0f;
    }
    see_far(far[i], ladder[i], last ? nullptr : &behind, own);
    behind = std::move(own);
  }
  std::vector<float> rows[3];
  for (std::vector<float>& row : rows) row.resize(static_cast<std::size_t>(plane_stride(width)));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto& pixel = behind.at(x, y);
      const float scale = 1.0f / (1.0f - pixel[kTransmitted]);
      for (std::size_t i = 0; i < 3; ++i) rows[i][static_cast<std::size_t>(x)] = pixel[i] * scale;
    }
    store_row(input, result, y, rows[0].data(), rows[1].data(), rows[2].data(), pool.isa());
  }
}

}  // namespace softfocus
