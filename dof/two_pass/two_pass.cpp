#include "dof/two_pass/two_pass.h"

#include <algorithm>
#include <array>
#include <vector>

#include "dof/focus_map.h"
#include "dof/two_pass/two_pass_strip.h"
#include "dof/weights.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

// --- oracle: as a fragment shader would be written ---

template <Format from, Format to>
void filter_along(const DofInput& input, const ConstImageView& source, const ImageView& target,
                  int step_x, int step_y, ThreadPool& pool) {
  const auto fetch = [&](int x, int y) {
    return load_texel<from>(source, std::clamp(x, 0, source.width - 1),
                            std::clamp(y, 0, source.height - 1));
  };
  const auto neighbour = [&](int x, int y) {
    const glm::vec4 texel = fetch(x, y);
    return filter_texel(input.settings, glm::vec3{texel.x, texel.y, texel.z}, texel.w);
  };
  fullscreen_pass<to>(target, input.profile, pool, [&](int x, int y) {
    const FilterTexel centre = neighbour(x, y);
    const float receiver_leakage = leakage(centre.radius_px, input.settings.leak);
    Gather gather = begin_gather(centre);
    for (int d = 1; d <= tap_count(input.settings.max_coc_px); ++d) {
      const auto distance = static_cast<float>(d);
      add_neighbour(gather, neighbour(x - d * step_x, y - d * step_y), distance, receiver_leakage);
      add_neighbour(gather, neighbour(x + d * step_x, y + d * step_y), distance, receiver_leakage);
    }
    return glm::vec4{resolve(gather), fetch(x, y).w};
  });
}

template <Format between_format>
void two_pass_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  Image between = make_image(between_format, input.scene.width, input.scene.height);
  filter_along<Format::rgba16f, between_format>(input, input.scene, between, 1, 0, pool);
  filter_along<between_format, Format::rgba16f>(input, between, result, 0, 1, pool);
}

// --- scalar: line by line, each pixel's radius and intensity computed once a pass ---

// Rows or columns of a task. 8 columns fill the cache lines of RGBA16F.
constexpr int kLinesOfTask = 8;

// A row or a column. Its ends are repeated `taps` times, so that no tap needs a test.
struct Line {
  int taps;
  std::vector<FilterTexel> texels;
  std::vector<float> depths;

  Line(int length, int tap_limit)
      : taps(tap_limit),
        texels(static_cast<std::size_t>(length + 2 * tap_limit)),
        depths(static_cast<std::size_t>(length)) {}
};

int length(const Line& line) { return static_cast<int>(line.depths.size()); }

template <class Fetch>
void fill_line(Line& line, const DofSettings& settings, const Fetch& fetch) {
  const auto taps = static_cast<std::size_t>(line.taps);
  for (int i = 0; i < length(line); ++i) {
    const glm::vec4 texel = fetch(i);
    const auto at = static_cast<std::size_t>(i);
    line.texels[at + taps] = filter_texel(settings, glm::vec3{texel.x, texel.y, texel.z}, texel.w);
    line.depths[at] = texel.w;
  }
  const FilterTexel first = line.texels[taps];
  const FilterTexel last = line.texels[line.depths.size() - 1 + taps];
  std::fill_n(line.texels.begin(), taps, first);
  std::fill_n(line.texels.end() - line.taps, taps, last);
}

template <class Store>
void filter_line(const Line& line, float leak, const Store& store) {
  for (int i = 0; i < length(line); ++i) {
    const FilterTexel* centre = &line.texels[static_cast<std::size_t>(i + line.taps)];
    const float receiver_leakage = leakage(centre->radius_px, leak);
    Gather gather = begin_gather(*centre);
    for (int d = 1; d <= line.taps; ++d) {
      const auto distance = static_cast<float>(d);
      add_neighbour(gather, *(centre - d), distance, receiver_leakage);
      add_neighbour(gather, *(centre + d), distance, receiver_leakage);
    }
    store(i, glm::vec4{resolve(gather), line.depths[static_cast<std::size_t>(i)]});
  }
}

