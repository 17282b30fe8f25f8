#include "scenes/relief/impostors/octahedral_atlas.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"
#include "raster/numbers/vector_math.h"

namespace softfocus {
namespace {

double signed_one(double of) { return of < 0.0 ? -1.0 : 1.0; }

}  // namespace

glm::dvec2 octahedral_place(glm::dvec3 direction, bool hemisphere) {
  const double y = hemisphere ? std::fmax(direction.y, 0.0) : direction.y;
  const double sum = (std::fabs(direction.x) + std::fabs(y)) + std::fabs(direction.z);
  double s = direction.x / sum, t = direction.z / sum;
  if (hemisphere) {
    const double turned = s + t;
    t = s - t;
    s = turned;
  } else if (y < 0.0) {
    // The lower half's corners fold outwards.
    const double folded = (1.0 - std::fabs(t)) * signed_one(s);
    t = (1.0 - std::fabs(s)) * signed_one(t);
    s = folded;
  }
  return {0.5 * s + 0.5, 0.5 * t + 0.5};
}

glm::dvec3 octahedral_direction(glm::dvec2 place, bool hemisphere) {
  double s = 2.0 * place.x - 1.0, t = 2.0 * place.y - 1.0;
  if (hemisphere) {
    const double turned = 0.5 * (s + t);
    t = 0.5 * (s - t);
    s = turned;
  }
  const double y = 1.0 - std::fabs(s) - std::fabs(t);
  if (y < 0.0 && !hemisphere) {
    const double folded = (1.0 - std::fabs(t)) * signed_one(s);
    t = (1.0 - std::fabs(s)) * signed_one(t);
    s = folded;
  }
  return normalize(glm::dvec3{s, y, t});
}

ReliefCamera octahedral_camera(glm::dvec3 middle, double radius_m, glm::dvec3 direction,
                               int texels) {
  // Seen from the poles, +z stands in for up.
  constexpr double kAlongUp = 0.9999;
  const glm::dvec3 up =
      std::fabs(direction.y) > kAlongUp ? glm::dvec3{0.0, 0.0, 1.0} : glm::dvec3{0.0, 1.0, 0.0};
  ReliefCamera camera;
  camera.f = direction * -1.0;
  const glm::dvec3 right = normalize(cross(camera.f, up));
  // A texel of margin each way.
  const double texel_m = 2.0 * radius_m / (texels - 2);
  camera.a = right * texel_m;
  camera.b = cross(camera.f, right) * texel_m;
  const double held_m = radius_m * (1.0 + kDepthMargin);
  camera.depth_m = 2.0 * held_m;
  camera.origin = (middle - camera.f * held_m) -
                  (camera.a + camera.b) * (0.5 * static_cast<double>(texels - 1));
  return camera;
}

OctahedralAtlas make_octahedral_atlas(ReliefMaker& maker, const OctahedralForm& form,
                                      ThreadPool& pool) {
  assert(form.views >= 2 && form.views <= kMostOctahedralViews);
  OctahedralAtlas atlas{form.views, form.hemisphere, maker.middle, maker.radius_m, {}};
  const ReliefForm of_picture{form.texels, form.texels, form.depth_bits, form.with_normals};
  const double last = form.views - 1;
  atlas.pictures.reserve(static_cast<std::size_t>(form.views) *
                         static_cast<std::size_t>(form.views));
  for (int j = 0; j < form.views; ++j) {
    for (int i = 0; i < form.views; ++i) {
      const glm::dvec3 direction = octahedral_direction({i / last, j / last}, form.hemisphere);
      atlas.pictures.push_back(draw_relief(
          maker, octahedral_camera(maker.middle, maker.radius_m, direction, form.texels),
          maker.middle + direction * form.distance_m, of_picture, pool));
    }
  }
  return atlas;
}

std::size_t bytes_of(const OctahedralAtlas& atlas) {
  std::size_t bytes = 0;
  for (const ReliefTexture& picture : atlas.pictures) {
    bytes += picture.depths.size() * sizeof(std::uint16_t) +
             (picture.colours.size() + picture.normals.size()) * sizeof(std::uint32_t);
  }
  return bytes;
}

OctahedralBlend octahedral_blend(const OctahedralAtlas& atlas, glm::dvec3 direction) {
  const glm::dvec2 place = octahedral_place(direction, atlas.hemisphere);
  const auto cell_of = [&](double along, double& within) {
    const double grid = along * (atlas.views - 1);
    const int cell = std::clamp(static_cast<int>(grid), 0, atlas.views - 2);
    within = grid - cell;
    return static_cast<std::size_t>(cell);
  };
  double x = 0.0, y = 0.0;
  const std::size_t i = cell_of(place.x, x), j = cell_of(place.y, y);
  const auto corner = [&](std::size_t right, std::size_t below) {
    const double last = atlas.views - 1;
    return octahedral_direction(
        {static_cast<double>(i + right) / last, static_cast<double>(j + below) / last},
        atlas.hemisphere);
  };
  const auto views = static_cast<std::size_t>(atlas.views);
  const std::size_t first = j * views + i;
  const std::size_t right = first + 1, below = first + views, last = first + views + 1;
  if (dot(corner(0, 0), corner(1, 1)) > dot(corner(1, 0), corner(0, 1))) {
    return {{first, x > y ? right : below, last},
            {std::fmin(1.0 - x, 1.0 - y), std::fabs(x - y), std::fmin(x, y)}};
  }
  if (x + y < 1.0) return {{first, right, below}, {1.0 - x - y, x, y}};
  return {{last, right, below}, {x + y - 1.0, 1.0 - y, 1.0 - x}};
}

OctahedralView octahedral_view(const ReliefTexture& picture, double radius_m,
                               const CameraMatrices& camera, int width, int height) {
  const ReliefCamera& plane = picture.camera;
  const auto axis = [&](int i) { return eye_axis(camera, i); };
  // The ray through a pixel's centre goes as far along the axis as a metre.
  const glm::dvec3 step_x = axis(0) * (2.0 / (width * camera.eye_to_clip[0][0]));
  const glm::dvec3 step_y = axis(1) * (2.0 / (height * camera.eye_to_clip[1][1]));
  const glm::dvec3 ray = (step_x * (0.5 - 0.5 * width) + step_y * (0.5 - 0.5 * height)) - axis(2);
  const auto planar = [&](const auto& of_ray) {
    return PlaneMapping::Planar{of_ray(ray), of_ray(step_x), of_ray(step_y)};
  };
  const glm::dvec3 c = plane.origin - camera.eye;
  const double a_a = dot(plane.a, plane.a), b_b = dot(plane.b, plane.b);
  const double eye_u = -dot(c, plane.a) / a_a, eye_v = -dot(c, plane.b) / b_b;
  OctahedralView view{};
  view.height_m = dot(c, plane.f) + radius_m * (1.0 + kDepthMargin);
  view.q = planar([&](glm::dvec3 d) { return dot(d, plane.f); });
  view.slope_u = planar([&](glm::dvec3 d) { return dot(d, plane.a) / a_a; });
  view.slope_v = planar([&](glm::dvec3 d) { return dot(d, plane.b) / b_b; });
  view.u = planar([&](glm::dvec3 d) {
    return eye_u * dot(d, plane.f) + view.height_m * (dot(d, plane.a) / a_a);
  });
  view.v = planar([&](glm::dvec3 d) {
    return eye_v * dot(d, plane.f) + view.height_m * (dot(d, plane.b) / b_b);
  });
  return view;
}

Rectangle octahedral_area(const OctahedralAtlas& atlas, const CameraMatrices& camera, int width,
                          int height) {
  std::array<glm::dvec3, 8> corners{};
  for (std::size_t corner = 0; corner < 8; ++corner) {
    corners[corner] = atlas.middle;
    for (int i = 0; i < 3; ++i) {
      corners[corner][i] += (corner >> i & 1) != 0 ? atlas.radius_m : -atlas.radius_m;
    }
  }
  return seen_area(corners, camera, width, height);
}

namespace {

/// A picture's planes along a row of pixels, in binary32.
struct OctahedralRow {
  struct Along {
    float base, step;
    float at(float x) const { return base + x * step; }
  };
  Along u, v, slope_u, slope_v, q;
  float height_m, middle_m, step_m, share;
  int size;
  const std::uint32_t* colours;
  const std::uint16_t* depths;
};

OctahedralRow octahedral_row(const ReliefTexture& picture, const OctahedralView& view,
                             double radius_m, double share, int y) {
  const auto along = [&](const PlaneMapping::Planar& of) {
    return OctahedralRow::Along{static_cast<float>(of.at(0.0, y)), static_cast<float>(of.step_x)};
  };
  return {along(view.u),
          along(view.v),
          along(view.slope_u),
          along(view.slope_v),
          along(view.q),
          static_cast<float>(view.height_m),
          static_cast<float>(radius_m * (1.0 + kDepthMargin)),
          static_cast<float>(depth_step(picture)),
          static_cast<float>(share),
          picture.width,
          picture.colours.data(),
          picture.depths.data()};
}

/// Sums over the three pictures, weighted by share and coverage.
struct OctahedralSums {
  float red = 0.0f, green = 0.0f, blue = 0.0f, alpha = 0.0f, far = 0.0f;
};

/// Whether a place lies on the picture with a texel after it each way.
bool is_within(const OctahedralRow& row, float u, float v) {
  const auto last = static_cast<float>(row.size - 1);
  return u >= 0.0f && v >= 0.0f && u < last && v < last;
}

/// The depth of the nearest texel, from the plane through the middle; `otherwise` if it is empty.
float depth_near(const OctahedralRow& row, float u, float v, float otherwise) {
  if (!is_within(row, u, v)) return otherwise;
  const int at = static_cast<int>(v + 0.5f) * row.size + static_cast<int>(u + 0.5f);
  if (row.colours[at] == 0) return otherwise;
  return static_cast<float>(row.depths[at]) * row.step_m - row.middle_m;
}

void add_octahedral(const OctahedralRow& row, int steps, const std::array<float, 256>& linear,
                    float x, OctahedralSums& sums) {
  const float q = row.q.at(x);
  if (!(q > 0.0f)) return;
  const float inverse = 1.0f / q;
  const float middle_u = row.u.at(x) * inverse, middle_v = row.v.at(x) * inverse;
  const float slope_u = row.slope_u.at(x) * inverse, slope_v = row.slope_v.at(x) * inverse;
  float depth = 0.0f;
  for (int step = 0; step < steps; ++step) {
    depth = depth_near(row, middle_u + depth * slope_u, middle_v + depth * slope_v, depth);
  }
  const float u = middle_u + depth * slope_u, v = middle_v + depth * slope_v;
  if (!is_within(row, u, v)) return;
  const int left = static_cast<int>(u), top = static_cast<int>(v);
  const float right_share = u - static_cast<float>(left), lower = v - static_cast<float>(top);
  const float upper = 1.0f - lower, left_share = 1.0f - right_share;
  const int at = top * row.size + left;
  const std::array<int, 4> texels{at, at + 1, at + row.size, at + row.size + 1};
  const std::array<float, 4> weights{left_share * upper, right_share * upper, left_share * lower,
                                     right_share * lower};
  float alpha = 0.0f, red = 0.0f, green = 0.0f, blue = 0.0f;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint32_t colour = row.colours[texels[i]];
    if (colour == 0) continue;
    alpha = alpha + weights[i];
    red = red + weights[i] * linear[colour & 255u];
    green = green + weights[i] * linear[colour >> 8 & 255u];
    blue = blue + weights[i] * linear[colour >> 16 & 255u];
  }
  const float share = row.share;
  const float far = (row.height_m + depth_near(row, u, v, depth)) * inverse;
  if (!(far > 0.0f)) return;  // behind an eye that is within the sphere
  sums.alpha = sums.alpha + share * alpha;
  sums.red = sums.red + share * red;
  sums.green = sums.green + share * green;
  sums.blue = sums.blue + share * blue;
  sums.far = sums.far + (share * alpha) * far;
}

}  // namespace

