#include "scenes/shadows/shadow_mask.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "raster/pipeline/setup.h"

namespace softfocus {
namespace {

// The lights that do not face a facet, as bits of a mask: a pixel's facet becomes its receiver and
// these.
struct DarkSides {
  std::uint8_t front = 0, back = 0;
};

std::vector<DarkSides> dark_sides(const Facets& facets,
                                  std::span<const ProjectedShadows* const> shadows) {
  std::vector<DarkSides> dark(facets.receivers.size());
  for (std::size_t light = 0; light < shadows.size(); ++light) {
    if (shadows[light] == nullptr) continue;
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
                : seen_from_back(here) ? dark[receiver].back
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

// 4 corners at most, and one more for each side of a box.
template <class Point>
struct CutPolygon {
  std::array<Point, 12> corners;
  std::size_t count = 0;
};

// Keeps what has inside_by(corner) >= 0.
template <class Point, class InsideBy>
void cut(CutPolygon<Point>& polygon, const InsideBy& inside_by) {
  CutPolygon<Point> kept;
  const auto put = [&](const Point& p) {
    if (kept.count < kept.corners.size()) kept.corners[kept.count++] = p;
  };
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Point &a = polygon.corners[i], &b = polygon.corners[(i + 1) % polygon.count];
    const double d_a = inside_by(a), d_b = inside_by(b);
    if (d_a >= 0.0) put(a);
    if ((d_a < 0.0) == (d_b < 0.0)) continue;
    put(d_a < 0.0 ? b + (a - b) * (d_b / (d_b - d_a)) : a + (b - a) * (d_a / (d_a - d_b)));
  }
  polygon = kept;
}

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
  CutPolygon<glm::dvec4> polygon;
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
  for (int side = 0; side < 4 && cuts; ++side) {
    cut(polygon, [&](const glm::dvec4& p) { return inside_by(box, p, side); });
  }
  if (polygon.count < 3) return;
  std::array<glm::vec2, 12> corners;
  for (std::size_t i = 0; i < polygon.count; ++i) corners[i] = divided(polygon.corners[i]);
  for (std::size_t i = 2; i < polygon.count; ++i) {
    use(std::array<glm::vec2, 3>{corners[0], corners[i - 1], corners[i]});
  }
}

// To what lies in the box, as far as there is a polygon of it.
void cut_to_view(WantedReceiver& wanted, const ClipBox& box, const ShadowView& view) {
  CutPolygon<glm::dvec3> polygon;
  for (const glm::dvec3& corner : wanted.corners_of_outline()) {
    polygon.corners[polygon.count++] = corner;
  }
  for (int side = 0; side < 4; ++side) {
    cut(polygon, [&](const glm::dvec3& p) {
      return inside_by(box, to_clip(view.world_to_clip, {p, 1.0}), side);
    });
  }
  if (polygon.count < 3 || polygon.count > wanted.outline.size()) return;
  std::copy_n(polygon.corners.begin(), polygon.count, wanted.outline.begin());
  wanted.corners = polygon.count;
}

// Triangles of a light on a receiver, few enough for a task.
struct Piece {
  std::uint32_t receiver;
  std::uint8_t light;
  std::size_t begin, end;
};

// Projected triangles that a task cuts, at the least.
constexpr std::size_t kTrianglesOfTask = 2048;

std::vector<Piece> pieces_of(const SeenReceivers& found,
                             std::span<const ProjectedShadows* const> shadows) {
  std::vector<Piece> pieces;
  for (std::uint32_t r = 0; r < found.boxes.size(); ++r) {
    if (found.boxes[r].y_end == 0) continue;
    for (std::size_t light = 0; light < shadows.size(); ++light) {
      if (shadows[light] == nullptr) continue;
      const std::vector<std::size_t>& begins = shadows[light]->begins;
      const std::size_t end = begins[r + std::size_t{1}];
      for (std::size_t t = begins[r]; t < end; t += kTrianglesOfTask) {
        pieces.push_back(
            {r, static_cast<std::uint8_t>(light), t, std::min(t + kTrianglesOfTask, end)});
      }
    }
  }
  return pieces;
}

// The ends of each task's pieces.
std::vector<std::size_t> ends_of_tasks(const std::vector<Piece>& pieces) {
  std::vector<std::size_t> ends;
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    triangles += pieces[i].end - pieces[i].begin;
    if (triangles < kTrianglesOfTask && i + 1 < pieces.size()) continue;
    ends.push_back(i + 1);
    triangles = 0;
  }
  return ends;
}

// Pixels whose centres lie between two places of the window, and a 16th of a pixel more, which no
// profile's rounding reaches.
Span centres_between(float low, float high, int size) {
  const float half = 0.5f * static_cast<float>(size);
  return {static_cast<int>(std::ceil((low + 1.0f) * half - 0.5625f)),
          static_cast<int>(std::floor((high + 1.0f) * half - 0.4375f)) + 1};
}

Span common(const Span& a, const Span& b) {
  return {std::max(a.x_begin, b.x_begin), std::min(a.x_end, b.x_end)};
}

bool is_empty(const Span& span) { return span.x_begin >= span.x_end; }

void cut_piece(const Piece& piece, const ProjectedShadows& shadows, const SeenBox& seen,
               const ShadowView& view, MaskDraws::Part& part) {
  const ClipBox box = clip_box({seen.x_begin, seen.y_begin, seen.x_end, seen.y_end}, view);
  const auto bit = static_cast<std::uint8_t>(1u << piece.light);
  for (std::size_t t = piece.begin; t < piece.end; ++t) {
    cut_shadow(shadows.triangles[t], view, box, [&](const std::array<glm::vec2, 3>& p) {
      // A corner at infinity, straight before the eye, is nowhere.
      if (!std::isfinite(p[0].x + p[0].y + p[1].x + p[1].y + p[2].x + p[2].y)) return;
      const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
      const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
      const Span columns =
          common(centres_between(left, right, view.width), {seen.x_begin, seen.x_end});
      const Span rows =
          common(centres_between(top, bottom, view.height), {seen.y_begin, seen.y_end});
      if (is_empty(columns) || is_empty(rows)) return;
      part.triangles.push_back({p, piece.receiver, bit});
      part.pixels.push_back({columns.x_begin, rows.x_begin, columns.x_end, rows.x_end});
    });
  }
}

struct MaskWriter {
  const ShadowView& view;
  std::span<const std::uint32_t> receivers;
  std::span<std::uint8_t> mask;
};

// Whether a triangle of a few pixels finds one that is not in shadow yet. On a curved surface
// dozens fall on the same.
bool may_change(const MaskWriter& to, const MaskTriangle& triangle, const Rectangle& pixels) {
  constexpr int kFew = 16;
  if ((pixels.x_end - pixels.x_begin) * (pixels.y_end - pixels.y_begin) > kFew) return true;
  for (int y = pixels.y_begin; y < pixels.y_end; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(to.view.width);
    const std::uint32_t* receivers = to.receivers.data() + row;
    const std::uint8_t* mask = to.mask.data() + row;
    for (int x = pixels.x_begin; x < pixels.x_end; ++x) {
      if (receivers[x] == triangle.receiver && (mask[x] & triangle.bit) == 0) return true;
    }
  }
  return false;
}

// `coverage` has bounds, and a covered_span().
template <class Coverage>
void fill_rows(const MaskWriter& to, const MaskTriangle& triangle, const Rectangle& pixels,
               const Coverage& coverage) {
  const Rectangle bounds = intersection(coverage.bounds, pixels);
  for (int y = bounds.y_begin; y < bounds.y_end; ++y) {
    const Span span = covered_span(coverage, y, bounds.x_begin, bounds.x_end);
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(to.view.width);
    const std::uint32_t* receivers = to.receivers.data() + row;
    std::uint8_t* mask = to.mask.data() + row;
    for (int x = span.x_begin; x < span.x_end; ++x) {
      if (receivers[x] == triangle.receiver) {
        mask[x] = static_cast<std::uint8_t>(mask[x] | triangle.bit);
      }
    }
  }
}

void fill(const MaskWriter& to, const MaskTriangle& triangle, const Rectangle& pixels) {
  const ShadowView& view = to.view;
  std::array<WindowVertex, 3> vertices;
  for (std::size_t i = 0; i < 3; ++i) {
    vertices[i] = to_window({triangle.corners[i], 0.0f, 1.0f}, view.width, view.height,
                            view.profile.viewport);
  }
  // As set_up_triangle() has it, whose result is ten times as large.
  if (view.profile.coverage == Coverage::edge_functions) {
    if (const auto functions = make_edge_functions(vertices, view.profile)) {
      fill_rows(to, triangle, pixels, *functions);
    }
  } else if (const auto lines = make_scanlines(vertices)) {
    fill_rows(to, triangle, pixels, *lines);
  }
}

// Rows that a task draws.
constexpr int kRowsOfMaskTask = 32;

}  // namespace

