// The oracle of mipmap.h: whole levels, pixel by pixel.

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "dof/mipmap/mip_levels.h"
#include "dof/mipmap/mipmap.h"
#include "dof/picture_planes.h"

namespace softfocus {
namespace {

template <std::size_t channels>
struct Grid {
  int width = 0, height = 0;
  std::vector<std::array<float, channels>> pixels;

  Grid() = default;
  Grid(int across, int down)
      : width(across), height(down), pixels(static_cast<std::size_t>(across * down)) {}
  // The edges repeat outwards.
  const std::array<float, channels>& at(int x, int y) const {
    const int inside = std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1);
    return pixels[static_cast<std::size_t>(inside)];
  }
  std::array<float, channels>& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y * width + x)];
  }
  Grid half() const { return Grid((width + 1) / 2, (height + 1) / 2); }
};
// Red, green and blue times weight, weight, square.
using Side = Grid<kLevelChannels>;
// Red, green and blue times weight, square times weight, weight.
using Holed = Grid<kHoledChannels>;
using Filled = Grid<kFilledChannels>;
using Seen = Grid<kSeenChannels>;

template <class Set>
void for_each_pixel(int width, int height, const Set& set) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) set(x, y);
  }
}

// From pixels of twice the size.
template <std::size_t channels>
float enlarged(const Grid<channels>& from, std::size_t channel, int x, int y) {
  const int inside_x = x / 2, other_x = x % 2 == 0 ? inside_x - 1 : inside_x + 1;
  const int inside_y = y / 2, other_y = y % 2 == 0 ? inside_y - 1 : inside_y + 1;
  const auto column = [&](int at) {
    return 0.75f * from.at(at, inside_y)[channel] + 0.25f * from.at(at, other_y)[channel];
  };
  return 0.75f * column(inside_x) + 0.25f * column(other_x);
}

Holed without_near(const Side& picture, RungStep near) {
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
    for (std::size_t i = 0; i < kFilledChannels; ++i) {
      const float around = next == nullptr ? 0.0f : enlarged(*next, i, x, y);
      result.at(x, y)[i] = around + share * (own[i] * inverse - around);
    }
  });
  return result;
}

// The picture without what lies before the focus, its holes filled.
Side fill_picture(const Side& picture, RungStep near) {
  std::vector<Holed> levels;
  for (Holed level = halved(without_near(picture, near));; level = halved(level)) {
    levels.push_back(level);
    if (level.width == 1 && level.height == 1) break;
  }
  Filled fill = filled(levels.back(), nullptr);
  for (std::size_t i = levels.size() - 1; i-- > 0;) fill = filled(levels[i], &fill);
  Side result(picture.width, picture.height);
  for_each_pixel(result.width, result.height, [&](int x, int y) {
    const auto& own = picture.at(x, y);
    const float hole = share_from(near, -own[kLevelSquare]);
    const auto mixed = [&](float value, std::size_t channel) {
      return value + hole * (enlarged(fill, channel, x, y) - value);
    };
    result.at(x, y) = {mixed(own[0], 0), mixed(own[1], 1), mixed(own[2], 2), 1.0f,
                       mixed(std::max(own[kLevelSquare], 0.0f), kFilledSquare)};
  });
  return result;
}

Side next_level(const Side& from, RungStep beyond, float least_square) {
  Side result = from.half();
  for_each_pixel(result.width, result.height, [&](int x, int y) {
    std::array<float, kLevelChannels> sums[2]{};
    for (int column = 0; column < 2; ++column) {
      for (int row = 0; row < 2; ++row) {
        const auto& pixel = from.at(2 * x + column, 2 * y + row);
        const float share = share_from(beyond, pixel[kLevelSquare]);
        const float weight = pixel[kLevelWeight] * share;
        for (std::size_t i = 0; i < 3; ++i) sums[column][i] += pixel[i] * share;
        sums[column][kLevelWeight] += weight;
        sums[column][kLevelSquare] += weight * std::max(pixel[kLevelSquare], least_square);
      }
    }
    auto& to = result.at(x, y);
    for (std::size_t i = 0; i < 4; ++i) to[i] = 0.25f * (sums[0][i] + sums[1][i]);
    const float weight = sums[0][kLevelWeight] + sums[1][kLevelWeight];
    const float square = sums[0][kLevelSquare] + sums[1][kLevelSquare];
    to[kLevelSquare] = weight > 0.0f ? square / weight : 0.0f;
  });
  return result;
}

std::vector<Side> levels_of(Side picture, const std::vector<MipLevelRungs>& ladder) {
  std::vector<Side> levels{std::move(picture)};
  for (std::size_t i = 1; i < ladder.size(); ++i) {
    levels.push_back(next_level(levels.back(), ladder[i - 1].beyond, ladder[i].rungs[0].square));
  }
  return levels;
}

// A rung's filter about a pixel. Pixels that mirror each other are added first.
float filtered(const MipRung& rung, const Side& from, std::size_t channel, int x, int y) {
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
void add_rung(const Side& level, const MipRung& rung, RungStep end, bool near, Seen& seen) {
  Side products(level.width, level.height);
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

Seen see_near(const Side& level, const MipLevelRungs& rungs, const Seen* larger, bool whole) {
  Seen seen(level.width, level.height);
  for_each_pixel(seen.width, seen.height, [&](int x, int y) {
    for (std::size_t i = 0; i < kSeenChannels; ++i) {
      seen.at(x, y)[i] =
          larger != nullptr ? enlarged(*larger, i, x, y) : (i == kTransmitted ? 1.0f : 0.0f);
    }
  });
  for (std::size_t i = rungs.rungs.size(); i-- > (whole ? 1u : 0u);) {
    add_rung(level, rungs.rungs[i], end_of(rungs, i), true, seen);
  }
  return seen;
}

void see_far(const Side& level, const MipLevelRungs& rungs, const Seen* larger, Seen& seen) {
  for (std::size_t i = 0; i < rungs.rungs.size(); ++i) {
    add_rung(level, rungs.rungs[i], end_of(rungs, i), false, seen);
  }
  if (larger == nullptr) return;
  for_each_pixel(seen.width, seen.height, [&](int x, int y) {
    auto& to = seen.at(x, y);
    const float open = to[kTransmitted];
    for (std::size_t i = 0; i < 3; ++i) to[i] += open * enlarged(*larger, i, x, y);
    to[kTransmitted] = open * enlarged(*larger, kTransmitted, x, y);
  });
}

}  // namespace

void mipmap_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const int width = input.scene.width, height = input.scene.height;
  const std::vector<MipLevelRungs> ladder = make_mip_ladder(input.settings.max_coc_px);
  Side picture(width, height), before(width, height);
  for_each_pixel(width, height, [&](int x, int y) {
    const SplitTexel texel = split_texel(input, x, y);
    const float square = texel.radius_px * texel.radius_px;
    picture.at(x, y) = {texel.r, texel.g, texel.b, 1.0f, texel.radius_px < 0.0f ? -square : square};
    before.at(x, y) = picture.at(x, y);
    before.at(x, y)[kLevelSquare] = std::max(-picture.at(x, y)[kLevelSquare], 0.0f);
  });
  const std::vector<Side> far = levels_of(fill_picture(picture, ladder[0].rungs[1].step), ladder);
  const std::vector<Side> near = levels_of(std::move(before), ladder);
  Seen seen, behind;
  for (std::size_t i = ladder.size(); i-- > 0;) {
    const bool last = i + 1 == ladder.size();
    seen = see_near(near[i], ladder[i], last ? nullptr : &seen, i == 0);
    Seen own(far[i].width, far[i].height);
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
