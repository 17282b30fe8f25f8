#include "scenes/relief/make_relief.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>

#include "raster/images/texel.h"
#include "raster/numbers/srgb.h"
#include "raster/numbers/vector_math.h"
#include "scenes/relief/light_relief.h"
#include "scenes/relief/relief_texture.h"

namespace softfocus {
namespace {

constexpr double kFarAway = std::numeric_limits<double>::infinity();

struct ReliefAxes {
  glm::dvec3 right, down, forward;
};

ReliefAxes relief_axes(glm::dvec3 eye, glm::dvec3 middle, glm::dvec3 up) {
  ReliefAxes axes{};
  axes.forward = normalize(middle - eye);
  axes.right = normalize(cross(axes.forward, up));
  axes.down = cross(axes.forward, axes.right);
  return axes;
}

/// The least box along the view's axes: x right, y down, z forward.
struct ReliefBounds {
  glm::dvec3 low{kFarAway}, high{-kFarAway};

  void add(const glm::dvec3& seen) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], seen[i]);
      high[i] = std::max(high[i], seen[i]);
    }
  }
  /// Gives width or depth to an object without any: texels and codes have a size.
  void give_size(double least_m) {
    for (int i = 0; i < 3; ++i) {
      if (high[i] - low[i] >= least_m) continue;
      low[i] -= least_m;
      high[i] += least_m;
    }
  }
};

/// How far before the eye the object begins and ends.
struct SpanBefore {
  double nearest = kFarAway, farthest = -kFarAway;
};
SpanBefore span_before(const ReliefMaker& maker, const ReliefView& view, const ReliefAxes& axes) {
  SpanBefore span;
  for (const glm::dvec3& point : maker.points) {
    const double away = dot(point - view.eye, axes.forward);
    span.nearest = std::min(span.nearest, away);
    span.farthest = std::max(span.farthest, away);
  }
  return span;
}

/// The plane lies before the nearest point; texels are even on it.
ReliefCamera perspective_camera(const ReliefMaker& maker, const ReliefView& view,
                                const ReliefAxes& axes, int width, int height) {
  const auto [nearest, last_point] = span_before(maker, view, axes);
  const double farthest = std::max(last_point, nearest * (1.0 + 1e-6));
  const double n = nearest - std::min((farthest - nearest) * kDepthMargin, 0.5 * nearest);
  ReliefBounds box;
  for (const glm::dvec3& point : maker.points) {
    const glm::dvec3 ray = point - view.eye;
    const double on_plane = n / dot(ray, axes.forward);
    box.add({dot(ray, axes.right) * on_plane, dot(ray, axes.down) * on_plane, 0.0});
  }
  box.give_size(1e-6 * std::max(maker.radius_m, 1e-30) * n / nearest);
  ReliefCamera camera;
  const double across = (box.high.x - box.low.x) / (width - 2);
  const double along = (box.high.y - box.low.y) / (height - 2);
  camera.a = axes.right * across;
  camera.b = axes.down * along;
  camera.f = axes.forward;
  camera.origin = ((view.eye + axes.right * (box.low.x - 0.5 * across)) +
                   axes.down * (box.low.y - 0.5 * along)) +
                  axes.forward * n;
  // The last point's depth: n z / (n + z).
  const double last = farthest + (farthest - nearest) * kDepthMargin;
  camera.depth_m = n * ((last - n) / last);
  camera.eye = view.eye;
  return camera;
}

/// x, y and depth as relief_matrices() has them; d = n - n^2 / w.
glm::dmat4 perspective_clip(const ReliefCamera& camera, int width, int height) {
  const double across = std::sqrt(dot(camera.a, camera.a));
  const double along = std::sqrt(dot(camera.b, camera.b));
  const glm::dvec3 corner = camera.origin - *camera.eye;
  const double n = source_distance(camera);
  glm::dmat4 clip{0.0};
  clip[0][0] = 2.0 * n / (width * across);
  clip[1][1] = -2.0 * n / (height * along);
  // The eye looks along -z.
  clip[2][0] = 1.0 - 1.0 / width + 2.0 * dot(corner, camera.a) / (across * across * width);
  clip[2][1] = 1.0 - 1.0 / height + 2.0 * dot(corner, camera.b) / (along * along * height);
  clip[2][2] = 1.0 - 2.0 * n / camera.depth_m;
  clip[2][3] = -1.0;
  clip[3][2] = -2.0 * n * n / camera.depth_m;
  return clip;
}

}  // namespace

