#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/scatter/layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "dof/picture_planes.h"
#include "dof/scatter/layer_planes.h"
#include "dof/scatter/scatter_discs.h"
#include "raster/images/image.h"
#include "raster/threads/loops.h"

#define SOFTFOCUS_KERNELS "dof/scatter/layers.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kLayerRows = 8;

// Red, green, blue and weight.
using Light = std::array<std::uint64_t, 4>;

// Pixels that spread light, row by row.
struct Sheet {
  std::vector<std::size_t> begins;  // of each row, and the end of the last
  std::vector<int> x;
  std::vector<std::uint16_t> disc;
  std::vector<float> light;  // of a pixel: four numbers, as in Light
  std::vector<int> reach;    // of a row: rows that its largest disc reaches
};

// A layer's sheet holds its light, or what it lets through.
enum class Part { light, clear };

// A pixel's share in a part of its layer.
float share_of(Part part, float opacity) { return part == Part::light ? opacity : 1.0f - opacity; }

Sheet make_sheet(const Planes& layer, Part part, const ScatterDiscs& discs, const TileMask& needed,
                 ThreadPool& pool) {
  Sheet sheet;
  sheet.begins.resize(static_cast<std::size_t>(layer.height) + 1);
  sheet.reach.assign(static_cast<std::size_t>(layer.height), -1);
  const auto spreads = [&](int x, int y, const float* from) {
    return share_of(part, from[kLayerOpacity * layer.plane]) > 0.0f && is_set(needed, x, y);
  };
  pool.for_each(layer.height, [&](int y) {
    const float* from = plane_row(layer, 0, y);
    std::size_t count = 0;
    for (int x = 0; x < layer.width; ++x) count += spreads(x, y, from + x) ? 1 : 0;
    sheet.begins[static_cast<std::size_t>(y) + 1] = count;
  });
  for (std::size_t y = 1; y < sheet.begins.size(); ++y) sheet.begins[y] += sheet.begins[y - 1];
  sheet.x.resize(sheet.begins.back());
  sheet.disc.resize(sheet.begins.back());
  sheet.light.resize(4 * sheet.begins.back());
  pool.for_each(layer.height, [&](int y) {
    const auto row = static_cast<std::size_t>(y);
    std::size_t at = sheet.begins[row];
    for (int x = 0; x < layer.width; ++x) {
      const float* from = plane_row(layer, 0, y) + x;
      if (!spreads(x, y, from)) continue;
      const auto disc = static_cast<std::size_t>(disc_of(from[kLayerRadius * layer.plane]));
      const float weight = discs.weights[disc] * kUnitsOfLight;
      sheet.x[at] = x;
      sheet.disc[at] = static_cast<std::uint16_t>(disc);
      float* light = &sheet.light[4 * at++];
      for (int i = 0; i < 3; ++i) {
        light[i] = part == Part::light ? from[i * layer.plane] * weight : 0.0f;
      }
      light[3] = share_of(part, from[kLayerOpacity * layer.plane]) * weight;
      sheet.reach[row] = std::max(sheet.reach[row], discs.reaches[disc]);
    }
  });
  return sheet;
}

// The layers of a picture, each as its light and what it lets through. The far one is whole.
struct Layers {
  int width = 0, height = 0;
  ScatterDiscs discs;
  Sheet near, near_clear, mid, mid_clear, far;
};

// The radii of a part's pixels, as its tiles need them.
TileReach reach_of(const Planes& layer, Part part, const ScatterDiscs& discs, ThreadPool& pool) {
  return tile_reach(layer.width, layer.height, pool, [&](int x, int y) {
    const float* from = plane_row(layer, 0, y) + x;
    if (share_of(part, from[kLayerOpacity * layer.plane]) <= 0.0f) return -1;
    return discs.reaches[static_cast<std::size_t>(disc_of(from[kLayerRadius * layer.plane]))];
  });
}

