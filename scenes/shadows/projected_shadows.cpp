#include "scenes/shadows/projected_shadows.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "raster/threads/loops.h"

namespace softfocus {
namespace {

// A plane through the light and an edge of a polygon, with the rest of the polygon on its positive
// side.
struct EdgePlane {
  glm::dvec3 across;
  glm::dvec3 on_it;
};

// That of the edge from corner i on, `across` of any length; 0 of an edge that points at the light.
EdgePlane edge_plane(std::span<const glm::dvec3> polygon, std::size_t i, const ShadowLight& light) {
  const glm::dvec3& a = polygon[i];
  const glm::dvec3& b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
  const glm::dvec3& inside = polygon[i > 0 ? i - 1 : polygon.size() - 1];
  const glm::dvec3 across = cross(b - a, light.place - a * light.w);
  return {dot(across, inside - a) < 0.0 ? -across : across, a};
}

// A receiver, and where on it shadows are wanted.
struct Target {
  std::uint32_t receiver;
  std::span<const glm::dvec3> outline;
};

// A receiver with its normal on the light's side.
struct LitReceiver {
  FacetPlane plane;
  double light_height;  // a cosine if the light is directional
  std::span<const glm::dvec3> whole;
  std::span<const glm::dvec3> outline;  // of the part that is wanted
  std::array<EdgePlane, 8> edges;       // of that
  std::size_t edge_count = 0;
};

// The plane through the light and the outline's edge from corner i on, with the outline on its
// positive side. None of an edge that is too short for that, or points at the light.
std::optional<EdgePlane> outline_edge(std::span<const glm::dvec3> outline, std::size_t i,
                                      const ShadowLight& light) {
  EdgePlane edge = edge_plane(outline, i, light);
  edge.across = normalize(edge.across);
  double low = 0.0, high = 0.0;
  for (const glm::dvec3& p : outline) {
    const double d = dot(edge.across, p - edge.on_it);
    low = std::min(low, d);
    high = std::max(high, d);
  }
  const double inside = std::max(high, -low), outside = std::min(high, -low);
  constexpr double kNothing = 0x1p-40;  // of the outline
  if (!(inside > 0.0) || outside > kNothing * inside) return {};
  if (-low > high) edge.across = -edge.across;
  return edge;
}

LitReceiver lit_receiver(const Receiver& receiver, std::span<const glm::dvec3> outline,
                         const ShadowLight& light, LitSide side) {
  FacetPlane plane = receiver.plane;
  if (side == LitSide::back) plane = {-plane.normal, -plane.offset};
  LitReceiver lit{plane, height_over(plane, light), receiver.corners_of_outline(), outline, {}};
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (const auto edge = outline_edge(outline, i, light)) lit.edges[lit.edge_count++] = *edge;
  }
  return lit;
}

bool is_lit(LitSide side) { return side == LitSide::front || side == LitSide::back; }

// 3 corners, a fourth where the receiver's plane cuts, a fifth where the light's height does.
struct CasterPolygon {
  std::array<glm::dvec4, 5> corners;
  std::size_t count = 0;
};

// Keeps what has distance(corner) >= 0. A new corner runs from the end inside to the one outside:
// two facets with a common edge get the same point.
template <class Distance, class Settle>
CasterPolygon cut_polygon(const CasterPolygon& polygon, const Distance& distance,
                          const Settle& settle) {
  CasterPolygon kept;
  const auto put = [&](const glm::dvec4& corner) {
    if (kept.count < kept.corners.size()) kept.corners[kept.count++] = corner;
  };
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const glm::dvec4& a = polygon.corners[i];
    const glm::dvec4& b = polygon.corners[(i + 1) % polygon.count];
    const double d_a = distance(a), d_b = distance(b);
    if (d_a >= 0.0) put(a);
    if ((d_a < 0.0) == (d_b < 0.0)) continue;
    put(settle(d_a < 0.0 ? b + (a - b) * (d_b / (d_b - d_a)) : a + (b - a) * (d_a / (d_a - d_b))));
  }
  if (kept.count < 3) kept.count = 0;
  return kept;
}

