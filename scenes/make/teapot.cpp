#include "scenes/make/teapot.h"

#include <array>
#include <cassert>

#include "raster/numbers/vector_math.h"
#include "scenes/make/grid_mesh.h"

// Newell's figures, y up. His surfaces of revolution are quarters whose control
// points follow from a profile: at radius r the quarter from +z to +x is
//
//   (0, y, r)  (k, y, r)  (r, y, k)  (r, y, 0)       k = 0.56 r
//
// an almost-circle (0.5523 r would be nearest to one; 0.56 is his). The knob's k is
// rounded in his table to 0.45 at r = 0.8. A profile runs from the lid's top down the
// outside to the middle of the foot, so that all patches face the same way.

namespace softfocus {
namespace {

using Row = std::array<glm::dvec3, 4>;
using Patch = std::array<Row, 4>;  // rows run down, points in a row to the right

struct ProfilePoint {
  double radius;
  double y;
  double shoulder;  // k
};

constexpr ProfilePoint on_profile(double radius, double y) { return {radius, y, 0.56 * radius}; }

constexpr double kHeight = 3.15;

constexpr std::array<std::array<ProfilePoint, 4>, 6> kProfiles = {{
    // lid
    {{{0.0, kHeight, 0.0}, {0.8, kHeight, 0.45}, on_profile(0.0, 2.85), on_profile(0.2, 2.7)}},
    {{on_profile(0.2, 2.7), on_profile(0.4, 2.55), on_profile(1.3, 2.55), on_profile(1.3, 2.4)}},
    // rim
    {{on_profile(1.4, 2.4), on_profile(1.3375, 2.53125), on_profile(1.4375, 2.53125),
      on_profile(1.5, 2.4)}},
    // body
    {{on_profile(1.5, 2.4), on_profile(1.75, 1.875), on_profile(2.0, 1.35), on_profile(2.0, 0.9)}},
    {{on_profile(2.0, 0.9), on_profile(2.0, 0.45), on_profile(1.5, 0.225), on_profile(1.5, 0.15)}},
    // foot
    {{on_profile(1.5, 0.15), on_profile(1.5, 0.075), on_profile(1.425, 0.0), on_profile(0.0, 0.0)}},
}};

// Handle and spout: the half with z >= 0 of each section, from the body outwards.
// A row runs so that the patch faces outwards; the other half is its mirror image.
constexpr std::array<Row, 7> kHandle = {{
    {{{-1.5, 2.25, 0.0}, {-1.5, 2.25, 0.3}, {-1.6, 2.025, 0.3}, {-1.6, 2.025, 0.0}}},
    {{{-2.5, 2.25, 0.0}, {-2.5, 2.25, 0.3}, {-2.3, 2.025, 0.3}, {-2.3, 2.025, 0.0}}},
    {{{-3.0, 2.25, 0.0}, {-3.0, 2.25, 0.3}, {-2.7, 2.025, 0.3}, {-2.7, 2.025, 0.0}}},
    {{{-3.0, 1.8, 0.0}, {-3.0, 1.8, 0.3}, {-2.7, 1.8, 0.3}, {-2.7, 1.8, 0.0}}},
    {{{-3.0, 1.35, 0.0}, {-3.0, 1.35, 0.3}, {-2.7, 1.575, 0.3}, {-2.7, 1.575, 0.0}}},
    {{{-2.65, 0.9375, 0.0}, {-2.65, 0.9375, 0.3}, {-2.5, 1.125, 0.3}, {-2.5, 1.125, 0.0}}},
    {{{-1.9, 0.6, 0.0}, {-1.9, 0.6, 0.3}, {-2.0, 0.9, 0.3}, {-2.0, 0.9, 0.0}}},
}};

constexpr std::array<Row, 7> kSpout = {{
    {{{1.7, 0.6, 0.0}, {1.7, 0.6, 0.66}, {1.7, 1.425, 0.66}, {1.7, 1.425, 0.0}}},
    {{{3.1, 0.825, 0.0}, {3.1, 0.825, 0.66}, {2.6, 1.425, 0.66}, {2.6, 1.425, 0.0}}},
    {{{2.4, 2.025, 0.0}, {2.4, 2.025, 0.25}, {2.3, 2.1, 0.25}, {2.3, 2.1, 0.0}}},
    {{{3.3, 2.4, 0.0}, {3.3, 2.4, 0.25}, {2.7, 2.4, 0.25}, {2.7, 2.4, 0.0}}},
    {{{3.525, 2.49375, 0.0}, {3.525, 2.49375, 0.25}, {2.8, 2.475, 0.25}, {2.8, 2.475, 0.0}}},
    {{{3.45, 2.5125, 0.0}, {3.45, 2.5125, 0.15}, {2.9, 2.475, 0.15}, {2.9, 2.475, 0.0}}},
    {{{3.2, 2.4, 0.0}, {3.2, 2.4, 0.15}, {2.8, 2.4, 0.15}, {2.8, 2.4, 0.0}}},
}};

// Cubic Bernstein weights at place / divisions and those of the derivative. Reversed,
// the place gives the reversed weights to the bit, so two patches that run along
// their common edge in opposite directions agree on its points.
struct Bernstein {
  std::array<double, 4> value;
  std::array<double, 3> slope;  // of the differences of neighbours