// Leaves out pixels whose light does not matter: what a layer lets through where it has no
// light, and the light behind what lets nothing through. With `all` nothing is left out, which
// gives the same bits.
Layers make_layers(const DofInput& input, bool all, ThreadPool& pool) {
  const Planes scene = split_picture(input, pool);
  const std::vector<float> largest = largest_of_rows(scene, 3, pool);
  const int width = scene.width, height = scene.height;
  const LayerSplit split = split_layers(scene);
  Layers layers{width, height, make_discs(*std::max_element(largest.begin(), largest.end())),
                {},    {},     {},
                {},    {}};
  const ScatterDiscs& discs = layers.discs;
  TileMask open = full_mask(width, height);  // where light from behind can be seen
  const auto add_layer = [&](const Planes& layer, Sheet& light, Sheet& clear) {
    const TileReach of_light = reach_of(layer, Part::light, discs, pool);
    const TileReach of_clear = reach_of(layer, Part::clear, discs, pool);
    const TileMask lit = all ? open : both(open, touched(of_light));
    light = make_sheet(layer, Part::light, discs, touching(of_light, open), pool);
    clear = make_sheet(layer, Part::clear, discs, touching(of_clear, lit), pool);
    if (!all) open = both(open, touched(of_clear));
  };
  add_layer(near_layer(scene, split, pool), layers.near, layers.near_clear);
  add_layer(mid_layer(scene, split, pool), layers.mid, layers.mid_clear);
  Sheet none;
  add_layer(far_layer(scene, split, pool), layers.far, none);
  return layers;
}

// The light that meets in a pixel, of each sheet.
struct Meeting {
  Light near{}, near_clear{}, mid{}, mid_clear{}, far{};
};

struct Colour {
  float r, g, b;
};

double number(std::uint64_t units) { return static_cast<double>(static_cast<std::int64_t>(units)); }

Colour composite(const Meeting& meeting) {
  const double near = number(meeting.near[3]), mid = number(meeting.mid[3]);
  const double far = number(meeting.far[3]);
  // A layer's own scale, and how much of what is behind it is seen.
  const double near_scale = near > 0.0 ? 1.0 / (near + number(meeting.near_clear[3])) : 0.0;
  const double past_near = 1.0 - near * near_scale;
  const double mid_scale = mid > 0.0 ? past_near / (mid + number(meeting.mid_clear[3])) : 0.0;
  const double past_mid = past_near - mid * mid_scale;
  const double far_scale = far > 0.0 ? past_mid / far : 0.0;
  const double reached = near * near_scale + mid * mid_scale + far * far_scale;
  const auto channel = [&](std::size_t i) {
    return static_cast<float>((number(meeting.near[i]) * near_scale +
                               number(meeting.mid[i]) * mid_scale +
                               number(meeting.far[i]) * far_scale) /
                              reached);
  };
  return {channel(0), channel(1), channel(2)};
}

constexpr std::size_t kSheets = 5;

// In the order of Meeting.
const Sheet& sheet(const Layers& layers, std::size_t i) {
  const std::array<const Sheet*, kSheets> sheets{&layers.near, &layers.near_clear, &layers.mid,
                                                 &layers.mid_clear, &layers.far};
  return *sheets[i];
}

// Adds what the rows of a sheet give to row y.
void stamp(const Sheet& sheet, const ScatterDiscs& discs, int width, int y,
           std::vector<Light>& sums) {
  for (int from_y = 0; from_y + 1 < static_cast<int>(sheet.begins.size()); ++from_y) {
    const int dy = std::abs(from_y - y);
    if (dy > discs.reach) continue;
    const auto row = static_cast<std::size_t>(from_y);
    for (std::size_t at = sheet.begins[row]; at < sheet.begins[row + 1]; ++at) {
      const DiscSpan span =
          discs.spans[static_cast<std::size_t>(dy * discs.count) + sheet.disc[at]];
      const int reach = span.whole + 1, from_x = sheet.x[at];
      for (int x = std::max(from_x - reach, 0); x <= std::min(from_x + reach, width - 1); ++x) {
        for (std::size_t i = 0; i < 4; ++i) {
          const double light = sheet.light[4 * at + i];
          const std::uint64_t all = whole_units(light),
                              end = whole_units(light * (0.125 * span.eighths));
          const bool inside = std::abs(x - from_x) < reach;
          sums[static_cast<std::size_t>(x)][i] += inside ? all : reach == 0 ? end + end - all : end;
        }
      }
    }
  }
}

}  // namespace

