#include "dof/scatter/hidden_sheet.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace softfocus {
namespace {

constexpr int kTaskRows = 16;

// Runs body(y) for all rows, some at a time.
template <class Body>
void for_rows(int rows, ThreadPool& pool, const Body& body) {
  pool.for_each((rows + kTaskRows - 1) / kTaskRows, [&](int task) {
    const int end = std::min((task + 1) * kTaskRows, rows);
    for (int y = task * kTaskRows; y < end; ++y) body(y);
  });
}

bool all_known(const Planes& level, int values) {
  for (int y = 0; y < level.height; ++y) {
    const float* known = plane_row(level, values, y);
    if (std::any_of(known, known + level.width, [](float is) { return is == 0.0f; })) return false;
  }
  return true;
}

void pull_row(const Planes& fine, int values, int y, Planes& coarse) {
  const PullPair rows = pull_pair(y, fine.height);
  const float* known = plane_row(fine, values, rows.first);
  const std::ptrdiff_t down = (rows.second - rows.first) * fine.stride;
  for (int x = 0; x < coarse.width; ++x) {
    const PullPair columns = pull_pair(x, fine.width);
    const std::ptrdiff_t at[] = {columns.first, columns.second, columns.first + down,
                                 columns.second + down};
    float* to = plane_row(coarse, 0, y) + x;
    const float count = (known[at[0]] + known[at[1]]) + (known[at[2]] + known[at[3]]);
    to[values * coarse.plane] = count > 0.0f ? 1.0f : 0.0f;
    for (int i = 0; i < values; ++i) {
      const float* from = plane_row(fine, i, rows.first);
      const auto value = [&](std::ptrdiff_t place) {
        return known[place] != 0.0f ? from[place] : 0.0f;
      };
      const float sum = (value(at[0]) + value(at[1])) + (value(at[2]) + value(at[3]));
      to[i * coarse.plane] = count > 0.0f ? sum / count : 0.0f;
    }
  }
}

// Every pixel of `coarse` has a value. `taps` are those of the columns.
void push_row(const Planes& coarse, const std::vector<PushTap>& taps, int values, int y,
              Planes& fine) {
  const PushTap down = push_tap(y, fine.height);
  const float* known = plane_row(fine, values, y);
  for (int x = 0; x < fine.width; ++x) {
    if (known[x] != 0.0f) continue;
    const PushTap across = taps[static_cast<std::size_t>(x)];
    for (int i = 0; i < values; ++i) {
      const auto between = [&](int row) {
        const float* from = plane_row(coarse, i, row);
        return across.near_share * from[across.near] +
               (1.0f - across.near_share) * from[across.far];
      };
      plane_row(fine, i, y)[x] =
          down.near_share * between(down.near) + (1.0f - down.near_share) * between(down.far);
    }
  }
}

}  // namespace

PullPair pull_pair(int coarse, int fine_size) {
  // With a middle that counts as two, what lies past it comes one pixel sooner.
  const int middle = fine_size % 2 == 1 ? fine_size / 2 : fine_size;
  const auto place = [&](int i) { return i > middle ? i - 1 : i; };
  return {place(2 * coarse), place(2 * coarse + 1)};
}

PushTap push_tap(int fine, int fine_size) {
  const int middle = fine_size / 2, coarse_size = (fine_size + 1) / 2;
  if (fine_size % 2 == 1 && fine == middle) {
    return middle % 2 == 0 ? PushTap{middle / 2, middle / 2, 0.75f}
                           : PushTap{middle / 2, middle / 2 + 1, 0.5f};
  }
  const int place = fine_size % 2 == 1 && fine > middle ? fine + 1 : fine;
  const int far = place / 2 + (place % 2 == 0 ? -1 : 1);
  return {place / 2, std::clamp(far, 0, coarse_size - 1), 0.75f};
}

void guess_hidden(Planes& sheet, int values, ThreadPool& pool) {
  std::vector<Planes> coarser;
  const auto level = [&](std::size_t i) -> Planes& { return i == 0 ? sheet : coarser[i - 1]; };
  std::size_t top = 0;
  while (!all_known(level(top), values)) {
    const Planes& fine = level(top);
    if (fine.width == 1 && fine.height == 1) return;
    Planes coarse = make_planes(values + 1, (fine.width + 1) / 2, (fine.height + 1) / 2);
    for_rows(coarse.height, pool, [&](int y) { pull_row(fine, values, y, coarse); });
    coarser.push_back(std::move(coarse));
    ++top;
  }
  for (; top > 0; --top) {
    Planes& fine = level(top - 1);
    std::vector<PushTap> taps(static_cast<std::size_t>(fine.width));
    for (int x = 0; x < fine.width; ++x)
      taps[static_cast<std::size_t>(x)] = push_tap(x, fine.width);
    for_rows(fine.height, pool, [&](int y) { push_row(level(top), taps, values, y, fine); });
  }
}

}  // namespace softfocus
