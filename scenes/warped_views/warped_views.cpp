#include "scenes/warped_views/warped_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "dof/lens.h"
#include "raster/threads/loops.h"
#include "scenes/filtered_views/filtered_views.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/lens_views/lens_points.h"
#include "scenes/warped_views/warped_colours.h"

namespace softfocus {
namespace {

// Size of the picture that is warped in one go: its data, 1 MiB, stay in a core's cache.
constexpr int kWarpTileWidth = 4 * kSumTile, kWarpTileHeight = kSumTile;

// Views that are added in binary32 before they go to the sum in binary64: an error below 2^-18 of
// the largest. By kSampleGroup that would take a twentieth of the warps' time.
constexpr std::size_t kSettledViews = 64;

// Wider margins would be drawn for the sake of a few pixels.
constexpr int kMostMarginPx = 64;

struct WarpMemory {
  WarpTile tile;
  WarpedColours sums;
  std::array<std::vector<double>, 3> totals;  // of red, green and blue
};

// A source as a view asks it.
struct AskedSource {
  const WarpSource* source;
  glm::vec2 shift;
};

float length_squared(glm::vec2 v) { return v.x * v.x + v.y * v.y; }

// The nearest first.
std::vector<AskedSource> asked_sources(std::span<const WarpSource> sources, glm::dvec2 point) {
  std::vector<AskedSource> asked;
  asked.reserve(sources.size());
  for (const WarpSource& source : sources) asked.push_back({&source, warp_shift(source, point)});
  std::stable_sort(asked.begin(), asked.end(), [](const AskedSource& a, const AskedSource& b) {
    return length_squared(a.shift) < length_squared(b.shift);
  });
  return asked;
}

// A pixel beside a hole that is none; its radius is noted.
struct Beside {
  bool is_there = false;
  int x = 0, y = 0;
  float radius = 0.0f;
};

// Finds what is next to a tile's holes on the left, the right, above and below, within the tile.
// Holes are asked for row by row; runs of them are walked along once.
class HoleBorders {
 public:
  explicit HoleBorders(const WarpTile& tile) : tile_{tile} {
    const int width = tile.area.x_end - tile.area.x_begin;
    columns_.assign(static_cast<std::size_t>(width), {kNone, kNone, kNone});
  }

  // The farthest of the four.
  Beside farthest(int x, int y) {
    const Rectangle& area = tile_.area;
    if (y != y_ || x != x_ + 1) {
      left_ = x - 1;
      right_ = x + 1;
      while (right_ < area.x_end && is_hole(right_, y)) ++right_;
    }
    x_ = x;
    y_ = y;
    Column& column = columns_[static_cast<std::size_t>(x - area.x_begin)];
    if (column.last_y != y - 1) {
      column.above = y - 1;
      column.below = y + 1;
      while (column.below < area.y_end && is_hole(x, column.below)) ++column.below;
    }
    column.last_y = y;
    Beside found;
    take(left_, y, found);
    take(right_, y, found);
    take(x, column.above, found);
    take(x, column.below, found);
    return found;
  }

 private:
  static constexpr int kNone = -2;
  // The run of holes that the last one of a column is in.
  struct Column {
    int last_y, above, below;
  };

  bool is_hole(int x, int y) const { return tile_.radii[tile_at(tile_, x, y)] == kHoleRadius; }

  void take(int x, int y, Beside& found) const {
    const Rectangle& area = tile_.area;
    if (x < area.x_begin || x >= area.x_end || y < area.y_begin || y >= area.y_end) return;
    const float radius = tile_.radii[tile_at(tile_, x, y)];
    if (!found.is_there || radius_of(radius) > radius_of(found.radius))
      found = {true, x, y, radius};
  }

