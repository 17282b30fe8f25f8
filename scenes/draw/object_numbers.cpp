#include "scenes/draw/object_numbers.h"

#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"

namespace softfocus {
namespace {

// An unlit surface's colour runs through the stages of draw_scene() as a number would: red holds a
// number's low byte, green its high one. Half a unit on top of either outweighs the interpolation's
// rounding and a profile that cuts halves.
constexpr float kHalfUnit = 0.5f;

Material numbered(std::size_t object) {
  const std::size_t number = 1 + object % 65535;
  const std::size_t low = number % 256, high = number / 256;
  Material material;
  material.lit = false;
  material.diffuse = {static_cast<float>(low) + kHalfUnit, static_cast<float>(high) + kHalfUnit,
                      0.0f};
  return material;
}

}  // namespace

std::vector<std::uint16_t> draw_object_numbers(const Scene& scene, const CameraMatrices& camera,
                                               double frame, int width, int height,
                                               const Profile& profile, ThreadPool& pool) {
  std::vector<Material> materials;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) materials.push_back(numbered(i));
  PreparedScene prepared = prepare_surfaces(scene, profile, pool);
  prepared.depth = make_image(Format::r32f, width, height);
  Image picture = make_image(Format::rgba16f, width, height);
  prepared.pass.targets.colour[0] = &picture;
  prepared.pass.targets.depth = &prepared.depth;
  prepared.pass.clear_colour = glm::vec4{0.0f};
  prepared.pass.clear_depth = 1.0f;
  prepared.pass.keep_depth = false;
  record_surfaces(prepared, materials, camera, frame, prepared.pass);
  finish(prepared.pass, pool);
  const auto columns = static_cast<std::size_t>(width);
  std::vector<std::uint16_t> numbers(columns * static_cast<std::size_t>(height));
  pool.for_each(height, [&](int y) {
    std::uint16_t* to = numbers.data() + columns * static_cast<std::size_t>(y);
    for (int x = 0; x < width; ++x) {
      const glm::vec4 texel = load_texel<Format::rgba16f>(picture, x, y);
      to[x] =
          static_cast<std::uint16_t>(static_cast<int>(texel.x) + 256 * static_cast<int>(texel.y));
    }
  });
  return numbers;
}

std::vector<std::uint16_t> object_numbers_for(const Method& method, const Scene& scene,
                                              const CameraMatrices& camera, double frame, int width,
                                              int height, const Profile& profile,
                                              ThreadPool& pool) {
  if (!method.reads_objects) return {};
  return draw_object_numbers(scene, camera, frame, width, height, profile, pool);
}

}  // namespace softfocus
