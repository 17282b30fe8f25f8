#include "scenes/auto/tile_sample.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "dof/measure/flip.h"
#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/pipeline/draw_call.h"
#include "raster/pipeline/state.h"

namespace softfocus {
namespace {

constexpr double kLeastWeight = 1.0 / 500.0;

float seen(std::uint16_t half) {
  const float value = half_to_float(half);
  return value > 0.0f ? std::sqrt(std::min(value, 1.0f)) : 0.0f;  // NaN is black
}

Rectangle area_of(const TileSample& sample, int tile) {
  const int x = tile % sample.tiles_x * kTileSize, y = tile / sample.tiles_x * kTileSize;
  return {x, y, std::min(x + kTileSize, sample.width), std::min(y + kTileSize, sample.height)};
}

double pixels_of(const Rectangle& area) {
  return static_cast<double>(area.x_end - area.x_begin) * (area.y_end - area.y_begin);
}

// The mean change over the tile's pixels, times its share of a whole tile.
double weight_of(const Image& sharp, const Image& blurred, const Rectangle& area) {
  double sum = 0.0;
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const auto a = row<std::uint16_t>(sharp, y), b = row<std::uint16_t>(blurred, y);
    for (auto x = static_cast<std::size_t>(area.x_begin); x < static_cast<std::size_t>(area.x_end);
         ++x) {
      float most = 0.0f;
      for (std::size_t i = 4 * x; i < 4 * x + 3; ++i) {
        if (a[i] != b[i]) most = std::max(most, std::fabs(seen(a[i]) - seen(b[i])));
      }
      sum += static_cast<double>(most);
    }
  }
  return (sum + kLeastWeight * pixels_of(area)) / (kTileSize * kTileSize);
}

// Chances proportional to the weights, those above 1 cut, that sum up to `count`.
std::vector<double> chances_of(const std::vector<double>& weights, double count) {
  std::vector<double> chances(weights.size(), 0.0);
  for (bool is_settled = false; !is_settled;) {
    is_settled = true;
    double left = count, sum = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (chances[i] == 1.0) left -= 1.0;
      if (chances[i] != 1.0) sum += weights[i];
    }
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (chances[i] == 1.0) continue;
      chances[i] = std::min(weights[i] * left / sum, 1.0);
      is_settled = is_settled && chances[i] != 1.0;
    }
  }
  return chances;
}

Image cropped(const Image& picture, const Rectangle& area) {
  Image crop = make_image(picture.format, area.x_end - area.x_begin, area.y_end - area.y_begin);
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const auto from = row<std::uint16_t>(picture, y);
    const auto to = row<std::uint16_t>(crop, y - area.y_begin);
    std::memcpy(to.data(), from.data() + 4 * static_cast<std::size_t>(area.x_begin),
                to.size_bytes());
  }
  return crop;
}

}  // namespace

TileSample sample_tiles(const Image& sharp, const Image& blurred, int count, ThreadPool& pool) {
  TileSample sample{sharp.width, sharp.height, (sharp.width + kTileSize - 1) / kTileSize, {}};
  const int tiles = sample.tiles_x * ((sharp.height + kTileSize - 1) / kTileSize);
  std::vector<double> weights(static_cast<std::size_t>(tiles));
  pool.for_each(tiles, [&](int tile) {
    weights[static_cast<std::size_t>(tile)] = weight_of(sharp, blurred, area_of(sample, tile));
  });
  const std::vector<double> chances = chances_of(weights, std::min(count, tiles));
  // A tile is taken when the sum of the chances passes 1/2, 3/2, 5/2, ...
  double passed = 0.5;
  for (int tile = 0; tile < tiles; ++tile) {
    const double chance = chances[static_cast<std::size_t>(tile)];
    passed += chance;
    if (chance < 1.0 && passed < 1.0) continue;
    passed -= 1.0;
    sample.tiles.push_back({tile, chance});
  }
  return sample;
}

Estimate flip_of_tiles(const TileSample& sample, const Image& truth, const Image& test,
                       ThreadPool& pool) {
  const ToneTable tone = clamped_tone();
  std::vector<double> values(sample.tiles.size());
  pool.for_each(static_cast<int>(values.size()), [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    const Rectangle area = area_of(sample, sample.tiles[index].tile);
    ThreadPool one{1, pool.isa()};
    const PixelMap flip = flip_map(cropped(truth, area), cropped(test, area), tone, one);
    values[index] = mean(flip) * pixels_of(area) / sample.tiles[index].chance;
  });
  double sum = 0.0, doubt = 0.0, doubtful = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double left_out = 1.0 - sample.tiles[i].chance;
    sum += values[i];
    doubt += left_out;
    doubtful += left_out * values[i];
  }
  double variance = 0.0;
  int uncertain = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double left_out = 1.0 - sample.tiles[i].chance;
    if (left_out <= 0.0) continue;
    ++uncertain;
    const double off = values[i] - doubtful / doubt;
    variance += left_out * off * off;
  }
  if (uncertain > 1) variance *= static_cast<double>(uncertain) / (uncertain - 1);
  const double pixels = static_cast<double>(sample.width) * sample.height;
  return {sum / pixels, std::sqrt(variance) / pixels};
}

}  // namespace softfocus