void draw_octahedral(const OctahedralAtlas& atlas, const CameraMatrices& camera, int steps,
                     Image& picture, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f && steps >= 0 && steps <= kMostParallaxSteps);
  const OctahedralBlend blend = octahedral_blend(atlas, camera.eye - atlas.middle);
  const int width = picture.width, height = picture.height;
  std::array<OctahedralView, 3> views{};
  for (std::size_t i = 0; i < 3; ++i) {
    views[i] =
        octahedral_view(atlas.pictures[blend.pictures[i]], atlas.radius_m, camera, width, height);
  }
  std::array<float, 256> linear{};
  for (std::size_t code = 0; code < linear.size(); ++code) {
    linear[code] = srgb8_to_linear(static_cast<std::uint8_t>(code));
  }
  const Rectangle area = octahedral_area(atlas, camera, width, height);
  constexpr int kRows = 4;
  pool.for_each((area.y_end - area.y_begin + kRows - 1) / kRows, [&](int band) {
    const int begin = area.y_begin + kRows * band;
    for (int y = begin; y < std::min(begin + kRows, area.y_end); ++y) {
      std::array<OctahedralRow, 3> rows{};
      for (std::size_t i = 0; i < 3; ++i) {
        rows[i] = octahedral_row(atlas.pictures[blend.pictures[i]], views[i], atlas.radius_m,
                                 blend.shares[i], y);
      }
      for (int x = area.x_begin; x < area.x_end; ++x) {
        OctahedralSums sums;
        for (const OctahedralRow& row : rows) {
          add_octahedral(row, steps, linear, static_cast<float>(x), sums);
        }
        if (!(sums.alpha >= kLeastCover)) continue;
        const float far = sums.far / sums.alpha;
        const float cut = far < 65504.0f ? far : 65504.0f;
        if (!(cut < load_texel<Format::rgba16f>(picture, x, y).w)) continue;
        store_texel<Format::rgba16f>(
            picture, x, y,
            {sums.red / sums.alpha, sums.green / sums.alpha, sums.blue / sums.alpha, cut},
            Profile{});
      }
    }
  });
}

}  // namespace softfocus
