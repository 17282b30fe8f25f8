#include "scenes/make/shapes.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/vec2.hpp>
#include <numeric>
#include <optional>
#include <tuple>

#include "raster/numbers/exact_math.h"
#include "raster/numbers/random_bits.h"
#include "raster/numbers/vector_math.h"
#include "scenes/make/grid_mesh.h"
#include "scenes/make/procedural_texture.h"

namespace softfocus {
namespace {

double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The polygon in the plane of its two larger extents, counter-clockwise. From the first
// corner, so that a polygon far from the origin loses nothing.
std::vector<glm::dvec2> flattened(std::span<const glm::dvec3> corners) {
  glm::dvec3 normal{0.0};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 next = corners[(i + 1) % corners.size()] - corners[0];
    normal += cross(corners[i] - corners[0], next);
  }
  const glm::dvec3 size{std::fabs(normal.x), std::fabs(normal.y), std::fabs(normal.z)};
  const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
  const int right = (axis + 1) % 3;
  const int up = (axis + 2) % 3;
  const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;
  std::vector<glm::dvec2> flat;
  for (const glm::dvec3& corner : corners) {
    const glm::dvec3 p = corner - corners[0];
    flat.emplace_back(p[right] * sign, p[up]);
  }
  return flat;
}

// The corners of a polygon that are left: a ring of indices into `flat`.
struct Ring {
  std::vector<glm::dvec2> flat;
  std::vector<std::uint32_t> before, after;
  std::vector<std::uint32_t> changed;  // when the corner was cut off, or its neighbours were
  std::uint32_t now;
  std::size_t count;
  /// Why a corner was no ear: a corner in the way, or itself, and when. Until one of the two
  /// changes it still is none.
  struct Obstacle {
    std::uint32_t corner, seen;
  };
  std::array<std::vector<Obstacle>, 2> obstacles;  // by what a cut must avoid
};

// Even-odd: whether a place lies inside a loop, or nothing if it lies on its edge.
std::optional<bool> is_inside(const std::vector<glm::dvec2>& flat,
                              std::span<const std::uint32_t> loop, glm::dvec2 p) {
  bool inside = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    glm::dvec2 low = flat[loop[i]];
    glm::dvec2 high = flat[loop[(i + 1) % loop.size()]];
    if (low.y > high.y) std::swap(low, high);
    const double side = turn(low, high, p);
    const bool within = std::min(low.x, high.x) <= p.x && p.x <= std::max(low.x, high.x);
    if (side == 0.0 && low.y <= p.y && p.y <= high.y && within) return std::nullopt;
    if (low.y <= p.y && p.y < high.y && side > 0.0) inside = !inside;
  }
  return inside;
}

bool is_nested(const std::vector<glm::dvec2>& flat, std::span<const std::uint32_t> inner,
               std::span<const std::uint32_t> outer) {
  for (const std::uint32_t corner : inner) {
    if (const auto inside = is_inside(flat, outer, flat[corner])) return *inside;
  }
  return false;
}

double twice_area(const std::vector<glm::dvec2>& flat, std::span<const std::uint32_t> loop) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    sum += turn(flat[loop[0]], flat[loop[i]], flat[loop[i + 1]]);
  }
  return sum;
}

// The corners in an order in which holes run against what they are holes of, and what is not a hole
// counter-clockwise. Where an outline comes back to a place it has made a loop; if that lies within
// the rest, or the rest within it, the inner one is a hole, however it runs.
std::vector<std::uint32_t> with_holes_turned(const std::vector<glm::dvec2>& flat) {
  std::vector<std::uint32_t> order(flat.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<std::uint32_t> by_place = order;
  std::sort(by_place.begin(), by_place.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(flat[a].x, flat[a].y, a) < std::tie(flat[b].x, flat[b].y, b);
  });
  for (std::size_t i = 0; i + 1 < by_place.size(); ++i) {
    if (flat[by_place[i]] != flat[by_place[i + 1]]) continue;
    const auto one = std::find(order.begin(), order.end(), by_place[i]);
    const auto other = std::find(order.begin(), order.end(), by_place[i + 1]);
    const auto first = std::min(one, other);
    const auto back = std::max(one, other);
    const std::vector<std::uint32_t> loop(first, back);
    std::vector<std::uint32_t> rest(back, order.end());
    rest.insert(rest.end(), order.begin(), first);
    if (twice_area(flat, loop) * twice_area(flat, rest) <= 0.0) continue;
    if (is_nested(flat, loop, rest) || is_nested(flat, rest, loop)) std::reverse(first + 1, back);
  }
  if (twice_area(flat, order) < 0.0) std::reverse(order.begin(), order.end());
  return order;
}

