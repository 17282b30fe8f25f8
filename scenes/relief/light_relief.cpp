// A row of texels, scalar and in lanes.

#ifndef SOFTFOCUS_ISA

#include "scenes/relief/light_relief.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"
#include "raster/numbers/vector_math.h"
#include "raster/threads/loops.h"
#include "scenes/surfaces/lighting.h"

namespace softfocus {

/// Rows that a row's texels read.
struct LitRow {
  const std::int32_t* codes;  ///< of depth
  const std::uint32_t* unlit;
  const std::uint32_t* normals;
  std::span<const Material> materials;  ///< as light_point() wants them
  std::span<const ReliefMaterial> kinds;
  const ReliefLights* lights;
  glm::vec3 eye, first, a, f;
  float step_m;
  glm::vec3 source;    ///< the eye of a perspective camera
  float source_per_m;  ///< 1 / its distance from the plane; 0 of an orthographic one
  std::int32_t empty;
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/relief/light_relief.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

std::uint32_t lit_code(float linear, const ReliefLights& lights) {
  const float above = linear > 0.0f ? linear : 0.0f;
  const float cut = above < 1.0f ? above : 1.0f;
  return static_cast<std::uint32_t>(
      lights.code_of_half[float_to_half(cut, HalfRounding::nearest_even)]);
}

/// point_at_depth().
glm::vec3 lit_point(const LitRow& row, int x) {
  const glm::vec3 in_plane = row.first + row.a * static_cast<float>(x);
  const float depth_m = static_cast<float>(row.codes[x]) * row.step_m;
  if (row.source_per_m == 0.0f) return in_plane + row.f * depth_m;
  return row.source + (in_plane - row.source) * (1.0f / (1.0f - depth_m * row.source_per_m));
}

std::uint32_t light_texel(const LitRow& row, int x) {
  if (row.codes[x] == row.empty) return 0;
  const std::uint32_t packed = row.normals[x], unlit = row.unlit[x];
  const std::uint32_t number = packed >> 24;
  if (!row.kinds[number].lit) return unlit;
  const auto byte = [&](int shift) { return static_cast<int>(packed >> shift & 255u); };
  const glm::vec3 point = lit_point(row, x);
  const glm::vec3 normal =
      normalize(glm::vec3{static_cast<float>(byte(0) - 128), static_cast<float>(byte(8) - 128),
                          static_cast<float>(byte(16) - 128)});
  const LitColour lit = light_point(row.materials[number], row.lights->ambient_light,
                                    row.lights->lights, point, normal, normalize(row.eye - point));
  const auto linear = [&](int shift) { return row.lights->linear_of_code[unlit >> shift & 255u]; };
  const glm::vec3 colour = lit.base * glm::vec3{linear(0), linear(8), linear(16)} + lit.specular;
  return lit_code(colour.x, *row.lights) | lit_code(colour.y, *row.lights) << 8 |
         lit_code(colour.z, *row.lights) << 16 | 0xFF000000u;
}

}  // namespace

ReliefLights relief_lights(glm::vec3 ambient_light, std::span<const Light> lights) {
  ReliefLights made{ambient_light, lights, {}, {}};
  made.code_of_half.resize(65536);
  for (std::size_t half = 0; half < made.code_of_half.size(); ++half) {
    made.code_of_half[half] = linear_to_srgb8(half_to_float(static_cast<std::uint16_t>(half)));
  }
  made.linear_of_code.resize(256);
  for (std::size_t code = 0; code < made.linear_of_code.size(); ++code) {
    made.linear_of_code[code] = srgb8_to_linear(static_cast<std::uint8_t>(code));
  }
  return made;
}

ReliefMaterial relief_material(const Material& material) {
  ReliefMaterial kind{glm::vec3{0.0f}, material.specular, material.shininess, material.lit};
  for (int i = 0; i < 3; ++i) {
    if (material.diffuse[i] > 0.0f) kind.ambient[i] = material.ambient[i] / material.diffuse[i];
  }
  return kind;
}

void light_relief(ReliefTexture& relief, const ReliefLights& lights, glm::dvec3 eye,
                  ThreadPool& pool) {
  assert(!relief.materials.empty() && relief.unlit.size() == relief.depths.size());
  std::vector<Material> materials;
  materials.reserve(relief.materials.size());
  for (const ReliefMaterial& kind : relief.materials) {
    Material& material = materials.emplace_back();
    material.ambient = kind.ambient;
    material.diffuse = glm::vec3{1.0f};
    material.specular = kind.specular;
    material.shininess = kind.shininess;
  }
  const ReliefCamera& camera = relief.camera;
  constexpr int kRows = 8;
  for_each_band(pool, relief.height, kRows, [&](int first, int end) {
    std::vector<std::int32_t> codes(static_cast<std::size_t>(relief.width));
    for (int y = first; y < end; ++y) {
      const auto begin = static_cast<std::size_t>(y) * static_cast<std::size_t>(relief.width);
      std::copy_n(relief.depths.data() + begin, relief.width, codes.data());
      const LitRow row{codes.data(),
                       relief.unlit.data() + begin,
                       relief.normals.data() + begin,
                       materials,
                       relief.materials,
                       &lights,
                       glm::vec3{eye},
                       glm::vec3{camera.origin + camera.b * static_cast<double>(y)},
                       glm::vec3{camera.a},
                       glm::vec3{camera.f},
                       static_cast<float>(depth_step(relief)),
                       glm::vec3{camera.eye.value_or(glm::dvec3{0.0})},
                       static_cast<float>(1.0 / source_distance(camera)),
                       empty_depth(relief.depth_bits)};
      std::uint32_t* colours = relief.colours.data() + begin;
      int x = 0;
      if (pool.isa() != Isa::scalar) {
        x = SOFTFOCUS_KERNEL(pool.isa(), light_texels)(row, relief.width, colours);
      }
      for (; x < relief.width; ++x) colours[x] = light_texel(row, x);
    }
  });
}

}  // namespace softfocus