template <Format between_format>
void two_pass_scalar(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  const DofSettings& settings = input.settings;
  const int taps = tap_count(largest_filter_radius(input, pool));

  Image between = make_image(between_format, scene.width, scene.height);
  for_each_band(pool, scene.height, kLinesOfTask, [&](int first, int end) {
    Line line(scene.width, taps);
    for (int y = first; y < end; ++y) {
      fill_line(line, settings, [&](int x) { return load_texel<Format::rgba16f>(scene, x, y); });
      filter_line(line, settings.leak, [&](int x, glm::vec4 value) {
        store_texel<between_format>(between, x, y, value, input.profile);
      });
    }
  });

  for_each_band(pool, scene.width, kLinesOfTask, [&](int first, int end) {
    Line line(scene.height, taps);
    for (int x = first; x < end; ++x) {
      fill_line(line, settings, [&](int y) { return load_texel<between_format>(between, x, y); });
      filter_line(line, settings.leak, [&](int y, glm::vec4 value) {
        store_texel<Format::rgba16f>(result, x, y, value, input.profile);
      });
    }
  });
}

// --- lanes: strips of columns (two_pass_strip.h), only where something is out of focus ---

// Which part of a picture a task filters.
struct StripTask {
  int x_begin, x_end;
  int y_begin, y_end;
  int first_row, last_row;  // the rows that reach it: first_row <= y < last_row
  int reach;                // taps to each side
};

// A strip also loads its neighbours on both sides. Wide strips load less of the picture twice;
// narrow ones share out better.
constexpr int kWidest = 128;
constexpr int kNarrowest = 32;
constexpr int kStripsWanted = 8;

int strip_width(int width) {
  const int wanted = width / kStripsWanted / kCellWidth * kCellWidth;
  return std::clamp(wanted, kNarrowest, kWidest);
}

// For each band (row of cells) of a strip, how far its taps must go; 0 if nothing blurs it.
// Along x, pixels of the same row reach it, of any strip; along y, pixels of the strip itself.
std::vector<int> reach_by_band(const FocusMap& map, int x_begin, int x_end, int farthest) {
  const auto taps = [&](int column, int band) { return tap_count(largest_px(map, column, band)); };
  const int first = std::max(x_begin - farthest, 0) / kCellWidth;
  const int last = std::min((x_end + farthest) / kCellWidth + 1, map.columns);
  std::vector<int> reach(static_cast<std::size_t>(map.rows), 0);
  const auto widen = [&](int band, int by) {
    int& value = reach[static_cast<std::size_t>(band)];
    value = std::max(value, by);
  };
  for (int band = 0; band < map.rows; ++band) {
    int down = 0;
    for (int column = first; column < last; ++column) {
      const int begin = column * kCellWidth, end = begin + kCellWidth;
      const int distance = std::max({begin - (x_end - 1), x_begin - (end - 1), 0});
      const int by = taps(column, band);
      if (by > 0 && by >= distance) widen(band, by);
      if (distance == 0) down = std::max(down, by);
    }
    if (down == 0) continue;
    // Rows of bands that are k apart are at least (k - 1) kCellHeight + 1 apart.
    const int bands = (down - 1) / kCellHeight + 1;
    for (int other = std::max(band - bands, 0); other <= std::min(band + bands, map.rows - 1);
         ++other) {
      widen(other, down);
    }
  }
  return reach;
}

int largest_reach(const FocusMap& map) {
  return tap_count(*std::max_element(map.largest_px.begin(), map.largest_px.end()));
}

double cost(const StripTask& task) {
  constexpr int kOfLoading = 16;  // loading a pixel costs as much as so many taps
  return static_cast<double>(task.x_end - task.x_begin) * (task.y_end - task.y_begin) *
         (task.reach + kOfLoading);
}

// Cuts a task into parts of `rows` rows. Rows within reach of two parts are filtered along x twice.
void cut(const StripTask& task, int rows, std::vector<StripTask>& parts) {
  for (int y = task.y_begin; y < task.y_end; y += rows) {
    StripTask part = task;
    part.y_begin = y;
    part.y_end = std::min(y + rows, task.y_end);
    part.first_row = std::max(task.first_row, y - task.reach);
    part.last_row = std::min(task.last_row, part.y_end + task.reach);
    parts.push_back(part);
  }
}

// Costliest tasks first and the cheapest in small parts, so that threads end together.
std::vector<StripTask> share_out(std::vector<StripTask> tasks) {
  std::stable_sort(tasks.begin(), tasks.end(),
                   [](const StripTask& a, const StripTask& b) { return cost(a) > cost(b); });
  double total = 0.0;
  for (const StripTask& task : tasks) total += cost(task);
  std::vector<StripTask> parts;
  double before = 0.0;
  for (const StripTask& task : tasks) {
    const bool whole = before < 0.7 * total;
    before += cost(task);
    if (whole) {
      parts.push_back(task);
    } else {
      cut(task, std::max((task.y_end - task.y_begin) / 4, std::max(2 * task.reach, 64)), parts);
    }
  }
  return parts;
}

