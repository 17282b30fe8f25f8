#include "scenes/random/stage.h"

#include <algorithm>

#include "raster/numbers/exact_math.h"

namespace softfocus {
namespace {

std::uint32_t any_texture(Stage& stage, const TextureChoice& choice) {
  const auto patterns = texture_patterns();
  const TexturePattern& pattern = patterns[next_bits(stage.random) % patterns.size()];
  TextureRecipe recipe{.size = choice.size, .cells = choice.cells, .colours = {}, .seed = 0};
  recipe.seed = next_bits(stage.random) % 1000;
  for (std::size_t i = 0; i < pattern.colour_count; ++i) {
    recipe.colours.push_back(any_colour(stage, 0.95));
  }
  stage.textures.push_back({&pattern, std::move(recipe)});
  return static_cast<std::uint32_t>(stage.textures.size() - 1);
}

}  // namespace

double log_between(Stage& stage, double low, double high) {
  return exact_math::exp2(between(stage, exact_math::log2(low), exact_math::log2(high)));
}

int count_between(Stage& stage, int low, int high) {
  return low + static_cast<int>(next_bits(stage.random) % static_cast<unsigned>(high - low + 1));
}

glm::dvec3 seen_at(const Stage& stage, glm::dvec2 place, double depth_m) {
  const double half_height = stage.tangent * depth_m;
  return stage.scene.camera.position + stage.forwards * depth_m +
         stage.right * (place.x * half_height) + stage.up * (place.y * half_height);
}

void reach_to(Stage& stage, double depth_m) {
  stage.nearest_m = std::min(stage.nearest_m, depth_m);
}

glm::vec3 any_colour(Stage& stage, double brightness) {
  const double value = brightness * between(stage, 0.2, 1.0);
  const double saturation = between(stage, 0.1, 1.0);
  glm::vec3 colour{0.0f};
  for (int channel = 0; channel < 3; ++channel) {
    colour[channel] = static_cast<float>(value * (1.0 - saturation * between(stage, 0.0, 1.0)));
  }
  return colour;
}

std::uint32_t any_material(Stage& stage, const TextureChoice& choice) {
  Material material;
  material.two_sided = true;
  if (choice.textured) {
    material.texture = any_texture(stage, choice);
    material.diffuse = glm::vec3{static_cast<float>(between(stage, 0.6, 1.0))};
  } else {
    material.diffuse = any_colour(stage, 0.9);
  }
  material.ambient = material.diffuse;
  if (happens(stage, 0.5)) {
    material.specular = glm::vec3{static_cast<float>(log_between(stage, 0.1, 1.5))};
    material.shininess = count_between(stage, 8, 150);
  }
  return add_material(stage, material);
}

std::uint32_t add_material(Stage& stage, const Material& material) {
  stage.scene.materials.push_back(material);
  return static_cast<std::uint32_t>(stage.scene.materials.size() - 1);
}

std::uint32_t add_mesh(Stage& stage, Mesh mesh) {
  stage.scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(stage.scene.meshes.size() - 1);
}

void add_object(Stage& stage, std::uint32_t mesh, std::uint32_t material, const Placement& at) {
  Object object;
  object.mesh = mesh;
  object.material = material;
  object.position = at.position;
  object.rotation_degrees = at.rotation_degrees;
  object.scale = at.scale;
  stage.scene.objects.push_back(object);
}

glm::dvec3 any_rotation(Stage& stage) {
  const double x = between(stage, 0.0, 360.0);
  const double y = between(stage, 0.0, 360.0);
  return {x, y, between(stage, 0.0, 360.0)};
}

}  // namespace softfocus