// Whether all of `points` are outside. Of an `across` of length 1.
bool is_beside(const EdgePlane& edge, std::span<const glm::dvec3> points, double margin_m) {
  return std::all_of(points.begin(), points.end(), [&](const glm::dvec3& p) {
    return dot(edge.across, p - edge.on_it) < -margin_m;
  });
}

// Of one of any length: mostly some point is inside, whatever the length.
bool is_beside_unscaled(EdgePlane edge, std::span<const glm::dvec3> points, double margin_m) {
  if (!is_beside(edge, points, 0.0)) return false;
  edge.across = normalize(edge.across);
  return is_beside(edge, points, margin_m);
}

bool all_before(std::span<const glm::dvec3> points, glm::dvec3 from, glm::dvec3 ahead) {
  return std::all_of(points.begin(), points.end(),
                     [&](const glm::dvec3& p) { return dot(p - from, ahead) > 0.0; });
}

// Seen from a point light, two polygons that do not both lie before it can be apart although
// neither has an edge that says so. Then a plane through a corner of each does.
bool is_elsewhere(std::span<const glm::dvec3> polygon, std::span<const glm::dvec3> points,
                  const ShadowLight& light, double margin_m) {
  if (light.w == 0.0) return false;
  glm::dvec3 ahead{0.0};
  for (const glm::dvec3& p : polygon) ahead += normalize(p - light.place);
  if (all_before(polygon, light.place, ahead) && all_before(points, light.place, ahead)) {
    return false;
  }
  const auto all_beyond = [&](std::span<const glm::dvec3> of, glm::dvec3 across, double side,
                              double least) {
    return std::all_of(of.begin(), of.end(), [&](const glm::dvec3& p) {
      return side * dot(across, p - light.place) >= least;
    });
  };
  for (const glm::dvec3& a : polygon) {
    for (const glm::dvec3& b : points) {
      const glm::dvec3 across = normalize(cross(a - light.place, b - light.place));
      if (across == glm::dvec3{0.0}) continue;
      for (const double side : {1.0, -1.0}) {
        if (all_beyond(polygon, across, side, -margin_m) &&
            all_beyond(points, across, -side, -margin_m)) {
          return true;
        }
      }
    }
  }
  return false;
}

// Whether a caster's plane has the receiver and the light on one side: no ray between them meets
// it.
bool stands_behind(const FacetPlane& caster, const LitReceiver& receiver, const ShadowLight& light,
                   double epsilon_m) {
  const double side = height_over(caster, light) > 0.0 ? 1.0 : -1.0;
  return std::all_of(receiver.whole.begin(), receiver.whole.end(), [&](const glm::dvec3& p) {
    return side * height_over(caster, p) >= -epsilon_m;
  });
}

// Whether a caster that reaches over the receiver's plane throws no shadow on it all the same.
bool misses(const Facets& facets, std::uint32_t caster, const LitReceiver& receiver,
            const ShadowLight& light) {
  if (stands_behind(facets.planes[caster], receiver, light, facets.epsilon_m)) return true;
  const std::array<glm::dvec3, 3>& corners = facets.facets[caster].corners;
  const double margin = facets.epsilon_m * 0x1p-20;
  for (std::size_t i = 0; i < receiver.edge_count; ++i) {
    if (is_beside(receiver.edges[i], corners, margin)) return true;
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (is_beside_unscaled(edge_plane(corners, i, light), receiver.outline, margin)) return true;
  }
  return is_elsewhere(receiver.whole, corners, light, margin);
}

// A caster's fate, as far as it is known beforehand.
enum class Throws : std::uint8_t { perhaps, a_shadow };