void layers_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const Layers layers = make_layers(input, true, pool);
  const auto width = static_cast<std::size_t>(layers.width);
  pool.for_each(layers.height, [&](int y) {
    if (!input.kept.has_row(y)) return;
    std::array<std::vector<Light>, kSheets> sums;
    for (std::size_t i = 0; i < kSheets; ++i) {
      sums[i].resize(width);
      stamp(sheet(layers, i), layers.discs, layers.width, y, sums[i]);
    }
    std::vector<float> colour(3 * width);
    for (std::size_t x = 0; x < width; ++x) {
      const Colour out = composite({sums[0][x], sums[1][x], sums[2][x], sums[3][x], sums[4][x]});
      colour[x] = out.r;
      colour[x + width] = out.g;
      colour[x + 2 * width] = out.b;
    }
    store_row(input, result, y, colour.data(), colour.data() + width, colour.data() + 2 * width,
              Isa::scalar);
  });
}

namespace {

using Differences = std::vector<std::uint64_t, RowAllocator<std::uint64_t>>;

struct SheetRows {
  // Differences of each sheet, with a margin on either side; no four numbers across two cache
  // lines.
  std::array<Differences, kSheets> differences;
  std::vector<float> colour;
};

// Adds the spans of all rows that reach row y. Whether there are any.
bool add_spans(const Sheet& sheet, const ScatterDiscs& discs, int y, Isa isa,
               std::uint64_t* differences) {
  bool any = false;
  const int height = static_cast<int>(sheet.reach.size());
  const int end = std::min(y + discs.reach, height - 1);
  for (int from = std::max(y - discs.reach, 0); from <= end; ++from) {
    const int dy = std::abs(from - y);
    const auto row = static_cast<std::size_t>(from);
    if (sheet.reach[row] < dy) continue;
    any = true;
    const std::size_t begin = sheet.begins[row];
    SOFTFOCUS_KERNEL(isa, scatter_list)
    (&sheet.light[4 * begin], &sheet.x[begin], &sheet.disc[begin], sheet.begins[row + 1] - begin,
     &discs.spans[static_cast<std::size_t>(dy) * static_cast<std::size_t>(discs.count)],
     differences);
  }
  return any;
}

void layers_lanes(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const Layers layers = make_layers(input, false, pool);
  const int width = layers.width, height = layers.height;
  const int margin = layers.discs.reach + 3;
  const auto length = static_cast<std::size_t>(4 * (width + 2 * margin));
  const std::ptrdiff_t padded = plane_stride(width);
  for_each_row_with<SheetRows>(pool, height, kLayerRows, [&](int y, auto& buffers) {
    for (Differences& differences : buffers.differences) differences.resize(length);
    buffers.colour.resize(static_cast<std::size_t>(3 * padded));
    float* colour = buffers.colour.data();
    if (!input.kept.has_row(y)) return;
    std::array<bool, kSheets> any;
    for (std::size_t i = 0; i < kSheets; ++i) {
      any[i] = add_spans(sheet(layers, i), layers.discs, y, pool.isa(),
                         buffers.differences[i].data() + 4 * margin);
    }
    Meeting sums;
    const std::array<Light*, kSheets> lights{&sums.near, &sums.near_clear, &sums.mid,
                                             &sums.mid_clear, &sums.far};
    for (int x = -margin; x < width; ++x) {
      for (std::size_t i = 0; i < kSheets; ++i) {
        if (!any[i]) continue;
        const std::uint64_t* change = buffers.differences[i].data() + 4 * (x + margin);
        for (std::size_t j = 0; j < 4; ++j) (*lights[i])[j] += change[j];
      }
      if (x < 0) continue;
      const Colour out = composite(sums);
      colour[x] = out.r;
      colour[padded + x] = out.g;
      colour[2 * padded + x] = out.b;
    }
    for (std::size_t i = 0; i < kSheets; ++i) {
      if (any[i]) std::fill(buffers.differences[i].begin(), buffers.differences[i].end(), 0);
    }
    store_row(input, result, y, colour, colour + padded, colour + 2 * padded, pool.isa());
  });
}

}  // namespace

void layers(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  (pool.isa() == Isa::scalar ? layers_oracle : layers_lanes)(input, result, pool);
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/scatter/scatter_spans.inl"

}  // namespace

/// Adds the spans of `count` pixels to a row of differences. `spans` are those of all discs at
/// the |dy| between the two rows; `differences` points at the place of x = 0.
void scatter_list(const float* light, const int* x, const std::uint16_t* disc, std::size_t count,
                  const DiscSpan* spans, std::uint64_t* differences) {
  for (std::size_t i = 0; i < count; ++i) {
    const DiscSpan span = spans[disc[i]];
    if (span.whole >= -1) add_span(differences + 4 * x[i], light + 4 * i, span);
  }
}

#endif
