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

// A colour's code; the byte that a signed unit is.
std::uint32_t packed_colour(const std::uint16_t* texel, const std::vector<std::uint8_t>& codes) {
  return std::uint32_t{codes[texel[0]]} | std::uint32_t{codes[texel[1]]} << 8 |
         std::uint32_t{codes[texel[2]]} << 16 | 0xFF000000u;
}

std::uint32_t packed_normal(const glm::vec4& n) {
  const glm::vec3 unit = normalize(glm::vec3{n});
  const auto byte = [](float v) {
    return static_cast<std::uint32_t>(std::lrint(127.0f * v + 128.0f));
  };
  return byte(unit.x) | byte(unit.y) << 8 | byte(unit.z) << 16;
}

}  // namespace

ReliefMaker prepare_relief(const Scene& scene, double frame, ThreadPool& pool) {
  ReliefMaker maker{&scene, frame, prepare_scene(scene, Profile{}, pool), {}, {}, {}, 0.0, {},
                    {},     {}};
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

ReliefCamera relief_camera(const ReliefMaker& maker, const ReliefView& view, int width,
                           int height) {
  const ReliefAxes axes = relief_axes(view.eye, maker.middle, view.up);
  glm::dvec3 low{0.0}, high{0.0};
  const glm::dvec3 directions[3] = {axes.right, axes.down, axes.forward};
  for (int i = 0; i < 3; ++i) {
    const PointReach reach = reach_along(maker.points, maker.chunks, directions[i]);
    low[i] = reach.low;
    high[i] = reach.high;
  }
  // What has no width or depth gets some: texels and codes have a size.
  for (int i = 0; i < 3; ++i) {
    const double least = 1e-6 * std::max(maker.radius_m, 1e-30);
    if (high[i] - low[i] < least) {
      low[i] -= least;
      high[i] += least;
    }
  }
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
  CameraMatrices matrices{};
  matrices.eye = eye;
  matrices.world_to_eye = glm::dmat4{1.0};
  for (int i = 0; i < 3; ++i) {
    matrices.world_to_eye[i][0] = right[i];
    matrices.world_to_eye[i][1] = -down[i];
    matrices.world_to_eye[i][2] = -camera.f[i];
  }
  matrices.world_to_eye[3][0] = -dot(right, camera.origin);
  matrices.world_to_eye[3][1] = dot(down, camera.origin);
  matrices.world_to_eye[3][2] = dot(camera.f, camera.origin);
  matrices.eye_to_clip = glm::dmat4{1.0};
  matrices.eye_to_clip[0][0] = 2.0 / (width * std::sqrt(dot(camera.a, camera.a)));
  matrices.eye_to_clip[1][1] = -2.0 / (height * std::sqrt(dot(camera.b, camera.b)));
  matrices.eye_to_clip[2][2] = -2.0 / camera.depth_m;
  matrices.eye_to_clip[3][0] = 1.0 / width - 1.0;
  matrices.eye_to_clip[3][1] = 1.0 / height - 1.0;
  matrices.eye_to_clip[3][2] = -1.0;
  return matrices;
}

ReliefTexture begin_relief(ReliefMaker& maker, const ReliefView& view, const ReliefForm& form) {
  const int width = form.width, height = form.height;
  assert(width >= 4 && width <= kMostReliefSize && height >= 4 && height <= kMostReliefSize);
  ReliefTexture relief;
  relief.width = width;
  relief.height = height;
  relief.depth_bits = form.depth_bits;
  relief.camera = relief_camera(maker, view, width, height);
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
        relief.normals[at] = packed_normal(normal);
        if (form.unlit) relief.normals[at] |= static_cast<std::uint32_t>(normal.w - 1.0f) << 24;
      }
    }
  });
  if (!form.unlit) return;
  relief.unlit = relief.colours;
  relief.materials.clear();
  relief.materials.reserve(maker.scene->materials.size());
  for (const Material& material : maker.scene->materials) {
    relief.materials.push_back(relief_material(material));
  }
}

ReliefTexture make_relief(ReliefMaker& maker, const ReliefView& view, const ReliefForm& form,
                          ThreadPool& pool) {
  ReliefTexture relief = begin_relief(maker, view, form);
  draw_relief_part(maker, relief, form, view.eye, 0, 1, pool);
  read_relief(maker, form, view.eye, relief, pool);
  return relief;
}

}  // namespace softfocus