#else  // the kernels, once a vector unit

#include "raster/lanes/vector_math_lanes.inl"
#include "scenes/surfaces/lighting_lanes.inl"

namespace {

SOFTFOCUS_INLINE Floats signed_byte(Bits packed, int shift) {
  return to_floats(as_ints(packed >> shift & 255u) - 128);
}

SOFTFOCUS_INLINE Bits lit_codes(Floats linear, const ReliefLights& lights, Mask wanted) {
  const Floats above = select(linear > 0.0f, linear, splat(0.0f));
  const Floats cut = select(above < 1.0f, above, splat(1.0f));
  const Ints half = as_ints(float_to_half<HalfRounding::nearest_even>(cut));
  return as_bits(gather(lights.code_of_half.data(), half, wanted));
}

SOFTFOCUS_INLINE Floats linear_codes(Bits unlit, int shift, const ReliefLights& lights,
                                     Mask wanted) {
  return gather(lights.linear_of_code.data(), as_ints(unlit >> shift & 255u), wanted);
}

SOFTFOCUS_INLINE Vec3Lanes lit_points(const LitRow& row, Floats at, Floats depths_m) {
  const Vec3Lanes in_plane = splat(row.first) + row.a * at;
  if (row.source_per_m == 0.0f) return in_plane + row.f * depths_m;
  const Floats way = 1.0f / (1.0f - depths_m * row.source_per_m);
  const Vec3Lanes source = splat(row.source), ray = in_plane - source;
  return source + Vec3Lanes{ray.x * way, ray.y * way, ray.z * way};
}

/// Texels of one material: light_point(), and what light_texel() makes of it.
SOFTFOCUS_INLINE Bits lit_texels(const LitRow& row, const Material& material, Bits unlit,
                                 const Vec3Lanes& point, const Vec3Lanes& normal, Mask wanted) {
  const ReliefLights& lights = *row.lights;
  const Vec3Lanes towards_eye = normalize(splat(row.eye) - point);
  const LitLanes lit =
      light_points(material, lights.ambient_light, lights.lights,
                   material.specular != glm::vec3{0.0f}, point, normal, towards_eye);
  return lit_codes(lit.base.x * linear_codes(unlit, 0, lights, wanted) + lit.specular.x, lights,
                   wanted) |
         lit_codes(lit.base.y * linear_codes(unlit, 8, lights, wanted) + lit.specular.y, lights,
                   wanted)
             << 8 |
         lit_codes(lit.base.z * linear_codes(unlit, 16, lights, wanted) + lit.specular.z, lights,
                   wanted)
             << 16 |
         0xFF000000u;
}

}  // namespace

/// Returns the first texel that is left.
int light_texels(const LitRow& row, int width, std::uint32_t* colours) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const Ints codes = load(row.codes + x);
    Mask left = codes != row.empty;
    Bits colour = splat(std::uint32_t{0});
    if (any(left)) {
      const Bits packed = load(row.normals + x), unlit = load(row.unlit + x);
      const Ints numbers = as_ints(packed >> 24);
      const Floats at = to_floats(x + lane_numbers());
      const Vec3Lanes point = lit_points(row, at, to_floats(codes) * row.step_m);
      const Vec3Lanes normal = normalize(
          Vec3Lanes{signed_byte(packed, 0), signed_byte(packed, 8), signed_byte(packed, 16)});
      // Mostly all are of one material.
      while (any(left)) {
        int lane = 0;
        while (left[lane] == 0) ++lane;
        const auto number = static_cast<std::size_t>(numbers[lane]);
        const Mask own = left & (numbers == numbers[lane]);
        const Bits lit = row.kinds[number].lit
                             ? lit_texels(row, row.materials[number], unlit, point, normal, own)
                             : unlit;
        colour = select(own, lit, colour);
        left &= ~own;
      }
    }
    store(colours + x, colour);
  }
  return x;
}

#endif