std::vector<WantedReceiver> seen_receivers(const Facets& facets,
                                           std::span<const std::vector<SeenFacet>> layers,
                                           const ShadowView& view) {
  std::vector<Rectangle> seen(facets.receivers.size());
  for (const std::vector<SeenFacet>& layer : layers) {
    for (int y = 0; y < view.height; ++y) {
      const SeenFacet* row =
          layer.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width);
      for (int begin = 0, end = 0; begin < view.width; begin = end) {
        for (end = begin + 1; end < view.width && row[end] == row[begin]; ++end) {
        }
        if (!shows_facet(row[begin])) continue;
        Rectangle& box = seen[facets.receiver_of[facet_of(row[begin])]];
        const bool is_first = box.y_end == 0;
        box = {is_first ? begin : std::min(box.x_begin, begin),
               is_first ? y : std::min(box.y_begin, y), std::max(box.x_end, end),
               std::max(box.y_end, y + 1)};
      }
    }
  }
  std::vector<WantedReceiver> wanted;
  for (std::uint32_t r = 0; r < seen.size(); ++r) {
    if (seen[r].y_end == 0) continue;
    const Receiver& receiver = facets.receivers[r];
    WantedReceiver& added = wanted.emplace_back(WantedReceiver{r, {}, receiver.corners});
    std::copy_n(receiver.outline.begin(), receiver.corners, added.outline.begin());
    if (receiver.corners == 4) cut_to_view(added, clip_box(seen[r], view), view);
  }
  return wanted;
}