ReliefMaker relief_maker(const Scene& scene, ThreadPool& pool) {
  ReliefMaker maker{&scene, 0.0, prepare_scene(scene, Profile{}, pool), {}, {}, {}, 0.0, {},
                    {},     {}};
  maker.unlit = scene.materials;
  for (Material& material : maker.unlit) {
    material.lit = false;
    material.specular = glm::vec3{0.0f};
  }
  maker.code_of_half.resize(65536);
  pool.for_each(256, [&](int high_byte) {
    for (int low_byte = 0; low_byte < 256; ++low_byte) {
      const int half = 256 * high_byte + low_byte;
      maker.code_of_half[static_cast<std::size_t>(half)] =
          linear_to_srgb8(half_to_float(static_cast<std::uint16_t>(half)));
    }
  });
  return maker;
}

ReliefMaker prepare_relief(const Scene& scene, double frame, ThreadPool& pool) {
  ReliefMaker maker = relief_maker(scene, pool);
  maker.frame = frame;
  glm::dvec3 low{kFarAway}, high{-kFarAway};
  for (const Object& object : scene.objects) {
    const glm::dmat4 to_world = object_matrix(object, frame);
    for (const glm::vec3& position : scene.meshes[object.mesh].positions) {
      const glm::dvec3 p{position};
      const glm::dvec3 point = ((glm::dvec3{to_world[0]} * p.x + glm::dvec3{to_world[1]} * p.y) +
                                glm::dvec3{to_world[2]} * p.z) +
                               glm::dvec3{to_world[3]};
      maker.points.push_back(point);
      for (int i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], point[i]);
        high[i] = std::max(high[i], point[i]);
      }
    }
  }
  assert(!maker.points.empty());
  maker.chunks = chunks_of(maker.points);
  maker.middle = (low + high) * 0.5;
  for (const glm::dvec3& point : maker.points) {
    const glm::dvec3 out = point - maker.middle;
    maker.radius_m = std::max(maker.radius_m, dot(out, out));
  }
  maker.radius_m = std::sqrt(maker.radius_m);
  return maker;
}

bool can_project(const ReliefMaker& maker, const ReliefView& view) {
  const auto [nearest, farthest] =
      span_before(maker, view, relief_axes(view.eye, maker.middle, view.up));
  return nearest > 0.0 && farthest <= kMostSpan * nearest;
}

ReliefCamera relief_camera(const ReliefMaker& maker, const ReliefView& view, int width,
                           int height) {
  const ReliefAxes axes = relief_axes(view.eye, maker.middle, view.up);
  if (view.projection == ReliefProjection::perspective) {
    assert(can_project(maker, view));
    return perspective_camera(maker, view, axes, width, height);
  }
  ReliefBounds box;
  const glm::dvec3 directions[3] = {axes.right, axes.down, axes.forward};
  for (int i = 0; i < 3; ++i) {
    const PointReach reach = reach_along(maker.points, maker.chunks, directions[i]);
    box.low[i] = reach.low;
    box.high[i] = reach.high;
  }
  box.give_size(1e-6 * std::max(maker.radius_m, 1e-30));
  const auto [low, high] = box;
  ReliefCamera camera;
  const double across = (high.x - low.x) / (width - 2), along = (high.y - low.y) / (height - 2);
  const double margin = (high.z - low.z) * kDepthMargin;
  camera.a = axes.right * across;
  camera.b = axes.down * along;
  camera.f = axes.forward;
  camera.depth_m = (high.z - low.z) + 2.0 * margin;
  camera.origin = (axes.right * (low.x - 0.5 * across) + axes.down * (low.y - 0.5 * along)) +
                  axes.forward * (low.z - margin);
  return camera;
}

CameraMatrices relief_matrices(const ReliefCamera& camera, int width, int height, glm::dvec3 eye) {
  const glm::dvec3 right = normalize(camera.a), down = normalize(camera.b);
  const glm::dvec3 centre = camera.eye ? *camera.eye : camera.origin;
  CameraMatrices matrices{};
  matrices.eye = eye;
  matrices.world_to_eye = glm::dmat4{1.0};
  for (int i = 0; i < 3; ++i) {
    matrices.world_to_eye[i][0] = right[i];
    matrices.world_to_eye[i][1] = -down[i];
    matrices.world_to_eye[i][2] = -camera.f[i];
  }
  matrices.world_to_eye[3][0] = -dot(right, centre);
  matrices.world_to_eye[3][1] = dot(down, centre);
  matrices.world_to_eye[3][2] = dot(camera.f, centre);
  matrices.eye_to_clip = glm::dmat4{1.0};
  if (camera.eye) {
    matrices.eye_to_clip = perspective_clip(camera, width, height);
    return matrices;
  }
  matrices.eye_to_clip[0][0] = 2.0 / (width * std::sqrt(dot(camera.a, camera.a)));
  matrices.eye_to_clip[1][1] = -2.0 / (height * std::sqrt(dot(camera.b, camera.b)));
  matrices.eye_to_clip[2][2] = -2.0 / camera.depth_m;
  matrices.eye_to_clip[3][0] = 1.0 / width - 1.0;
  matrices.eye_to_clip[3][1] = 1.0 / height - 1.0;
  matrices.eye_to_clip[3][2] = -1.0;
  return matrices;
}