  const WarpTile& tile_;
  std::vector<Column> columns_;
  int x_ = kNone, y_ = kNone, left_ = 0, right_ = 0;
};

// The pixel of a source that sees that radius at (x, y); none if it sees something else there.
std::optional<SourcePixel> pixel_in(const AskedSource& asked, int x, int y, float radius) {
  const WarpSource& source = *asked.source;
  const float most = std::max(std::fabs(asked.shift.x), std::fabs(asked.shift.y));
  // Twice: what is there may be farther than what was beside the hole.
  for (int attempt = 0; attempt < 2; ++attempt) {
    const int from_x = x - nearest_whole(radius * asked.shift.x);
    const int from_y = y - nearest_whole(radius * asked.shift.y);
    if (from_x < 0 || from_x >= source.width || from_y < 0 || from_y >= source.height) break;
    const float there = radius_of(source.radii[plane_at(source, from_x, from_y)]);
    if (std::fabs(there - radius) * most <= kSameSurfacePx) return SourcePixel{from_x, from_y};
    if (there < radius) break;
    radius = there;
  }
  return std::nullopt;
}

void add_colour(const WarpSource& source, const SourcePixel& pixel, std::size_t to,
                WarpedColours& sums) {
  const std::size_t at = plane_at(source, pixel.x, pixel.y);
  sums.red[to] += source.red[at];
  sums.green[to] += source.green[at];
  sums.blue[to] += source.blue[at];
}

// Adds what the first source has not seen.
void fill_holes(std::span<const AskedSource> asked, const WarpTile& tile, WarpedColours& sums,
                WarpHoles& holes) {
  HoleBorders borders{tile};
  for (const std::int32_t hole : holes_of(tile)) {
    const int x = hole & 0xFFFF, y = hole >> 16;
    const std::size_t at = tile_at(tile, x, y);
    const Beside beside = borders.farthest(x, y);
    const AskedSource* seen_from = nullptr;
    // Nothing at all came into the tile: unmoved.
    SourcePixel pixel{x, y};
    if (beside.is_there) {
      for (const AskedSource& of : asked) {
        const std::optional<SourcePixel> seen = pixel_in(of, x, y, radius_of(beside.radius));
        if (!seen) continue;
        seen_from = &of;
        pixel = *seen;
        break;
      }
      if (seen_from == nullptr) {
        pixel = shown_pixel(asked[0].shift, beside.x, beside.y, beside.radius);
      }
    }
    ++(seen_from != nullptr ? holes.filled : holes.unseen);
    add_colour(seen_from != nullptr ? *seen_from->source : *asked[0].source, pixel, at, sums);
  }
}

void settle(WarpMemory& memory, Isa isa) {
  settle_sums(memory.sums.red, memory.totals[0], isa);
  settle_sums(memory.sums.green, memory.totals[1], isa);
  settle_sums(memory.sums.blue, memory.totals[2], isa);
}

void add_totals(const WarpMemory& memory, int margin_px, SampleSums& sums) {
  const Rectangle& area = memory.tile.area;
  for (int y = area.y_begin; y < area.y_end; ++y) {
    for (int x = area.x_begin; x < area.x_end; x += kSumTile) {
      double* to = sums_at(sums, x - margin_px, y - margin_px);
      const std::size_t begin = tile_at(memory.tile, x, y);
      const auto end = begin + static_cast<std::size_t>(std::min(kSumTile, area.x_end - x));
      for (std::size_t at = begin; at < end; ++at, to += 4) {
        for (std::size_t c = 0; c < 3; ++c) to[c] += memory.totals[c][at];
      }
    }
  }
}

bool are_all_drawn(const Sampling& sampling) { return sampling.samples <= sampling.drawn_views; }

std::vector<glm::dvec2> source_points(const Sampling& sampling,
                                      const std::vector<glm::dvec2>& views) {
  return are_all_drawn(sampling) ? views : lens_points_for(sampling.aperture, sampling.drawn_views);
}

double length(glm::dvec2 v) { return std::sqrt(v.x * v.x + v.y * v.y); }

// As far as a circle moves from a source to the view farthest from it.
int margin_for(const LensViewInput& input, const std::vector<glm::dvec2>& sources,
               const std::vector<glm::dvec2>& views, ThreadPool& pool) {
  double farthest = 0.0;
  for (const glm::dvec2 point : views) {
    double nearest = 2.0;
    for (const glm::dvec2 source : sources) nearest = std::min(nearest, length(point - source));
    farthest = std::max(farthest, nearest);
  }
  if (farthest == 0.0) return 0;
  const float largest_px = circle_sizes(input.pinhole, coc_of(input), 0.0f, pool).largest_px;
  const double reach_px = std::ceil(farthest * static_cast<double>(largest_px)) + 1.0;
  const int room = (kMaxImageSize - std::max(input.pinhole.width, input.pinhole.height)) / 2;
  return std::min(static_cast<int>(std::min(reach_px, 1.0 * kMostMarginPx)), room);
}

// Shifts of the views that are nearest to the i-th of `sources`.
std::vector<glm::vec2> shifts_from(const std::vector<glm::dvec2>& sources, std::size_t i,
                                   const std::vector<glm::dvec2>& views) {
  std::vector<glm::vec2> shifts;
  for (const glm::dvec2 view : views) {
    const auto nearest = std::min_element(
        sources.begin(), sources.end(),
        [&](glm::dvec2 a, glm::dvec2 b) { return length(view - a) < length(view - b); });
    if (nearest - sources.begin() == static_cast<std::ptrdiff_t>(i)) {
      shifts.emplace_back(view - *nearest);
    }
  }
  return shifts;
}

// The camera with so many more pixels on each side.
CameraMatrices with_margin(CameraMatrices camera, int width, int height, int margin_px) {
  const double size_px[] = {1.0 * width, 1.0 * height};
  for (int axis = 0; axis < 2; ++axis) {
    const double scale = size_px[axis] / (size_px[axis] + 2.0 * margin_px);
    for (int i = 0; i < 4; ++i) camera.eye_to_clip[i][axis] *= scale;
  }
  return camera;
}

}  // namespace

WarpedViewsBuffer make_warped_views_buffer(const LensViewInput& input, ThreadPool& pool) {
  WarpedViewsBuffer buffer{input.prepared != nullptr
                               ? std::move(*input.prepared)
                               : prepare_scene(input.scene, input.profile, pool),
                           {},
                           0,
                           {},
                           {},
                           make_sample_sums(input.pinhole.width, input.pinhole.height)};
  buffer.prepared.stand_ins = input.stand_ins;
  return buffer;
}

void draw_sources(WarpedViewsBuffer& buffer, const LensViewInput& input, ThreadPool& pool) {
  const int width = input.pinhole.width, height = input.pinhole.height;
  buffer.views = view_points(input.sampling);
  const std::vector<glm::dvec2> points = source_points(input.sampling, buffer.views);
  const int margin = margin_for(input, points, buffer.views, pool);
  buffer.margin_px = margin;
  if (buffer.picture.width != width + 2 * margin || buffer.picture.height != height + 2 * margin) {
    buffer.picture = make_image(Format::rgba16f, width + 2 * margin, height + 2 * margin);
  }
  buffer.sources.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const CameraMatrices camera = lens_camera(input.camera, points[i] * input.aperture_radius_m,
                                              input.focus_m, glm::dvec2{0.0}, width, height);
    draw_scene(buffer.prepared, margin == 0 ? camera : with_margin(camera, width, height, margin),
               input.frame, buffer.picture, pool);
    buffer.sources[i].point = points[i];
    const WarpSharpening sharpening = are_all_drawn(input.sampling)
                                          ? WarpSharpening{{}, 0.0f}
                                          : warp_sharpening(shifts_from(points, i, buffer.views));
    set_source(buffer.sources[i], buffer.picture, coc_of(input), sharpening, pool);
  }
}

