#include "dof/object_layers/picture_objects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "raster/threads/loops.h"

namespace softfocus {
namespace {

constexpr float kStepPx = 0.75f, kStepOfNumberPx = 2.0f;
constexpr int kObjectBandRows = 32;

// Whether two of four radii in a row, `a` and `b`, lie on one surface. NaN, which compares false,
// stands for a pixel outside the picture.
bool one_surface(float before, float a, float b, float behind, float step_px) {
  const float step = b - a;
  return std::fabs(step) <= step_px || std::fabs(step - (a - before)) <= step_px ||
         std::fabs(step - (behind - b)) <= step_px;
}

struct ObjectSource {
  const Planes& planes;
  int plane;
  std::span<const std::uint16_t> given;

  float radius(int x, int y) const {
    const bool inside = x >= 0 && x < planes.width && y >= 0 && y < planes.height;
    return inside ? plane_row(planes, plane, y)[x] : std::numeric_limits<float>::quiet_NaN();
  }
};

void link_row(const ObjectSource& from, PictureObjects& objects, int y) {
  const int width = objects.width;
  std::uint8_t* links = &objects.links[objects.at(0, y)];
  const float* radii = plane_row(from.planes, from.plane, y);
  const std::uint16_t* numbers =
      from.given.empty() ? nullptr : from.given.data() + objects.at(0, y);
  const float step_px = numbers != nullptr ? kStepOfNumberPx : kStepPx;
  const bool last = y + 1 == objects.height;
  const float* below = last ? radii : plane_row(from.planes, from.plane, y + 1);
  // Nearly all neighbours are alike: these loops compile to vectors.
  for (int x = 0; x < width; ++x) {
    links[x] = std::fabs(below[x] - radii[x]) <= step_px ? kLinkedDown : 0;
  }
  for (int x = 0; x + 1 < width; ++x) {
    const bool linked = std::fabs(radii[x + 1] - radii[x]) <= step_px;
    links[x] = static_cast<std::uint8_t>(links[x] | (linked ? kLinkedRight : 0));
  }
  for (int x = 0; x < width; ++x) {
    if ((links[x] & kLinkedRight) == 0 && x + 1 < width &&
        one_surface(from.radius(x - 1, y), radii[x], radii[x + 1], from.radius(x + 2, y),
                    step_px)) {
      links[x] |= kLinkedRight;
    }
    if ((links[x] & kLinkedDown) == 0 &&
        one_surface(from.radius(x, y - 1), radii[x], below[x], from.radius(x, y + 2), step_px)) {
      links[x] |= kLinkedDown;
    }
  }
  if (numbers != nullptr) {
    const std::uint16_t* numbers_below = last ? numbers : numbers + width;
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width && numbers[x] != numbers[x + 1]) links[x] &= kLinkedDown;
      if (numbers[x] != numbers_below[x]) links[x] &= kLinkedRight;
    }
  }
  links[width - 1] &= kLinkedDown;
  if (last) {
    for (int x = 0; x < width; ++x) links[x] &= kLinkedRight;
  }
}

// --- connected sets: every pixel points at an earlier one of its set, the first at itself ---

std::uint32_t first_of(const std::uint32_t* earlier, std::uint32_t pixel) {
  while (earlier[pixel] != pixel) pixel = earlier[pixel];
  return pixel;
}

// As first_of(), halving the way for the next time.
std::uint32_t find_first(std::uint32_t* earlier, std::uint32_t pixel) {
  while (earlier[pixel] != pixel) {
    earlier[pixel] = earlier[earlier[pixel]];
    pixel = earlier[pixel];
  }
  return pixel;
}

void unite(std::uint32_t* earlier, std::uint32_t a, std::uint32_t b) {
  const std::uint32_t first_a = find_first(earlier, a), first_b = find_first(earlier, b);
  earlier[std::max(first_a, first_b)] = std::min(first_a, first_b);
}

