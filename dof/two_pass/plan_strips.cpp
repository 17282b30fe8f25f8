#include <algorithm>

#include "dof/two_pass/two_pass_strips.h"
#include "dof/weights.h"

namespace softfocus {
namespace {

// Wide strips load little twice, since the neighbours on both sides are loaded too, and
// narrow ones share out better.
constexpr int kWidest = 128;
constexpr int kNarrowest = 32;
constexpr int kStripsWanted = 8;

int strip_width(int width) {
  const int wanted = width / kStripsWanted / kCellWidth * kCellWidth;
  return std::clamp(wanted, kNarrowest, kWidest);
}

// How far taps reach into each band of a strip: 0 where nothing is to be done. Along x
// that is what reaches it from its own row; along y what its own pixels reach.
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
    // The gap between rows of bands that are k apart is (k - 1) kCellHeight + 1 at least.
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
  constexpr int kOfLoading = 16;  // in taps
  return static_cast<double>(task.x_end - task.x_begin) * (task.y_end - task.y_begin) *
         (task.reach + kOfLoading);
}

// Cuts a task into parts of about `rows` rows. What lies between is filtered along x twice.
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

// The costliest first, and the last ones in small parts, so that threads end together.
std::vector<StripTask> share_out(std::vector<StripTask> tasks) {
  std::ranges::stable_sort(tasks, std::ranges::greater{}, cost);
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

}  // namespace

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
      // Rows beyond these, up to the reach, are sharp and reach nothing.
      task.y_end = task.last_row = std::min(band * kCellHeight, height);
      task.first_row = task.y_begin;
      tasks.push_back(task);
    }
  }
  return share_out(std::move(tasks));
}

}  // namespace softfocus