// The caster's shadow on the receiver's plane. With n.p = d the plane, h its heights and L the
// light, S = (h_L p - h_p L, h_L - w h_p): the matrix h_L I - L (n, -d)^T.
CasterPolygon shadow_of(const Facets& facets, std::uint32_t caster, const LitReceiver& receiver,
                        const ShadowLight& light, Throws known) {
  const Facet& facet = facets.facets[caster];
  const double epsilon = facets.epsilon_m;
  CasterPolygon polygon;
  double highest = 0.0, lowest = 0.0;
  for (const glm::dvec3& corner : facet.corners) {
    const double h = height_over(receiver.plane, corner);
    highest = polygon.count == 0 ? h : std::max(highest, h);
    lowest = polygon.count == 0 ? h : std::min(lowest, h);
    polygon.corners[polygon.count++] = glm::dvec4{corner, h};
  }
  if (highest <= epsilon) return {};
  if (light.w != 0.0 && lowest >= receiver.light_height) return {};
  if (known == Throws::perhaps && misses(facets, caster, receiver, light)) return {};
  if (lowest < epsilon) {
    polygon = cut_polygon(
        polygon, [&](const glm::dvec4& p) { return p.w - epsilon; },
        [&](const glm::dvec4& p) {
          return glm::dvec4{glm::dvec3{p}, epsilon};
        });
  }
  CasterPolygon shadow;
  for (; shadow.count < polygon.count; ++shadow.count) {
    const glm::dvec4& p = polygon.corners[shadow.count];
    const double h = p.w;
    shadow.corners[shadow.count] = {p.x * receiver.light_height - light.place.x * h,
                                    p.y * receiver.light_height - light.place.y * h,
                                    p.z * receiver.light_height - light.place.z * h,
                                    receiver.light_height - light.w * h};
  }
  // Points higher than a point light would be projected through it, onto the other side.
  if (light.w != 0.0 && highest > receiver.light_height) {
    shadow = cut_polygon(
        shadow, [](const glm::dvec4& p) { return p.w; },
        [](const glm::dvec4& p) {
          return glm::dvec4{glm::dvec3{p}, 0.0};
        });
  }
  return shadow;
}

Target target_of(const Facets& facets, std::uint32_t receiver) {
  return {receiver, facets.receivers[receiver].corners_of_outline()};
}

// Calls use(caster, polygon) for the shadow of each caster, in their order.
template <class Use>
void for_each_shadow(const Facets& facets, const Target& target, const ShadowLight& light,
                     LitSide side, std::span<const std::uint32_t> casters, Throws known,
                     const Use& use) {
  const LitReceiver receiver =
      lit_receiver(facets.receivers[target.receiver], target.outline, light, side);
  for (const std::uint32_t caster : casters) {
    if (facets.receiver_of[caster] == target.receiver) continue;
    const CasterPolygon polygon = shadow_of(facets, caster, receiver, light, known);
    if (polygon.count > 0) use(caster, polygon);
  }
}

std::vector<std::uint32_t> all_casters(const Facets& facets, const ShadowLight& light) {
  std::vector<std::uint32_t> casters;
  for (std::uint32_t i = 0; i < facets.facets.size(); ++i) {
    if (stops_light(facets.facets[i], facets.planes[i], light)) casters.push_back(i);
  }
  return casters;
}

// As a fan.
template <class Put>
void triangulate(const CasterPolygon& polygon, const Put& put) {
  for (std::size_t i = 2; i < polygon.count; ++i) {
    put(ProjectedTriangle{polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]});
  }
}

// Receivers that a task takes at once: many, or one each if there are few, which may be a room's
// walls and take most casters.
std::uint32_t receivers_a_task(std::uint32_t receivers) {
  return std::clamp(receivers / 256, std::uint32_t{1}, std::uint32_t{64});
}

// Receivers whose sides a task tells.
constexpr std::size_t kReceiversOfTask = 4096;

// Casters before a receiver, as one task takes them: all, or of a receiver of many, which may be a
// floor, a part.
constexpr std::size_t kCastersOfTask = 2048;
constexpr std::size_t kManyCasters = 2 * kCastersOfTask;

struct CasterPart {
  Target target;
  std::vector<std::uint32_t> casters;
  std::vector<ProjectedTriangle> triangles{};
  std::size_t first = 0;  // of the receiver's
};

// The casters that a task's first pass found to throw a shadow; those of its target i end at
// ends[i].
struct FoundCasters {
  std::vector<std::uint32_t> casters;
  std::vector<std::size_t> ends;
  std::vector<CasterPart> parts;  // of its targets of many
};

