#pragma once
// Light on a relief's texels, so that lights can move without drawing it anew (6.4 of Clua 2004).
// An unlit relief has, of each texel, the diffuse colour times the texture, the normal, and the
// number of a material. The light is light_point() of scenes/surfaces/lighting.h, as on surfaces,
// but for each texel; the pipeline calls it for each vertex.
//
// In binary32, of the texel (u, v) with the depth d and the normal's bytes n:
//
//   point  = ((C + v b) + u a) + d f          C + v b in binary64, rounded once a row
//   normal = normalize(n - 128)
//   colour = base unlit + specular            of light_point() with the diffuse colour 1
//
// cut to 0..1, rounded to a half, as a picture has it, and encoded as make_relief() does. Texels
// are lit before they are warped, so the point is the true one and each material has its own
// highlight. Clua lights the pixels of the warped plane.

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/relief/relief_texture.h"
#include "scenes/scene.h"

namespace softfocus {

/// The lights of a view, and tables.
struct ReliefLights {
  glm::vec3 ambient_light{0.0f};
  std::span<const Light> lights;
  std::vector<std::int32_t> code_of_half;  ///< linear_to_srgb8() of each half
  std::vector<float> linear_of_code;       ///< srgb8_to_linear()
};

/// The lights must outlive the result.
ReliefLights relief_lights(glm::vec3 ambient_light, std::span<const Light> lights);

/// How a material's texels answer light. If its diffuse colour is 0, so is its ambient one.
ReliefMaterial relief_material(const Material& material);

/// Sets the colours of an unlit relief as an eye sees them. The same bits for any number of threads
/// and any vector unit.
void light_relief(ReliefTexture& relief, const ReliefLights& lights, glm::dvec3 eye,
                  ThreadPool& pool);

}  // namespace softfocus
