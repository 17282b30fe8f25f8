#include "dof/half_resolution/fill_holes.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "raster/threads/loops.h"

namespace softfocus {
namespace {

// All missing: then the cells' own values stand for each other.
constexpr float kLeastWeight = 0x1p-40f;

// A plane of an even width has 2 values to one of the next, at 2x and 2x + 1. An odd one has
// 2x - 1, 2x and 2x + 1, the outer two by half: a mirrored picture is filled mirrored.
int coarse_size(int size) { return (size + 1) / 2; }

// Between which rows of a coarser plane a fine one lies, and how near to the second.
struct Between {
  int first, second;
  float share;
};
Between between(int at, int size) {
  if (size % 2 != 0) return {at / 2, (at + 1) / 2, at % 2 == 0 ? 0.0f : 0.5f};
  return {at / 2, std::clamp(at % 2 == 0 ? at / 2 - 1 : at / 2 + 1, 0, size / 2 - 1), 0.25f};
}

// The same along a row, of `width` values; `coarse` has room for one before and one after.
void enlarge(float* coarse, int width, float* to) {
  const int count = coarse_size(width);
  coarse[-1] = coarse[0];
  coarse[count] = coarse[count - 1];
  const bool odd = width % 2 != 0;
  for (int x = 0; x < count; ++x) {
    const float own = coarse[x];
    to[2 * x] = odd ? own : own + 0.25f * (coarse[x - 1] - own);
    to[2 * x + 1] = own + (odd ? 0.5f : 0.25f) * (coarse[x + 1] - own);
  }
}

// A level's values n c come first, then n.
struct Puller {
  const Planes& from;
  std::span<const int> channels;
  int weight;
  bool premultiplied;  // whether `from` has n c
  Planes& to;
};

// Adds up the rows that make row `y` of the next level.
void sum_rows(const Puller& pull, int channel, int y, float* sums) {
  const int width = pull.from.width, height = pull.from.height;
  const bool odd = height % 2 != 0;
  std::fill_n(sums, width, 0.0f);
  // The outer two first.
  const int rows[] = {odd ? 2 * y - 1 : 2 * y, 2 * y + 1, odd ? 2 * y : -1};
  const float shares[] = {odd ? 0.5f : 1.0f, odd ? 0.5f : 1.0f, 1.0f};
  for (int i = 0; i < 3; ++i) {
    if (rows[i] < 0 || rows[i] >= height) continue;
    const float* n = plane_row(pull.from, pull.weight, rows[i]);
    const float* value = plane_row(pull.from, channel, rows[i]);
    const float share = shares[i];
    if (pull.premultiplied) {
      for (int x = 0; x < width; ++x) sums[x] += share * value[x];
    } else if (channel == pull.weight) {
      for (int x = 0; x < width; ++x) sums[x] += share * std::max(n[x], kLeastWeight);
    } else {
      for (int x = 0; x < width; ++x) sums[x] += share * (std::max(n[x], kLeastWeight) * value[x]);
    }
  }
}

void halve_sums(const float* sums, int width, float* to) {
  const int half = coarse_size(width);
  if (width % 2 == 0) {
    for (int x = 0; x < half; ++x) to[x] = sums[2 * x] + sums[2 * x + 1];
    return;
  }
  for (int x = 0; x < half; ++x) {
    const float left = x > 0 ? sums[2 * x - 1] : 0.0f;
    const float right = 2 * x + 1 < width ? sums[2 * x + 1] : 0.0f;
    to[x] = 0.5f * (left + right) + sums[2 * x];
  }
}

void pull_level(const Puller& pull, ThreadPool& pool) {
  const int count = static_cast<int>(pull.channels.size());
  for_each_with<std::vector<float>>(pool, pull.to.height, [&](int y, auto& sums) {
    sums.resize(static_cast<std::size_t>(pull.from.width));
    for (int c = 0; c <= count; ++c) {
      const int channel = c < count ? pull.channels[static_cast<std::size_t>(c)] : pull.weight;
      sum_rows(pull, channel, y, sums.data());
      halve_sums(sums.data(), pull.from.width, plane_row(pull.to, c, y));
    }
    float* n = plane_row(pull.to, count, y);
    for (int x = 0; x < pull.to.width; ++x) {
      if (n[x] <= 1.0f) continue;
      const float scale = 1.0f / n[x];
      for (int c = 0; c < count; ++c) plane_row(pull.to, c, y)[x] *= scale;
      n[x] = 1.0f;
    }
  });
}

// Adds to the cells of `fine` what they lack from the coarser level, where n is less than
// `enough`: blend(channel, n, cell, around).
template <class Blend>
void push_level(Planes& fine, std::span<const int> channels, int weight, float enough,
                const Planes& coarse, const Blend& blend, ThreadPool& pool) {
  for_each_with<std::vector<float>>(pool, fine.height, [&](int y, auto& scratch) {
    const float* n = plane_row(fine, weight, y);
    if (*std::min_element(n, n + fine.width) >= enough) return;
    scratch.resize(static_cast<std::size_t>(coarse.width + 2 + fine.width + 1));
    float* along = scratch.data() + 1;
    float* around = along + coarse.width + 1;
    const Between down = between(y, fine.height);
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const float* first = plane_row(coarse, static_cast<int>(c), down.first);
      const float* second = plane_row(coarse, static_cast<int>(c), down.second);
      for (int x = 0; x < coarse.width; ++x) {
        along[x] = first[x] + down.share * (second[x] - first[x]);
      }
      enlarge(along, fine.width, around);
      float* values = plane_row(fine, channels[c], y);
      for (int x = 0; x < fine.width; ++x) {
        const float blended = blend(n[x], values[x], around[x]);
        values[x] = n[x] < enough ? blended : values[x];
      }
    }
  });
}

}  // namespace

void fill_holes(Planes& planes, std::span<const int> channels, int weight, ThreadPool& pool) {
  const int count = static_cast<int>(channels.size());
  std::vector<int> in_order(channels.size());
  std::iota(in_order.begin(), in_order.end(), 0);
  std::vector<Planes> levels;
  int width = planes.width, height = planes.height;
  while (width > 1 || height > 1) {
    width = coarse_size(width);
    height = coarse_size(height);
    levels.push_back(make_planes(count + 1, width, height, pool));
    if (levels.size() == 1) {
      pull_level({planes, channels, weight, false, levels.back()}, pool);
    } else {
      pull_level({levels[levels.size() - 2], in_order, count, true, levels.back()}, pool);
    }
  }
  if (levels.empty()) return;
  for (int c = 0; c < count; ++c) {
    plane_row(levels.back(), c, 0)[0] /= plane_row(levels.back(), count, 0)[0];
  }
  const auto add = [](float n, float value, float around) { return value + (1.0f - n) * around; };
  for (std::size_t i = levels.size() - 1; i > 0; --i) {
    push_level(levels[i - 1], in_order, count, 1.0f, levels[i], add, pool);
  }
  const auto replace = [](float n, float value, float around) {
    return around + 4.0f * n * (value - around);
  };
  push_level(planes, channels, weight, 0.25f, levels.front(), replace, pool);
}

}  // namespace softfocus