void add_parts(const Target& target, std::span<const std::uint32_t> casters,
               std::vector<CasterPart>& parts) {
  for (std::size_t i = 0; i < casters.size(); i += kCastersOfTask) {
    const auto part = casters.subspan(i, std::min(kCastersOfTask, casters.size() - i));
    parts.push_back({target, {part.begin(), part.end()}});
  }
}

void project_part(const Facets& facets, const ShadowLight& light, LitSide side, CasterPart& part) {
  part.triangles.reserve(part.casters.size());
  for_each_shadow(facets, part.target, light, side, part.casters, Throws::perhaps,
                  [&](std::uint32_t, const CasterPolygon& polygon) {
                    triangulate(polygon, [&](const ProjectedTriangle& triangle) {
                      part.triangles.push_back(triangle);
                    });
                  });
}

// target(i) gives the i-th of `targets`, in the order of receivers, and find(target, memory) its
// casters. Targets of more than `many` are taken in parts.
template <class Memory, class Targets, class Find>
ProjectedShadows count_and_fill(const Facets& facets, const ShadowLight& light, ThreadPool& pool,
                                std::uint32_t targets, const Targets& target, std::size_t many,
                                const Find& find) {
  ProjectedShadows made;
  made.lit = lit_sides(facets, light, &pool);
  const std::uint32_t a_task = receivers_a_task(targets);
  const auto tasks = static_cast<int>((targets + a_task - 1) / a_task);
  std::vector<FoundCasters> found(static_cast<std::size_t>(tasks));
  made.begins.assign(facets.receivers.size() + 1, 0);
  for_each_with<Memory>(pool, tasks, [&](int task, Memory& memory) {
    FoundCasters& of_task = found[static_cast<std::size_t>(task)];
    const std::uint32_t begin = static_cast<std::uint32_t>(task) * a_task;
    for (std::uint32_t i = begin; i < std::min(begin + a_task, targets); ++i) {
      const Target of = target(i);
      const LitSide side = made.lit[of.receiver];
      if (is_lit(side)) {
        const std::span<const std::uint32_t> casters = find(of, memory);
        if (casters.size() > many) {
          add_parts(of, casters, of_task.parts);
        } else {
          for_each_shadow(facets, of, light, side, casters, Throws::perhaps,
                          [&](std::uint32_t caster, const CasterPolygon& polygon) {
                            made.begins[of.receiver + std::size_t{1}] += polygon.count - 2;
                            of_task.casters.push_back(caster);
                          });
        }
      }
      of_task.ends.push_back(of_task.casters.size());
    }
  });
  std::vector<CasterPart*> parts;
  for (FoundCasters& of_task : found) {
    for (CasterPart& part : of_task.parts) parts.push_back(&part);
  }
  pool.for_each(static_cast<int>(parts.size()), [&](int i) {
    CasterPart& part = *parts[static_cast<std::size_t>(i)];
    project_part(facets, light, made.lit[part.target.receiver], part);
  });
  for (CasterPart* part : parts) {
    std::size_t& count = made.begins[part->target.receiver + std::size_t{1}];
    part->first = count;
    count += part->triangles.size();
  }
  std::partial_sum(made.begins.begin(), made.begins.end(), made.begins.begin());
  made.triangles.resize(made.begins.back());
  pool.for_each(static_cast<int>(parts.size()), [&](int i) {
    const CasterPart& part = *parts[static_cast<std::size_t>(i)];
    std::copy(part.triangles.begin(), part.triangles.end(),
              made.triangles.begin() +
                  static_cast<std::ptrdiff_t>(made.begins[part.target.receiver] + part.first));
  });
  pool.for_each(tasks, [&](int task) {
    const FoundCasters& of_task = found[static_cast<std::size_t>(task)];
    const std::uint32_t begin = static_cast<std::uint32_t>(task) * a_task;
    std::size_t first = 0;
    for (std::size_t i = 0; i < of_task.ends.size(); ++i) {
      const Target of = target(begin + static_cast<std::uint32_t>(i));
      const std::span casters{of_task.casters.data() + first, of_task.ends[i] - first};
      first = of_task.ends[i];
      if (casters.empty()) continue;
      ProjectedTriangle* to = made.triangles.data() + made.begins[of.receiver];
      for_each_shadow(facets, of, light, made.lit[of.receiver], casters, Throws::a_shadow,
                      [&](std::uint32_t, const CasterPolygon& polygon) {
                        triangulate(polygon,
                                    [&](const ProjectedTriangle& triangle) { *to++ = triangle; });
                      });
    }
  });
  return made;
}

}  // namespace