// Unites the pixels of a row with their neighbours on the left and, if that is asked for, above.
void unite_row(const PictureObjects& objects, std::uint32_t* earlier, int y, bool above) {
  const std::size_t begin = objects.at(0, y);
  const std::uint8_t* links = &objects.links[begin];
  const auto width = static_cast<std::size_t>(objects.width);
  bool with_left_above = false;  // the left neighbour's set is already that above this pixel
  for (std::size_t x = 0; x < width; ++x) {
    const auto pixel = static_cast<std::uint32_t>(begin + x);
    const bool left = x > 0 && (links[x - 1] & kLinkedRight) != 0;
    earlier[pixel] = left ? earlier[pixel - 1] : pixel;
    const bool up = above && (objects.links[begin + x - width] & kLinkedDown) != 0;
    const bool known =
        left && with_left_above && (objects.links[begin + x - 1 - width] & kLinkedRight) != 0;
    if (up && !known) unite(earlier, pixel, static_cast<std::uint32_t>(pixel - width));
    with_left_above = up;
  }
}

void connect(PictureObjects& objects, ThreadPool& pool) {
  const int height = objects.height, bands = (height + kObjectBandRows - 1) / kObjectBandRows;
  std::vector<std::uint32_t> earlier(objects.links.size());
  pool.for_each(bands, [&](int band) {
    const int begin = band * kObjectBandRows, end = std::min(begin + kObjectBandRows, height);
    for (int y = begin; y < end; ++y) unite_row(objects, earlier.data(), y, y > begin);
  });
  const auto width = static_cast<std::size_t>(objects.width);
  for (int y = kObjectBandRows; y < height; y += kObjectBandRows) {
    for (std::size_t at = objects.at(0, y - 1); at < objects.at(0, y); ++at) {
      if ((objects.links[at] & kLinkedDown) == 0) continue;
      unite(earlier.data(), static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(at + width));
    }
  }
  pool.for_each(height, [&](int y) {
    for (std::size_t at = objects.at(0, y); at < objects.at(0, y + 1); ++at) {
      const bool same = at > objects.at(0, y) && (objects.links[at - 1] & kLinkedRight) != 0;
      objects.numbers[at] =
          same ? objects.numbers[at - 1] : first_of(earlier.data(), static_cast<std::uint32_t>(at));
    }
  });
}

// Runs of one object in a row are short work for a lock: its largest radius once a run.
void measure_objects(const Planes& planes, int radii, PictureObjects& objects, ThreadPool& pool) {
  std::mutex mutex;
  for_each_band(pool, objects.height, kObjectBandRows, [&](int first, int end) {
    struct Largest {
      std::uint32_t object;
      float radius_px;
    };
    std::vector<Largest> runs;
    for (int y = first; y < end; ++y) {
      const float* radius = plane_row(planes, radii, y);
      const std::uint32_t* number = &objects.numbers[objects.at(0, y)];
      for (int x = 0; x < objects.width; ++x) {
        if (runs.empty() || runs.back().object != number[x]) runs.push_back({number[x], radius[x]});
        runs.back().radius_px = std::max(runs.back().radius_px, radius[x]);
      }
    }
    const std::lock_guard lock{mutex};
    for (const Largest& run : runs) {
      float& largest = objects.farthest_px[run.object];
      largest = std::max(largest, run.radius_px);
    }
  });
}

}  // namespace

PictureObjects find_objects(const Planes& planes, int radii, std::span<const std::uint16_t> given,
                            ThreadPool& pool) {
  PictureObjects objects{planes.width, planes.height, {}, {}, {}};
  const std::size_t pixels = objects.at(0, objects.height);
  objects.links.resize(pixels);
  objects.numbers.resize(pixels);
  const ObjectSource source{planes, radii, given};
  pool.for_each(objects.height, [&](int y) { link_row(source, objects, y); });
  if (given.empty()) {
    connect(objects, pool);
  } else {
    std::copy(given.begin(), given.end(), objects.numbers.begin());
  }
  objects.farthest_px.assign(given.empty() ? pixels : std::size_t{65536},
                             -std::numeric_limits<float>::infinity());
  measure_objects(planes, radii, objects, pool);
  return objects;
}

}  // namespace softfocus