WarpHoles add_warped_views(const WarpedViewsBuffer& buffer, SampleSums& sums, ThreadPool& pool) {
  std::vector<std::vector<AskedSource>> views;
  views.reserve(buffer.views.size());
  for (const glm::dvec2 point : buffer.views) views.push_back(asked_sources(buffer.sources, point));
  std::stable_sort(views.begin(), views.end(), [](const auto& a, const auto& b) {
    return a.front().source < b.front().source;
  });
  const int across = (sums.width + kWarpTileWidth - 1) / kWarpTileWidth;
  const int down = (sums.height + kWarpTileHeight - 1) / kWarpTileHeight;
  std::vector<WarpHoles> holes(static_cast<std::size_t>(across * down));
  const int margin = buffer.margin_px;
  for_each_with<WarpMemory>(pool, across * down, [&](int number, auto& memory) {
    const int x = number % across * kWarpTileWidth, y = number / across * kWarpTileHeight;
    const Rectangle area{x + margin, y + margin, std::min(x + kWarpTileWidth, sums.width) + margin,
                         std::min(y + kWarpTileHeight, sums.height) + margin};
    memory.tile.area = area;
    const std::size_t size = static_cast<std::size_t>(tile_stride(memory.tile)) *
                             static_cast<std::size_t>(area.y_end - area.y_begin);
    for (std::vector<float>* plane : {&memory.sums.red, &memory.sums.green, &memory.sums.blue}) {
      plane->assign(size, 0.0f);
    }
    for (std::vector<double>& plane : memory.totals) plane.assign(size, 0.0);
    for (std::size_t i = 0; i < views.size(); ++i) {
      const AskedSource& first = views[i].front();
      warp_to(*first.source, first.shift, area, memory.tile, pool.isa());
      add_colours(*first.source, first.shift, memory.tile, memory.sums, pool.isa());
      if (memory.tile.hole_count > 0) {
        fill_holes(views[i], memory.tile, memory.sums, holes[static_cast<std::size_t>(number)]);
      }
      if ((i + 1) % kSettledViews == 0 || i + 1 == views.size()) {
        settle(memory, pool.isa());
      }
    }
    add_totals(memory, margin, sums);
  });
  sums.count += static_cast<int>(views.size());
  WarpHoles all;
  for (const WarpHoles& of : holes) {
    all.filled += of.filled;
    all.unseen += of.unseen;
  }
  return all;
}

SampledPicture warped_accumulation(WarpedViewsBuffer& buffer, const LensViewInput& input,
                                   ThreadPool& pool) {
  draw_sources(buffer, input, pool);
  clear_sums(buffer.sums);
  const WarpHoles holes = add_warped_views(buffer, buffer.sums, pool);
  if (input.progress) input.progress(input.sampling.samples);
  const double pixels = 1.0 * input.pinhole.width * input.pinhole.height;
  return {.picture = mean_picture(buffer.sums, input.pinhole, input.profile, pool),
          .samples = input.sampling.samples,
          .unseen = static_cast<double>(holes.unseen) / (pixels * input.sampling.samples)};
}

SampledPicture warped_accumulation(const LensViewInput& input, ThreadPool& pool) {
  LensViewMemory own;
  std::shared_ptr<WarpedViewsBuffer>& buffer =
      (input.memory != nullptr ? *input.memory : own).warped_views;
  if (!buffer) {
    buffer = std::make_shared<WarpedViewsBuffer>(make_warped_views_buffer(input, pool));
  }
  return warped_accumulation(*buffer, input, pool);
}

}  // namespace softfocus