LitSide lit_side(const Receiver& receiver, const ShadowLight& light, double epsilon_m) {
  if (!has_plane(receiver.plane)) return LitSide::both;
  const double before = height_over(receiver.plane, light);
  // A point light in the plane shines along it, and so does a directional one at a right angle.
  const double least = light.w != 0.0 ? epsilon_m : 0x1p-40;
  if (before > least) return LitSide::front;
  return before < -least && receiver.two_sided ? LitSide::back : LitSide::none;
}

std::vector<LitSide> lit_sides(const Facets& facets, const ShadowLight& light, ThreadPool* pool) {
  std::vector<LitSide> lit(facets.receivers.size());
  for_each_part(pool, lit.size(), kReceiversOfTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      lit[r] = lit_side(facets.receivers[r], light, facets.epsilon_m);
    }
  });
  return lit;
}

ProjectedShadows project_in_sequence(const Facets& facets, const ShadowLight& light) {
  ProjectedShadows made;
  made.lit = lit_sides(facets, light);
  made.begins.assign(1, 0);
  const std::vector<std::uint32_t> casters = all_casters(facets, light);
  for (std::uint32_t r = 0; r < facets.receivers.size(); ++r) {
    if (is_lit(made.lit[r])) {
      for_each_shadow(facets, target_of(facets, r), light, made.lit[r], casters, Throws::perhaps,
                      [&](std::uint32_t, const CasterPolygon& polygon) {
                        triangulate(polygon, [&](const ProjectedTriangle& triangle) {
                          made.triangles.push_back(triangle);
                        });
                      });
    }
    made.begins.push_back(made.triangles.size());
  }
  return made;
}

ProjectedShadows project_in_parallel(const Facets& facets, const ShadowLight& light,
                                     ThreadPool& pool) {
  const std::vector<std::uint32_t> casters = all_casters(facets, light);
  struct Nothing {};
  return count_and_fill<Nothing>(
      facets, light, pool, static_cast<std::uint32_t>(facets.receivers.size()),
      [&](std::uint32_t r) { return target_of(facets, r); }, casters.size(),
      [&](const Target&, Nothing&) { return std::span<const std::uint32_t>{casters}; });
}

ProjectedShadows project_by_grid(const Facets& facets, const ShadowLight& light, ThreadPool& pool) {
  const LightGrid grid = make_light_grid(facets, light, &pool);
  return count_and_fill<CasterSearch>(
      facets, light, pool, static_cast<std::uint32_t>(facets.receivers.size()),
      [&](std::uint32_t r) { return target_of(facets, r); }, kManyCasters,
      [&](const Target& of, CasterSearch& search) {
        return find_casters(grid, of.outline, search);
      });
}

ProjectedShadows project_onto(std::span<const WantedReceiver> wanted, const Facets& facets,
                              const ShadowLight& light, ThreadPool& pool) {
  // Which cells they look at is worth finding if they are few.
  const bool are_few = wanted.size() < facets.receivers.size() / 4;
  const LightGrid grid =
      make_light_grid(facets, light, &pool, are_few ? wanted : std::span<const WantedReceiver>{});
  ProjectedShadows made = count_and_fill<CasterSearch>(
      facets, light, pool, static_cast<std::uint32_t>(wanted.size()),
      [&](std::uint32_t i) {
        return Target{wanted[i].receiver, wanted[i].corners_of_outline()};
      },
      kManyCasters,
      [&](const Target& of, CasterSearch& search) {
        return find_casters(grid, of.outline, search);
      });
  made.of_all = false;
  return made;
}

}  // namespace softfocus