  Bernstein(double place, int divisions) {
    const double s = (divisions - place) / divisions;
    const double t = place / divisions;
    value = {s * s * s, 3.0 * (s * s) * t, 3.0 * (t * t) * s, t * t * t};
    slope = {3.0 * (s * s), 6.0 * (s * t), 3.0 * (t * t)};
  }
};

glm::dvec3 point_of(const Row& p, const Bernstein& at) {
  return (p[0] * at.value[0] + p[3] * at.value[3]) + (p[1] * at.value[1] + p[2] * at.value[2]);
}

glm::dvec3 slope_of(const Row& p, const Bernstein& at) {
  return ((p[1] - p[0]) * at.slope[0] + (p[3] - p[2]) * at.slope[2]) + (p[2] - p[1]) * at.slope[1];
}

// Where the first or last row is one point, the derivative along the row vanishes
// there; near it it grows as the distance times the mixed derivative, which takes its
// place in the limit.
glm::dvec3 patch_normal(const Row& points, const Row& slopes, const Bernstein& down) {
  const glm::dvec3 along_column = slope_of(points, down);
  const glm::dvec3 along_row = point_of(slopes, down);
  if (along_row != glm::dvec3{0.0}) return normalize(cross(along_column, along_row));
  const glm::dvec3 mixed = slope_of(slopes, down);
  const bool last_row = down.value[3] == 1.0;
  return normalize(cross(along_column, last_row ? -mixed : mixed));
}

bool is_point(const Row& row) { return row[0] == row[1] && row[1] == row[2] && row[2] == row[3]; }

struct UvRange {
  double u0, v0, u_size, v_size;
};

void append_patch(Mesh& mesh, const Patch& patch, const UvRange& uvs, double scale, int divisions) {
  const GridLayout layout{divisions, divisions, is_point(patch[0]), is_point(patch[3])};
  append_grid(mesh, layout, [&](double column, int row) {
    const Bernstein right{column, divisions};
    const Bernstein down{static_cast<double>(row), divisions};
    Row points;  // of the curve that runs down at this column
    Row slopes;
    for (std::size_t i = 0; i < 4; ++i) {
      points[i] = point_of(patch[i], right);
      slopes[i] = slope_of(patch[i], right);
    }
    return SurfacePoint{
        point_of(points, down) * scale,
        patch_normal(points, slopes, down),
        {uvs.u0 + uvs.u_size * column / divisions, uvs.v0 + uvs.v_size * row / divisions}};
  });
}

void append_revolution(Mesh& mesh, double scale, int divisions) {
  for (std::size_t part = 0; part < kProfiles.size(); ++part) {
    Patch patch;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [r, y, k] = kProfiles[part][i];
      patch[i] = {{{0.0, y, r}, {k, y, r}, {r, y, k}, {r, y, 0.0}}};
    }
    for (int quarter = 0; quarter < 4; ++quarter) {
      const auto v0 = static_cast<double>(part) / kProfiles.size();
      append_patch(mesh, patch, {quarter / 4.0, v0, 0.25, 1.0 / kProfiles.size()}, scale,
                   divisions);
      for (Row& row : patch) {
        for (glm::dvec3& p : row) p = {p.z, p.y, -p.x};
      }
    }
  }
}

void append_tube(Mesh& mesh, const std::array<Row, 7>& rows, double scale, int divisions) {
  for (std::size_t piece = 0; piece < 2; ++piece) {
    Patch front;
    Patch back;
    for (std::size_t i = 0; i < 4; ++i) {
      front[i] = rows[3 * piece + i];
      for (std::size_t j = 0; j < 4; ++j) {
        const glm::dvec3 p = front[i][3 - j];
        back[i][j] = {p.x, p.y, -p.z};
      }
    }
    const double v0 = 0.5 * static_cast<double>(piece);
    append_patch(mesh, front, {0.0, v0, 0.5, 0.5}, scale, divisions);
    append_patch(mesh, back, {0.5, v0, 0.5, 0.5}, scale, divisions);
  }
}

}  // namespace

Mesh make_teapot(double height, int divisions) {
  assert(height > 0.0 && divisions >= 2);
  const double scale = height / kHeight;
  Mesh mesh;
  append_revolution(mesh, scale, divisions);
  append_tube(mesh, kHandle, scale, divisions);
  append_tube(mesh, kSpout, scale, divisions);
  return mesh;
}

}  // namespace softfocus
