#include "scenes/shadows/shadow_mask.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <utility>

#include "raster/pipeline/setup.h"
#include "raster/pipeline/viewport.h"

namespace softfocus {
namespace {

// What a pixel shows becomes its receiver, and the lights whose side it is not on become its mask.
struct DarkSides {
  std::uint8_t front = 0, back = 0;
};

std::vector<DarkSides> dark_sides(const Facets& facets,
                                  std::span<const ProjectedShadows* const> shadows) {
  std::vector<DarkSides> dark(facets.receivers.size());
  for (std::size_t light = 0; light < shadows.size(); ++light) {
    const auto bit = static_cast<std::uint8_t>(1u << light);
    for (std::size_t r = 0; r < dark.size(); ++r) {
      const LitSide lit = shadows[light]->lit[r];
      if (lit == LitSide::none || lit == LitSide::back) dark[r].front |= bit;
      if (lit == LitSide::none || lit == LitSide::front) dark[r].back |= bit;
    }
  }
  return dark;
}

// The pixels that show a receiver lie in here. Threads widen it in any order.
struct SeenBox {
  std::atomic<int> x_begin{std::numeric_limits<int>::max()};
  std::atomic<int> y_begin{std::numeric_limits<int>::max()};
  std::atomic<int> x_end{0};
  std::atomic<int> y_end{0};
};

void lower(std::atomic<int>& value, int to) {
  int old = value.load(std::memory_order_relaxed);
  while (to < old && !value.compare_exchange_weak(old, to, std::memory_order_relaxed)) {
  }
}

void raise(std::atomic<int>& value, int to) {
  int old = value.load(std::memory_order_relaxed);
  while (to > old && !value.compare_exchange_weak(old, to, std::memory_order_relaxed)) {
  }
}

void widen(SeenBox& box, int x_begin, int x_end, int y) {
  lower(box.x_begin, x_begin);
  raise(box.x_end, x_end);
  lower(box.y_begin, y);
  raise(box.y_end, y + 1);
}

struct SeenReceivers {
  std::vector<std::uint32_t> of_pixel;  // kShowsNone where nothing is drawn
  std::vector<SeenBox> boxes;
};

void find_seen(const Facets& facets, std::span<const SeenFacet> seen,
               std::span<const DarkSides> dark, int width, int y, SeenReceivers& found,
               std::span<std::uint8_t> mask) {
  const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  SeenFacet last = 0;
  std::uint32_t receiver = kShowsNone, run_of = kShowsNone;
  std::uint8_t of_side = 0;
  int run_begin = 0;
  for (int x = 0; x < width; ++x) {
    const SeenFacet here = seen[row + static_cast<std::size_t>(x)];
    if (here != last) {
      last = here;
      receiver = shows_facet(here) ? facets.receiver_of[facet_of(here)] : kShowsNone;
      of_side = receiver == kShowsNone ? std::uint8_t{0}
                : seen_from_back(here)  ? dark[receiver].back
                                        : dark[receiver].front;
      if (receiver != run_of) {
        if (run_of != kShowsNone) widen(found.boxes[run_of], run_begin, x, y);
        run_of = receiver;
        run_begin = x;
      }
    }
    found.of_pixel[row + static_cast<std::size_t>(x)] = receiver;
    mask[row + static_cast<std::size_t>(x)] = of_side;
  }
  if (run_of != kShowsNone) widen(found.boxes[run_of], run_begin, width, y);
}

// 3 corners, and one more for each side of the box.
struct ClipPolygonOfShadow {
  std::array<glm::dvec4, 12> corners;
  std::size_t count = 0;
};

// A box of pixels in clip coordinates: x_low w <= x <= x_high w, likewise y.
struct ClipBox {
  double x_low, x_high, y_low, y_high;
};

double inside_by(const ClipBox& box, const glm::dvec4& p, int side) {
  switch (side) {
    case 0: return p.x - box.x_low * p.w;
    case 1: return box.x_high * p.w - p.x;
    case 2: return p.y - box.y_low * p.w;
    default: return box.y_high * p.w - p.y;
  }
}

void cut_to_box(ClipPolygonOfShadow& polygon, const ClipBox& box) {
  for (int side = 0; side < 4 && polygon.count > 0; ++side) {
    ClipPolygonOfShadow kept;
    const auto put = [&](const glm::dvec4& p) {
      if (kept.count < kept.corners.size()) kept.corners[kept.count++] = p;
    };
    for (std::size_t i = 0; i < polygon.count; ++i) {
      const glm::dvec4 &a = polygon.corners[i], &b = polygon.corners[(i + 1) % polygon.count];
      const double d_a = inside_by(box, a, side), d_b = inside_by(box, b, side);
      if (d_a >= 0.0) put(a);
      if ((d_a < 0.0) == (d_b < 0.0)) continue;
      put(d_a < 0.0 ? b + (a - b) * (d_b / (d_b - d_a)) : a + (b - a) * (d_a / (d_a - d_b)));
    }
    polygon = kept;
  }
}

glm::dvec4 to_clip(const glm::dmat4& m, const glm::dvec4& p) {
  return ((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3] * p.w;
}

// Divided in binary64: a projected corner can be anywhere, and binary32 has 2^-24 of its place.
glm::vec2 divided(const glm::dvec4& p) {
  return {static_cast<float>(p.x / p.w), static_cast<float>(p.y / p.w)};
}

// A pixel's room around the centres, so that no cut runs between them; but nothing beyond the
// picture, where a driver may cut again.
ClipBox clip_box(const Rectangle& pixels, const ShadowView& view) {
  const double x_scale = 2.0 / view.width, y_scale = 2.0 / view.height;
  return {std::max((pixels.x_begin - 1) * x_scale - 1.0, -1.0),
          std::min((pixels.x_end + 1) * x_scale - 1.0, 1.0),
          std::max((pixels.y_begin - 1) * y_scale - 1.0, -1.0),
          std::min((pixels.y_end + 1) * y_scale - 1.0, 1.0)};
}

// Calls use(corners) for each triangle of what is left of a shadow in a box.
template <class Use>
void cut_shadow(const ProjectedTriangle& triangle, const ShadowView& view, const ClipBox& box,
                const Use& use) {
  ClipPolygonOfShadow polygon;
  for (const glm::dvec4& corner : triangle) {
    polygon.corners[polygon.count++] = to_clip(view.world_to_clip, corner);
  }
  bool cuts = false;
  for (int side = 0; side < 4; ++side) {
    int outside = 0;
    for (std::size_t i = 0; i < 3; ++i) outside += inside_by(box, polygon.corners[i], side) < 0.0;
    if (outside == 3) return;
    cuts |= outside > 0;
  }
  if (cuts) cut_to_box(polygon, box);
  if (polygon.count < 3) return;
  std::array<glm::vec2, 12> corners;
  for (std::size_t i = 0; i < polygon.count; ++i) corners[i] = divided(polygon.corners[i]);
  for (std::size_t i = 2; i < polygon.count; ++i) {
    use(std::array<glm::vec2, 3>{corners[0], corners[i - 1], corners[i]});
  }
}

// Where a receiver's shadows are drawn: its pixels lie in `box`, and of these a part at a time is
// drawn.
struct MaskArea {
  std::uint32_t receiver;
  Rectangle box;
  Rectangle part;
};

struct MaskWriter {
  const ShadowView& view;
  const MaskArea& where;
  std::span<const std::uint32_t> receivers;
  std::span<std::uint8_t> mask;
};

void fill(const MaskWriter& writer, const std::array<glm::vec2, 3>& corners, std::uint8_t bit) {
  const ShadowView& view = writer.view;
  std::array<WindowVertex, 3> vertices;
  for (std::size_t i = 0; i < 3; ++i) {
    vertices[i] =
        to_window({corners[i], 0.0f, 1.0f}, view.width, view.height, view.profile.viewport);
  }
  const auto setup = set_up_triangle(vertices, Cull::none, FrontFace::counter_clockwise,
                                     writer.where.part, view.profile);
  if (!setup) return;
  const Rectangle& bounds = setup->bounds;
  for (int y = bounds.y_begin; y < bounds.y_end; ++y) {
    const Span span = covered_span(*setup, y, bounds.x_begin, bounds.x_end);
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width);
    const std::uint32_t* receivers = writer.receivers.data() + row;
    std::uint8_t* mask = writer.mask.data() + row;
    for (int x = span.x_begin; x < span.x_end; ++x) {
      // Others' pixels are not written, not even with what they hold: a thread may be at them.
      if (receivers[x] == writer.where.receiver) mask[x] = static_cast<std::uint8_t>(mask[x] | bit);
    }
  }
}

// Rows that a task takes of a receiver: a large one's shadows are drawn by all threads.
constexpr int kRowsOfArea = 128;

// Areas that a task takes at once.
constexpr std::size_t kAreasATask = 8;

std::vector<MaskArea> areas_of(const SeenReceivers& found,
                               std::span<const ProjectedShadows* const> shadows) {
  std::vector<MaskArea> areas;
  for (std::uint32_t r = 0; r < found.boxes.size(); ++r) {
    const SeenBox& box = found.boxes[r];
    const bool has_shadows = std::any_of(shadows.begin(), shadows.end(), [&](const auto* of_light) {
      return of_light->begins[r] < of_light->begins[r + std::size_t{1}];
    });
    if (!has_shadows) continue;
    const Rectangle all{box.x_begin, box.y_begin, box.x_end, box.y_end};
    for (int y = all.y_begin; y < all.y_end; y += kRowsOfArea) {
      areas.push_back({r, all, {all.x_begin, y, all.x_end, std::min(y + kRowsOfArea, all.y_end)}});
    }
  }
  return areas;
}

// Calls use(triangle) for each of a light's triangles on a receiver.
template <class Use>
void for_each_triangle(const ProjectedShadows& of_light, std::uint32_t receiver, const Use& use) {
  for (std::size_t t = of_light.begins[receiver]; t < of_light.begins[receiver + std::size_t{1}];
       ++t) {
    use(of_light.triangles[t]);
  }
}

SeenReceivers seen_receivers(const Facets& facets, std::span<const ProjectedShadows* const> shadows,
                             std::span<const SeenFacet> seen, const ShadowView& view,
                             std::span<std::uint8_t> mask, ThreadPool& pool) {
  const std::vector<DarkSides> dark = dark_sides(facets, shadows);
  SeenReceivers found;
  found.of_pixel.resize(seen.size());
  found.boxes = std::vector<SeenBox>(facets.receivers.size());
  pool.for_each(view.height,
                [&](int y) { find_seen(facets, seen, dark, view.width, y, found, mask); });
  return found;
}

}  // namespace

void draw_shadow_mask(const Facets& facets, std::span<const ProjectedShadows* const> shadows,
                      std::span<const SeenFacet> seen, const ShadowView& view,
                      std::span<std::uint8_t> mask, ThreadPool& pool) {
  const SeenReceivers found = seen_receivers(facets, shadows, seen, view, mask, pool);
  const std::vector<MaskArea> areas = areas_of(found, shadows);
  const auto tasks = static_cast<int>((areas.size() + kAreasATask - 1) / kAreasATask);
  pool.for_each(tasks, [&](int task) {
    const std::size_t begin = static_cast<std::size_t>(task) * kAreasATask;
    for (std::size_t i = begin; i < std::min(begin + kAreasATask, areas.size()); ++i) {
      const MaskArea& area = areas[i];
      const MaskWriter writer{view, area, found.of_pixel, mask};
      // Cut beyond its box, a shadow has other corners, so each part has the whole box's.
      const ClipBox box = clip_box(area.box, view);
      for (std::size_t light = 0; light < shadows.size(); ++light) {
        for_each_triangle(*shadows[light], area.receiver, [&](const ProjectedTriangle& triangle) {
          cut_shadow(triangle, view, box, [&](const std::array<glm::vec2, 3>& corners) {
            fill(writer, corners, static_cast<std::uint8_t>(1u << light));
          });
        });
      }
    }
  });
}

MaskDraws shadow_mask_draws(const Facets& facets, std::span<const ProjectedShadows* const> shadows,
                            std::span<const SeenFacet> seen, const ShadowView& view,
                            ThreadPool& pool) {
  MaskDraws draws;
  draws.dark.resize(seen.size());
  draws.triangles.resize(shadows.size());
  SeenReceivers found = seen_receivers(facets, shadows, seen, view, draws.dark, pool);
  std::uint32_t last = kShowsNone;
  for (const MaskArea& area : areas_of(found, shadows)) {
    if (area.receiver == last) continue;
    last = area.receiver;
    const ClipBox box = clip_box(area.box, view);
    for (std::size_t light = 0; light < shadows.size(); ++light) {
      for_each_triangle(*shadows[light], area.receiver, [&](const ProjectedTriangle& triangle) {
        cut_shadow(triangle, view, box, [&](const std::array<glm::vec2, 3>& corners) {
          draws.triangles[light].push_back({corners, area.receiver});
        });
      });
    }
  }
  draws.receivers = std::move(found.of_pixel);
  return draws;
}

}  // namespace softfocus