MaskDraws cut_shadows(const Facets& facets, std::span<const ProjectedShadows* const> shadows,
                      std::span<const SeenFacet> seen, const ShadowView& view, ThreadPool& pool) {
  MaskDraws draws;
  draws.dark.resize(seen.size());
  const std::vector<DarkSides> dark = dark_sides(facets, shadows);
  SeenReceivers found;
  found.of_pixel.resize(seen.size());
  found.boxes = std::vector<SeenBox>(facets.receivers.size());
  pool.for_each(view.height,
                [&](int y) { find_seen(facets, seen, dark, view.width, y, found, draws.dark); });

  const std::vector<Piece> pieces = pieces_of(found, shadows);
  const std::vector<std::size_t> ends = ends_of_tasks(pieces);
  draws.parts.resize(ends.size());
  pool.for_each(static_cast<int>(ends.size()), [&](int number) {
    const auto task = static_cast<std::size_t>(number);
    for (std::size_t i = task == 0 ? 0 : ends[task - 1]; i < ends[task]; ++i) {
      cut_piece(pieces[i], *shadows[pieces[i].light], found.boxes[pieces[i].receiver], view,
                draws.parts[task]);
    }
  });
  draws.receivers = std::move(found.of_pixel);
  return draws;
}

void draw_shadow_mask(const MaskDraws& draws, const ShadowView& view, std::span<std::uint8_t> mask,
                      ThreadPool& pool) {
  std::copy(draws.dark.begin(), draws.dark.end(), mask.begin());
  pool.for_each((view.height + kRowsOfMaskTask - 1) / kRowsOfMaskTask, [&](int number) {
    const int y = number * kRowsOfMaskTask;
    const Rectangle band{0, y, view.width, std::min(y + kRowsOfMaskTask, view.height)};
    const MaskWriter writer{view, draws.receivers, mask};
    for (const MaskDraws::Part& part : draws.parts) {
      for (std::size_t i = 0; i < part.pixels.size(); ++i) {
        if (part.pixels[i].y_begin >= band.y_end || part.pixels[i].y_end <= band.y_begin) continue;
        const Rectangle pixels = intersection(part.pixels[i], band);
        if (may_change(writer, part.triangles[i], pixels)) fill(writer, part.triangles[i], pixels);
      }
    }
  });
}

}  // namespace softfocus
