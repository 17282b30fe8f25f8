#include "scenes/relief/impostors/light_pixels.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>

#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"
#include "scenes/surfaces/lighting.h"

namespace softfocus {
namespace {

constexpr glm::vec4 kNothingThere{0.0f, 0.0f, 0.0f, 65504.0f};

/// The number that most texels have.
std::size_t usual_material(const ReliefTexture& relief) {
  std::array<std::size_t, kMostReliefMaterials> texels{};
  for (std::size_t at = 0; at < relief.normals.size(); ++at) {
    if (relief.colours[at] != 0) ++texels[relief.normals[at] >> 24];
  }
  const auto most = std::max_element(texels.begin(), texels.end());
  return std::min(static_cast<std::size_t>(most - texels.begin()), relief.materials.size() - 1);
}

void map_alone(const WarpedRelief& warped, const PlaneMapping& mapping, const Image& like,
               Image& picture, ThreadPool& pool) {
  if (picture.width != like.width || picture.height != like.height) {
    picture = make_image(Format::rgba16f, like.width, like.height);
  }
  pool.for_each(mapping.area.y_end - mapping.area.y_begin, [&](int line) {
    for (int x = mapping.area.x_begin; x < mapping.area.x_end; ++x) {
      store_texel<Format::rgba16f>(picture, x, mapping.area.y_begin + line, kNothingThere,
                                   Profile{});
    }
  });
  map_relief(warped, mapping, picture, pool);
}

/// Of a mapped picture of normals, whose bytes went through the sRGB curve as colours do.
glm::vec3 normal_at(const Image& normals, const ReliefLights& lights, int x, int y) {
  const std::uint16_t* halves =
      row<std::uint16_t>(normals, y).data() + 4 * static_cast<std::ptrdiff_t>(x);
  const auto part = [&](int i) { return static_cast<float>(lights.code_of_half[halves[i]] - 128); };
  return normalize(glm::vec3{part(0), part(1), part(2)});
}

}  // namespace

std::vector<std::uint32_t> normals_as_colours(const ReliefTexture& relief) {
  std::vector<std::uint32_t> codes(relief.normals.size());
  for (std::size_t at = 0; at < codes.size(); ++at) {
    if (relief.colours[at] != 0) codes[at] = relief.normals[at] | 0xFF000000u;
  }
  return codes;
}

void draw_lit_pixels(const ReliefTexture& relief, const WarpedPlanes& warped,
                     const PlaneMapping& mapping, const CameraMatrices& camera, PixelLights& lights,
                     Image& picture, ThreadPool& pool) {
  assert(!relief.materials.empty());
  map_alone(warped.unlit, mapping, picture, lights.unlit, pool);
  map_alone(warped.normals, mapping, picture, lights.normals, pool);
  const ReliefMaterial& kind = relief.materials[usual_material(relief)];
  Material material;
  material.ambient = kind.ambient;
  material.diffuse = glm::vec3{1.0f};
  material.specular = kind.specular;
  material.shininess = kind.shininess;
  const PixelRays rays = pixel_rays(camera, picture.width, picture.height);
  const glm::vec3 eye{camera.eye};
  pool.for_each(mapping.area.y_end - mapping.area.y_begin, [&](int line) {
    const int y = mapping.area.y_begin + line;
    for (int x = mapping.area.x_begin; x < mapping.area.x_end; ++x) {
      const glm::vec4 unlit = load_texel<Format::rgba16f>(lights.unlit, x, y);
      if (!(unlit.w < load_texel<Format::rgba16f>(picture, x, y).w)) continue;
      glm::vec3 colour{unlit};
      if (kind.lit) {
        const glm::vec3 ray{rays.at(x, y)};
        const glm::vec3 point = eye + ray * unlit.w;
        const LitColour lit =
            light_point(material, lights.lights->ambient_light, lights.lights->lights, point,
                        normal_at(lights.normals, *lights.lights, x, y), normalize(-ray));
        colour = lit.base * colour + lit.specular;
      }
      store_texel<Format::rgba16f>(picture, x, y, {colour, unlit.w}, Profile{});
    }
  });
}

}  // namespace softfocus
