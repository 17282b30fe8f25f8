#include "dof/two_pass/two_pass_strips.h"

#include <algorithm>
#include <array>

#include "raster/threads/scratch_shelf.h"

namespace softfocus {
namespace {

// Rows that are filtered along y together, while their neighbours are in the first cache.
constexpr int kBatch = 64;

using RowPointers = std::array<const std::uint16_t*, 2 * kMostLanes>;

// Rows y and following, to `end` - 1 and that one again.
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
      take_rows(strip, filter, count, row<std::uint16_t>(result, out).data(),
                result.stride_bytes / sizeof(std::uint16_t));
      out += count;
    }
  }
}

}  // namespace

void two_pass_strips(const DofInput& input, Between between, const ImageView& result, ThreadPool& pool) {
  const FocusMap map = pass_in_focus(input, result, pool);
  const std::vector<StripTask> tasks = plan_strips(map, input.scene.width, input.scene.height);
  const StripFilter filter{input.settings, input.profile.half_store, pool.isa(), between,
                           write_past_caches(result)};
  ScratchShelf<Strip> shelf;
  pool.for_each(static_cast<int>(tasks.size()), [&](int number) {
    Strip strip = shelf.take();
    filter_task(tasks[static_cast<std::size_t>(number)], filter, input.scene, result, strip);
    shelf.put_back(std::move(strip));
  });
}

}  // namespace softfocus