// The parts of a picture that are not in focus, or that something out of focus reaches.
std::vector<StripTask> plan_strips(const FocusMap& map, int width, int height) {
  std::vector<StripTask> tasks;
  const int farthest = largest_reach(map);
  const int columns = strip_width(width);
  for (int x = 0; x < width; x += columns) {
    const int x_end = std::min(x + columns, width);
    const std::vector<int> reach = reach_by_band(map, x, x_end, farthest);
    for (int band = 0; band < map.rows; ++band) {
      StripTask task{x, x_end, band * kCellHeight, 0, 0, 0, 0};
      for (; band < map.rows && reach[static_cast<std::size_t>(band)] > 0; ++band) {
        task.reach = std::max(task.reach, reach[static_cast<std::size_t>(band)]);
      }
      if (task.reach == 0) continue;
      // Rows above and below these are sharp and reach nothing.
      task.y_end = task.last_row = std::min(band * kCellHeight, height);
      task.first_row = task.y_begin;
      tasks.push_back(task);
    }
  }
  return share_out(std::move(tasks));
}

// Rows that are filtered along y together, while their neighbours are in the first cache.
constexpr int kBatch = 64;

using RowPointers = std::array<const std::uint16_t*, 2 * kMostLanes>;

// Row y and the next ones; past row end - 1, that row again.
RowPointers row_pointers(const ConstImageView& image, int y, int end) {
  RowPointers rows{};
  for (int& i = y; const std::uint16_t*& pointer : rows) {
    pointer = row<std::uint16_t>(image, std::min(i++, end - 1)).data();
  }
  return rows;
}

void filter_task(const StripTask& task, const StripFilter& filter, const ConstImageView& scene,
                 const ImageView& result, Strip& strip) {
  const int lanes = lanes_of(filter.isa);
  begin_strip(strip, filter, {scene.width, task.x_begin, task.x_end - task.x_begin, task.reach},
              kBatch);
  begin_rows(strip, filter, task.first_row == 0 ? Outside::repeats : Outside::sharp,
             task.y_begin - task.first_row);
  const Outside below = task.last_row == scene.height ? Outside::repeats : Outside::sharp;
  const int end = task.y_end + task.reach;
  int in = task.first_row, out = task.y_begin;
  while (out < task.y_end) {
    int space = room(strip, filter);
    while (in < task.last_row && space >= lanes) {
      const int count = std::min(lanes, task.last_row - in);
      add_rows(strip, filter, row_pointers(scene, in, task.last_row).data(), count);
      in += count;
      space -= count;
    }
    if (in >= task.last_row && in < end && space > 0) {
      const int count = std::min(space, end - in);
      add_rows_below(strip, filter, below, count);
      in += count;
    }
    const int count = rows_done(strip);
    if (count > 0) {
      write_rows(strip, filter, count, row<std::uint16_t>(result, out).data(), result.stride_bytes);
      out += count;
    }
  }
}

void two_pass_lanes(const DofInput& input, Between between, const ImageView& result,
                    ThreadPool& pool) {
  const FocusMap map = pass_in_focus(input, result, pool);
  const std::vector<StripTask> tasks = plan_strips(map, input.scene.width, input.scene.height);
  const StripFilter filter{input.settings, input.profile.half_store, pool.isa(), between,
                           write_past_caches(result)};
  for_each_with<Strip>(pool, static_cast<int>(tasks.size()), [&](int number, auto& strip) {
    filter_task(tasks[static_cast<std::size_t>(number)], filter, input.scene, result, strip);
  });
}

}  // namespace

void two_pass(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) {
    two_pass_scalar<Format::rgba16f>(input, result, pool);
  } else {
    two_pass_lanes(input, Between::half, result, pool);
  }
}

void two_pass_single(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) {
    two_pass_scalar<Format::rgba32f>(input, result, pool);
  } else {
    two_pass_lanes(input, Between::single, result, pool);
  }
}

void two_pass_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  two_pass_oracle<Format::rgba16f>(input, result, pool);
}

void two_pass_single_oracle(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  two_pass_oracle<Format::rgba32f>(input, result, pool);
}

}  // namespace softfocus