ReliefTexture begin_relief(ReliefMaker& maker, const ReliefCamera& camera, const ReliefForm& form) {
  const int width = form.width, height = form.height;
  assert(width >= 4 && width <= kMostReliefSize && height >= 4 && height <= kMostReliefSize);
  ReliefTexture relief;
  relief.width = width;
  relief.height = height;
  relief.depth_bits = form.depth_bits;
  relief.camera = camera;
  if (maker.picture.width != width || maker.picture.height != height) {
    maker.picture = make_image(Format::rgba16f, width, height);
    maker.prepared.depth = make_image(Format::r32f, width, height);
  }
  return relief;
}

void draw_relief_part(ReliefMaker& maker, const ReliefTexture& relief, const ReliefForm& form,
                      glm::dvec3 eye, int part, int parts, ThreadPool& pool) {
  RenderPass& pass = maker.prepared.pass;
  pass.targets.colour[0] = &maker.picture;
  pass.targets.depth = &maker.prepared.depth;
  record_scene_part(
      maker.prepared, relief_matrices(relief.camera, relief.width, relief.height, eye), maker.frame,
      part, parts, pass,
      form.unlit ? std::span<const Material>{maker.unlit} : std::span<const Material>{});
  pass.keep_depth = true;
  finish(pass, pool);
}

void read_relief(ReliefMaker& maker, const ReliefForm& form, glm::dvec3 eye, ReliefTexture& relief,
                 ThreadPool& pool) {
  const bool with_normals = form.with_normals;
  assert(with_normals || !form.unlit);
  const int width = relief.width, height = relief.height;
  const Image normals =
      with_normals ? draw_normals(*maker.scene, relief_matrices(relief.camera, width, height, eye),
                                  maker.frame, width, height, pool)
                   : Image{};
  const std::size_t texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  relief.depths.assign(texels, empty_depth(relief.depth_bits));
  relief.colours.assign(texels, 0);
  if (with_normals) relief.normals.assign(texels, 0);
  const auto last = static_cast<float>(last_depth(relief.depth_bits));
  pool.for_each(height, [&](int y) {
    const float* depths = row<float>(maker.prepared.depth, y).data();
    const std::uint16_t* colours = row<std::uint16_t>(maker.picture, y).data();
    const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    for (int x = 0; x < width; ++x) {
      if (depths[x] >= 1.0f) continue;
      const std::size_t at = first + static_cast<std::size_t>(x);
      relief.depths[at] = static_cast<std::uint16_t>(std::lrint(depths[x] * last));
      relief.colours[at] = packed_colour(colours + 4 * x, maker.code_of_half);
      if (with_normals) {
        const glm::vec4 normal = load_texel<Format::rgba16f>(normals, x, y);
        relief.normals[at] = packed_normal(glm::vec3{normal});
        if (form.unlit) relief.normals[at] |= static_cast<std::uint32_t>(normal.w - 1.0f) << 24;
      }
    }
  });
  if (form.unlit) keep_unlit(relief, *maker.scene);
}

void keep_unlit(ReliefTexture& relief, const Scene& scene) {
  relief.unlit = relief.colours;
  relief.materials.clear();
  relief.materials.reserve(scene.materials.size());
  for (const Material& material : scene.materials) {
    relief.materials.push_back(relief_material(material));
  }
}

ReliefTexture draw_relief(ReliefMaker& maker, const ReliefCamera& camera, glm::dvec3 eye,
                          const ReliefForm& form, ThreadPool& pool) {
  ReliefTexture relief = begin_relief(maker, camera, form);
  draw_relief_part(maker, relief, form, eye, 0, 1, pool);
  read_relief(maker, form, eye, relief, pool);
  return relief;
}

ReliefTexture make_relief(ReliefMaker& maker, const ReliefView& view, const ReliefForm& form,
                          ThreadPool& pool) {
  if (maker.trace) return maker.trace(maker, view, form, pool);
  return draw_relief(maker, relief_camera(maker, view, form.width, form.height), view.eye, form,
                     pool);
}

}  // namespace softfocus