Ring make_ring(std::vector<glm::dvec2> flat) {
  const auto count = static_cast<std::uint32_t>(flat.size());
  const std::vector<std::uint32_t> order = with_holes_turned(flat);
  Ring ring{std::move(flat),
            std::vector(count, 0u),
            std::vector(count, 0u),
            std::vector(count, 1u),
            1,
            count,
            {}};
  for (std::uint32_t i = 0; i < count; ++i) {
    ring.after[order[i]] = order[(i + 1) % count];
    ring.before[order[(i + 1) % count]] = order[i];
  }
  for (auto& obstacles : ring.obstacles) obstacles.resize(count, {0, 0});
  return ring;
}

double turn_at(const Ring& ring, std::uint32_t corner) {
  return turn(ring.flat[ring.before[corner]], ring.flat[corner], ring.flat[ring.after[corner]]);
}

// Whether a corner lies on its neighbour, or both its edges go the same way: it has no area, and
// no other polygon's edge can end at it between its neighbours.
bool is_spike(const Ring& ring, std::uint32_t corner) {
  const glm::dvec2 in = ring.flat[corner] - ring.flat[ring.before[corner]];
  const glm::dvec2 out = ring.flat[ring.after[corner]] - ring.flat[corner];
  return turn_at(ring, corner) == 0.0 && in.x * out.x + in.y * out.y <= 0.0;
}

// What a cut must avoid. An outline that touches itself, as one around a hole does, has cuts that
// touch it: a corner then is in the way only if an edge goes from it into the triangle.
enum class Touching : std::uint8_t { at_corners, anywhere };

bool is_in_the_way(const Ring& ring, std::uint32_t other, const std::array<glm::dvec2, 3>& triangle,
                   Touching allowed) {
  const glm::dvec2 p = ring.flat[other];
  bool before_enters = true;
  bool after_enters = true;
  int sides = 0;  // that p lies on
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec2 from = triangle[i];
    const glm::dvec2 to = triangle[(i + 1) % 3];
    const double side = turn(from, to, p);
    if (side < 0.0) return false;
    if (side > 0.0) continue;
    ++sides;
    before_enters = before_enters && turn(from, to, ring.flat[ring.before[other]]) > 0.0;
    after_enters = after_enters && turn(from, to, ring.flat[ring.after[other]]) > 0.0;
  }
  const bool may_touch = allowed == Touching::anywhere ? sides > 0 : sides > 1;
  return !may_touch || before_enters || after_enters;
}

// The corner that keeps another from being cut off: itself if it turns inwards.
std::optional<std::uint32_t> find_obstacle(const Ring& ring, std::uint32_t corner,
                                           Touching allowed) {
  if (!(turn_at(ring, corner) > 0.0)) return corner;
  const std::uint32_t first = ring.before[corner];
  const std::uint32_t last = ring.after[corner];
  const std::array<glm::dvec2, 3> triangle{ring.flat[first], ring.flat[corner], ring.flat[last]};
  const auto [a, b, c] = triangle;
  const glm::dvec2 low{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})};
  const glm::dvec2 high{std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})};
  for (std::uint32_t other = ring.after[last]; other != first; other = ring.after[other]) {
    const glm::dvec2 p = ring.flat[other];
    if (p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y) continue;
    if (is_in_the_way(ring, other, triangle, allowed)) return other;
  }
  return std::nullopt;
}

bool is_ear(Ring& ring, std::uint32_t corner, Touching allowed) {
  Ring::Obstacle& known = ring.obstacles[static_cast<std::size_t>(allowed)][corner];
  if (known.seen >= std::max(ring.changed[corner], ring.changed[known.corner])) return false;
  const auto found = find_obstacle(ring, corner, allowed);
  if (found) known = {*found, ring.now};
  return !found;
}

// The next corner to cut off, from `start` on: an ear; one that touches other edges; one without an
// area; `start` if the outline crosses itself.
std::uint32_t next_cut(Ring& ring, std::uint32_t start) {
  std::optional<std::uint32_t> touching;
  std::optional<std::uint32_t> straight;
  std::uint32_t corner = start;
  for (std::size_t tried = 0; tried < ring.count; ++tried, corner = ring.after[corner]) {
    if (is_ear(ring, corner, Touching::at_corners)) return corner;
    if (!touching && is_ear(ring, corner, Touching::anywhere)) touching = corner;
    if (!touching && !straight && turn_at(ring, corner) == 0.0) straight = corner;
  }
  return touching ? *touching : straight.value_or(start);
}

