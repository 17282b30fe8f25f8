#include "dof/half_resolution/highlights.h"

#include <algorithm>
#include <cmath>

namespace softfocus {
namespace {

constexpr double kUnitsOfHighlights = 0x1p34;

std::int64_t units(double light) {
  return static_cast<std::int64_t>(std::nearbyint(light * kUnitsOfHighlights));
}

// Adds the ends of a span to a row of differences, three numbers a pixel.
void add_span(const Highlight& light, DiscSpan span, float weight, std::int64_t* differences) {
  if (span.whole < -1) return;
  std::int64_t* left = differences + 3 * (light.x - span.whole - 1);
  std::int64_t* right = differences + 3 * (light.x + span.whole + 1);
  for (int c = 0; c < 3; ++c) {
    const double value = static_cast<double>(light.excess[c]) * static_cast<double>(weight);
    const std::int64_t all = units(value), end = units(value * (0.125 * span.eighths));
    left[c] += end;
    left[3 + c] += all - end;
    right[c] += end - all;
    right[3 + c] -= end;
  }
}

}  // namespace

void highlight_excess(const SplitTexel& texel, float surroundings, float* excess) {
  const float light = std::max({texel.r, texel.g, texel.b});
  const float limit = kHighlightContrast * surroundings;
  const float share = std::clamp(2.0f * std::fabs(texel.radius_px) - 1.0f, 0.0f, 1.0f);
  const float part = light > limit && light > 0.0f ? (1.0f - limit / light) * share : 0.0f;
  excess[0] = texel.r * part;
  excess[1] = texel.g * part;
  excess[2] = texel.b * part;
}

int highlight_layer(float radius_px) {
  if (radius_px < 0.0f) return kHighlightNear;
  int octave = 0;
  for (float end = 2.0f; radius_px >= end && octave < kHighlightOctaves - 1; end *= 2.0f) ++octave;
  return octave;
}

float highlight_visible(int layer, float radius_px) {
  if (layer == kHighlightNear) return 1.0f;
  if (radius_px < 0.0f) return std::clamp(-radius_px - 2.0f, 0.0f, 1.0f);
  const float lower = static_cast<float>(1 << layer);
  return std::clamp(4.0f / lower * radius_px - 1.0f, 0.0f, 1.0f);
}

std::uint32_t highlight_row(const Highlights& highlights, int y, int width,
                            HighlightScratch& scratch, float* sums, std::ptrdiff_t stride) {
  const int margin = highlights.reach + 3;
  const std::ptrdiff_t layer_stride = 3 * (static_cast<std::ptrdiff_t>(width) + 2 * margin);
  scratch.differences.resize(static_cast<std::size_t>(kHighlightLayers * layer_stride));
  std::int64_t* differences = scratch.differences.data();
  const int height = static_cast<int>(highlights.rows.size());
  std::uint32_t used = 0;
  for (int from = std::max(y - highlights.reach, 0);
       from <= std::min(y + highlights.reach, height - 1); ++from) {
    const int dy = std::abs(from - y);
    const auto spans_at = static_cast<std::size_t>(dy * highlights.discs.count);
    for (const Highlight& light : highlights.rows[static_cast<std::size_t>(from)]) {
      const auto disc = static_cast<std::size_t>(light.disc);
      const bool above = (from >= y) != (light.layer == kHighlightNear);
      const ScatterDiscs& discs =
          above || highlights.below.spans.empty() ? highlights.discs : highlights.below;
      if (discs.reaches[disc] < dy) continue;
      used |= 1u << light.layer;
      add_span(light, discs.spans[spans_at + disc], discs.weights[disc],
               differences + light.layer * layer_stride + 3 * margin);
    }
  }
  for (int layer = 0; layer < kHighlightLayers; ++layer) {
    if ((used >> layer & 1u) == 0) continue;
    std::int64_t* change = differences + layer * layer_stride;
    std::int64_t sum[3] = {};
    for (int x = -margin; x < width; ++x, change += 3) {
      for (int c = 0; c < 3; ++c) {
        sum[c] += change[c];
        if (x >= 0) {
          sums[(3 * layer + c) * stride + x] =
              static_cast<float>(static_cast<double>(sum[c]) * (1.0 / kUnitsOfHighlights));
        }
      }
    }
    std::fill_n(differences + layer * layer_stride, layer_stride, std::int64_t{0});
  }
  return used;
}

}  // namespace softfocus