double squared_distance(glm::dvec3 a, glm::dvec3 b) { return dot(a - b, a - b); }

// Whether a quadrilateral is cut from corner 1 to 3 rather than from 0 to 2.
bool cut_from_second(std::span<const glm::dvec3> corners, const std::vector<glm::dvec2>& flat) {
  // The diagonal 0-2 lies inside where both its triangles turn the right way.
  const std::array first{turn(flat[0], flat[1], flat[2]), turn(flat[0], flat[2], flat[3])};
  const std::array second{turn(flat[1], flat[2], flat[3]), turn(flat[1], flat[3], flat[0])};
  const bool first_inside = first[0] > 0.0 && first[1] > 0.0;
  const bool second_inside = second[0] > 0.0 && second[1] > 0.0;
  if (first_inside != second_inside) return second_inside;
  if (!first_inside) {  // a triangle without an area on the edge of the other one
    const bool first_covers = first[0] >= 0.0 && first[1] >= 0.0;
    const bool second_covers = second[0] >= 0.0 && second[1] >= 0.0;
    if (first_covers != second_covers) return second_covers;
  }
  return squared_distance(corners[1], corners[3]) < squared_distance(corners[0], corners[2]);
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(std::span<const glm::dvec3> corners) {
  assert(corners.size() >= 3);
  if (corners.size() == 3) return {{0, 1, 2}};
  const std::vector<glm::dvec2> flat = flattened(corners);
  if (corners.size() == 4) {
    if (cut_from_second(corners, flat)) return {{0, 1, 3}, {1, 2, 3}};
    return {{0, 1, 2}, {0, 2, 3}};
  }

  Ring ring = make_ring(flat);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint32_t corner = 1;
  const auto cut = [&] {
    const std::uint32_t first = ring.before[corner];
    const std::uint32_t last = ring.after[corner];
    triangles.push_back({first, corner, last});
    ring.after[first] = last;
    ring.before[last] = first;
    --ring.count;
    ring.changed[first] = ring.changed[corner] = ring.changed[last] = ++ring.now;
    corner = last;
  };
  // Spikes first. What is cut may leave another before it.
  std::size_t straight = 0;
  while (ring.count > 3 && straight < ring.count) {
    straight = is_spike(ring, corner) ? 0 : straight + 1;
    if (straight > 0) {
      corner = ring.after[corner];
    } else {
      cut();
      corner = ring.before[corner];
    }
  }
  corner = 1;
  while (ring.after[ring.before[corner]] != corner) ++corner;
  while (ring.count > 3) {
    corner = next_cut(ring, corner);
    cut();
    while (ring.count > 3 && (is_spike(ring, corner) || is_spike(ring, ring.before[corner]))) {
      if (!is_spike(ring, corner)) corner = ring.before[corner];
      cut();
    }
  }
  std::array<std::uint32_t, 3> last{ring.before[corner], corner, ring.after[corner]};
  std::rotate(last.begin(), std::min_element(last.begin(), last.end()), last.end());
  triangles.push_back(last);
  return triangles;
}

namespace {

using exact_math::cos_degrees;
using exact_math::sin_degrees;

// The horizontal direction at a column of a full turn; +z first, then +x. The last
// column has the bits of the first: 360 degrees reduce to 0 exactly.
glm::dvec3 heading(double column, int columns) {
  const double degrees = 360.0 * column / columns;
  return {sin_degrees(degrees), 0.0, cos_degrees(degrees)};
}

// -0.5 to 0.5 over the cells; opposite places differ in sign alone, so that faces
// that meet agree to the bit.
double centred(double place, int cells) { return (2.0 * place - cells) / (2.0 * cells); }

constexpr glm::dvec3 kUp{0.0, 1.0, 0.0};

}  // namespace

Mesh make_sphere(double radius, int segments, int rings) {
  assert(radius > 0.0 && segments >= 3 && rings >= 2);
  Mesh mesh;
  append_grid(mesh, {segments, rings, true, true}, [&](double column, int row) {
    const double from_pole = 180.0 * row / rings;
    const glm::dvec3 out =
        heading(column, segments) * sin_degrees(from_pole) + kUp * cos_degrees(from_pole);
    return SurfacePoint{out * radius, out, {column / segments, static_cast<double>(row) / rings}};
  });
  return mesh;
}

Mesh make_torus(double ring_radius, double tube_radius, int segments, int sides) {
  assert(tube_radius > 0.0 && tube_radius < ring_radius && segments >= 3 && sides >= 3);
  Mesh mesh;
  append_grid(mesh, {segments, sides}, [&](double column, int row) {
    const double around_tube = 360.0 * row / sides;
    const glm::dvec3 ring = heading(column, segments);
    const glm::dvec3 out = ring * sin_degrees(around_tube) + kUp * cos_degrees(around_tube);
    return SurfacePoint{ring * ring_radius + out * tube_radius,
                        out,
                        {column / segments, static_cast<double>(row) / sides}};
  });
  return mesh;
}

Mesh make_cone(double radius, double height, int segments, int rings) {
  assert(radius > 0.0 && height > 0.0 && segments >= 3 && rings >= 1);
  const double slant = std::sqrt(radius * radius + height * height);
  Mesh mesh;
  append_grid(mesh, {segments, rings, true, false}, [&](double column, int row) {
    const double down = static_cast<double>(row) / rings;
    const glm::dvec3 out = heading(column, segments);
    return SurfacePoint{out * (radius * down) + kUp * (height * (rings - row) / rings),
                        (out * height + kUp * radius) / slant,
                        {column / segments, down}};
  });
  append_grid(mesh, {segments, 1, false, true}, [&](double column, int row) {
    const glm::dvec3 rim = row == 0 ? heading(column, segments) : glm::dvec3{0.0};
    return SurfacePoint{rim * radius, -kUp, {0.5 + 0.5 * rim.x, 0.5 - 0.5 * rim.z}};
  });
  return mesh;
}

Mesh make_cube(double size, int cells) {
  assert(size > 0.0 && cells >= 1);
  struct Face {
    glm::dvec3 outward;
    glm::dvec3 right;
    glm::dvec3 up;
  };
  // outward = right x up
  static constexpr std::array<Face, 6> kFaces = {{
      {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
      {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
      {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}},
      {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
      {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
      {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
  }};
  Mesh mesh;
  for (const Face& face : kFaces) {
    append_grid(mesh, {cells, cells}, [&](double column, int row) {
      const glm::dvec3 place =
          face.outward * 0.5 + face.right * centred(column, cells) - face.up * centred(row, cells);
      return SurfacePoint{
          place * size, face.outward, {column / cells, static_cast<double>(row) / cells}};
    });
  }
  return mesh;
}

Mesh make_plane(double width, double depth, int cells_x, int cells_z) {
  assert(width > 0.0 && depth > 0.0 && cells_x >= 1 && cells_z >= 1);
  Mesh mesh;
  append_grid(mesh, {cells_x, cells_z}, [&](double column, int row) {
    return SurfacePoint{{centred(column, cells_x) * width, 0.0, centred(row, cells_z) * depth},
                        kUp,
                        {column / cells_x, static_cast<double>(row) / cells_z}};
  });
  return mesh;
}

Mesh inside_out(Mesh mesh) {
  for (glm::vec3& normal : mesh.normals) normal = -normal;
  for (glm::vec2& uv : mesh.uvs) uv.x = 1.0f - uv.x;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  }
  return mesh;
}

void repeat_uvs(Mesh& mesh, glm::dvec2 times) {
  for (glm::vec2& uv : mesh.uvs) uv = glm::vec2{glm::dvec2{uv} * times};
}

namespace {

bool too_near(const Ball& a, const Ball& b, double gap) {
  const glm::dvec3 between = a.centre - b.centre;
  const double least = a.radius + b.radius + gap;
  return dot(between, between) < least * least;
}

}  // namespace

std::optional<std::vector<Ball>> place_balls(const BallRule& rule,
                                             const std::vector<Ball>& obstacles) {
  RandomSequence random{rule.seed};
  std::vector<Ball> balls;
  for (int i = 0; i < rule.count; ++i) {
    Ball ball;
    ball.radius = next_between(random, rule.radius_min, rule.radius_max);
    const auto is_taken = [&](const Ball& other) { return too_near(ball, other, rule.gap); };
    int attempt = 0;
    do {
      if (attempt++ == kBallAttempts) return std::nullopt;
      ball.centre.x = next_between(random, rule.region_min.x, rule.region_max.x);
      ball.centre.y = next_between(random, rule.region_min.y, rule.region_max.y);
      ball.centre.z = next_between(random, rule.region_min.z, rule.region_max.z);
      if (rule.on_ground) ball.centre.y = rule.region_min.y + ball.radius;
    } while (std::any_of(obstacles.begin(), obstacles.end(), is_taken) ||
             std::any_of(balls.begin(), balls.end(), is_taken));
    balls.push_back(ball);
  }
  return balls;
}

namespace {

constexpr double kFocus = 2.0;    // metres, as all here
constexpr double kNearest = 1.0;  // of the spheres' centres
constexpr double kFarthest = 12.0;
constexpr double kFovYDegrees = 45.0;
// Radii on a picture whose height is 2. 250 discs of these cover the picture twice over.
constexpr double kSmallest = 0.06;
constexpr double kLargest = 0.14;

Material sphere_material() {
  Material material;
  material.name = "spheres";
  material.diffuse = glm::vec3{1.0f};
  material.specular = glm::vec3{0.3f};
  material.shininess = 40;
  material.texture = 0;
  return material;
}

Texture sphere_texture() {
  return make_procedural_texture(
      *find_texture_pattern("marble"),
      {.size = 256, .cells = 4, .colours = {{0.85f, 0.83f, 0.78f}, {0.10f, 0.16f, 0.34f}}});
}

// The picture's places by the additive sequence of the plastic number (Roberts 2018), which
// leaves no gaps; the depth by chance, evenly in its reciprocal and so in the signed radius
// of the circle of confusion.
Object placed_sphere(int index, double aspect, RandomSequence& random) {
  const auto place = [&](double step) {
    const double sum = 0.5 + step * (index + 1);
    return 2.0 * (sum - std::floor(sum)) - 1.0;
  };
  const double depth = 1.0 / next_between(random, 1.0 / kFarthest, 1.0 / kNearest);
  const double half_height = depth * exact_math::tan_degrees(kFovYDegrees / 2.0);
  Object object;
  object.position = {place(0.7548776662466927) * aspect * half_height,
                     place(0.5698402909980532) * half_height, -depth};
  object.scale =
      glm::dvec3{next_between(random, kSmallest, kLargest) * std::sqrt(aspect) * half_height};
  for (int axis = 0; axis < 3; ++axis) {
    object.rotation_degrees[axis] = next_between(random, 0.0, 360.0);
  }
  return object;
}

}  // namespace

SphereCut sphere_cut(int triangles) {
  assert(triangles >= kLeastFieldTriangles && triangles <= kMostFieldTriangles);
  // A sphere has two triangles for each segment of each ring but one.
  const double cells = triangles / (2.0 * kFieldSpheres);
  SphereCut best{3, 2};
  double best_error = HUGE_VAL;
  int best_shape = 0;
  const int most_bands = std::max(static_cast<int>(std::sqrt(cells)), 1);
  for (int bands = std::max(most_bands / 2, 1); bands <= most_bands; ++bands) {
    const int segments = std::max(static_cast<int>(std::lround(cells / bands)), 3);
    const double error = std::fabs(segments * bands - cells);
    const int shape = std::abs(segments - 2 * bands);  // twice as many around: square cells
    if (error < best_error || (error == best_error && shape < best_shape)) {
      best = {segments, bands + 1};
      best_error = error;
      best_shape = shape;
    }
  }
  return best;
}

Scene sphere_field(int triangles, double aspect) {
  Scene scene;
  scene.name = "spheres";
  scene.title = "Sphere field";
  scene.camera = {.position = {0.0, 0.0, 0.0},
                  .target = {0.0, 0.0, -1.0},
                  .fov_y_degrees = kFovYDegrees,
                  .near_m = 0.1,
                  .far_m = 50.0};
  // The horizon has a circle of 26 pixels of 1024, a radius.
  scene.lens = {.lens = {.focal_length_mm = 85.0, .f_number = 1.0, .focus_m = kFocus},
                .coc_scale = 1.0,
                .max_coc_px_at_1024 = 16.0};
  scene.background = {0.30f, 0.46f, 0.68f};
  scene.ambient_light = glm::vec3{0.3f};
  scene.lights = {{LightKind::directional, {-0.5f, 0.9f, 0.6f}, {0.95f, 0.90f, 0.80f}}};
  scene.textures = {sphere_texture()};
  scene.materials = {sphere_material()};
  const SphereCut cut = sphere_cut(triangles);
  scene.meshes = {make_sphere(1.0, cut.segments, cut.rings)};
  repeat_uvs(scene.meshes[0], {4.0, 2.0});
  RandomSequence random{250};
  for (int i = 0; i < kFieldSpheres; ++i) {
    scene.objects.push_back(placed_sphere(i, aspect, random));
  }
  return scene;
}

}  // namespace softfocus
