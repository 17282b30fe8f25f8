#include "scenes/models/gltf_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include "raster/images/texel.h"
#include "scenes/files/file_bytes.h"
#include "scenes/files/texture_file.h"
#include "scenes/make/procedural_texture.h"

namespace softfocus {
namespace {

bool is_there(const std::filesystem::path& file) {
  std::error_code unknown;
  return std::filesystem::is_regular_file(file, unknown);
}

constexpr const char* kNoPicture = " is neither PNG nor JPEG, and left out";

std::optional<Texture> read_picture(GltfFile& file, int number) {
  const tinygltf::Image& image = item_of(file, file.gltf.images, number, "image");
  const std::string what = numbered("image", static_cast<std::size_t>(number));
  std::string bytes = image.bufferView >= 0 ? view_bytes(file, image.bufferView)
                                            : std::string{image.image.begin(), image.image.end()};
  std::string name = file.path.string() + ": " + what;
  if (bytes.empty()) {
    // tinygltf leaves out what it does not know of data.
    const bool is_data = image.uri.starts_with("data:");
    if (image.uri.empty() || is_data) {
      warn_gltf(file, what + (is_data ? kNoPicture : " is missing"));
      return std::nullopt;
    }
    std::filesystem::path path = file.path.parent_path() / without_percents(image.uri);
    if (!is_there(path)) path = file.path.parent_path() / image.uri;
    if (!is_there(path)) {
      warn_gltf(file, "texture " + shortened(image.uri) + " is missing");
      return std::nullopt;
    }
    bytes = read_file_bytes(path, kMaxTextureBytes);
    name = path.string();
    file.model.files.push_back(std::move(path));
  }
  const bool is_png = bytes.starts_with("\x89PNG"), is_jpeg = bytes.starts_with("\xFF\xD8");
  if (!is_png && !is_jpeg) {
    warn_gltf(file, what + kNoPicture);
    return std::nullopt;
  }
  return texture_of_bytes(bytes, name);
}

std::optional<std::uint32_t> texture_of(GltfFile& file, int image) {
  const auto [entry, is_new] = file.texture_of_image.try_emplace(image);
  if (is_new) {
    if (std::optional<Texture> read = read_picture(file, image)) {
      entry->second = static_cast<std::uint32_t>(file.model.textures.size());
      file.model.textures.push_back(std::move(*read));
    }
  }
  return entry->second;
}

// The picture of a texture, or -1, with a warning.
int image_of(GltfFile& file, int texture) {
  const int image = item_of(file, file.gltf.textures, texture, "texture").source;
  if (image < 0) {
    warn_gltf(file, numbered("texture", static_cast<std::size_t>(texture)) + " has no PNG or JPEG");
  }
  return image;
}

Wrap wrap_of(int mode) {
  constexpr int kMirrored = 33648, kClamped = 33071;
  return mode == kMirrored  ? Wrap::mirrored_repeat
         : mode == kClamped ? Wrap::clamp_to_edge
                            : Wrap::repeat;
}

Sampler sampler_of(const GltfFile& file, int texture) {
  Sampler sampler{Filter::trilinear, Wrap::repeat, Wrap::repeat};
  const int number = item_of(file, file.gltf.textures, texture, "texture").sampler;
  if (number < 0) return sampler;
  const tinygltf::Sampler& of = item_of(file, file.gltf.samplers, number, "sampler");
  sampler.wrap_u = wrap_of(of.wrapS);
  sampler.wrap_v = wrap_of(of.wrapT);
  constexpr int kNearest = 9728;
  if (of.magFilter == kNearest) sampler.filter = Filter::nearest;
  return sampler;
}

// The means of green and blue of a picture's first level, 0 to 1: roughness and metallic.
std::array<double, 2> means_of(const Image& picture) {
  double green = 0.0, blue = 0.0;
  for (int y = 0; y < picture.height; ++y) {
    const auto texels = row<std::uint8_t>(picture, y);
    for (std::size_t x = 0; x < texels.size(); x += 4) {
      green += texels[x + 1];
      blue += texels[x + 2];
    }
  }
  const double all = 255.0 * picture.width * picture.height;
  return {green / all, blue / all};
}

// Of an image by its number, once; 1 if there is none.
std::array<double, 2> means_of(GltfFile& file, int image) {
  if (image < 0) return {1.0, 1.0};
  const auto [entry, is_new] = file.means_of_image.try_emplace(image, std::array{1.0, 1.0});
  if (is_new) {
    if (const auto read = read_picture(file, image)) entry->second = means_of(read->levels[0]);
  }
  return entry->second;
}

// The mean of a picture's colours, linear.
glm::dvec3 mean_colour(const Texture& texture) {
  return glm::dvec3{glm::vec3{load_texel(texture.levels.back(), 0, 0)}};
}

bool has_alpha(const Image& picture) {
  for (int y = 0; y < picture.height; ++y) {
    const auto texels = row<std::uint8_t>(picture, y);
    for (std::size_t x = 3; x < texels.size(); x += 4) {
      if (texels[x] != 255) return true;
    }
  }
  return false;
}

// 1 where alpha times the factor is the cutoff or more, else 0.
Texture mask_of(const Image& picture, double factor, double cutoff) {
  Image mask = make_image(Format::rgba8, picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y) {
    const auto from = row<std::uint8_t>(picture, y);
    const auto to = row<std::uint8_t>(mask, y);
    for (std::size_t x = 0; x < to.size(); ++x) {
      to[x] = from[x | 3] / 255.0 * factor >= cutoff ? 255 : 0;
    }
  }
  Texture texture = make_texture(std::move(mask));
  generate_mipmaps(texture, Profile{});
  return texture;
}

void set_opacity(GltfFile& file, const tinygltf::Material& from, int image, Material& material) {
  if (from.alphaMode != "BLEND" && from.alphaMode != "MASK") return;
  const double factor = from.pbrMetallicRoughness.baseColorFactor[3];
  const bool blends = from.alphaMode == "BLEND";
  if (blends) material.opacity = static_cast<float>(std::clamp(factor, 0.0, 1.0));
  const std::optional<std::uint32_t> texture = image >= 0 ? texture_of(file, image) : std::nullopt;
  const bool has_picture = texture && has_alpha(file.model.textures[*texture].levels[0]);
  if (!has_picture) {
    if (!blends && factor < from.alphaCutoff) material.opacity = 0.0f;
    return;
  }
  const auto [entry, is_new] = file.opacity_of_image.try_emplace(
      {image, blends ? 0.0 : factor, blends ? -1.0 : from.alphaCutoff},
      static_cast<std::uint32_t>(file.model.textures.size()));
  if (is_new) {
    const Image& picture = file.model.textures[*texture].levels[0];
    file.model.textures.push_back(blends ? make_opacity_texture(picture)
                                         : mask_of(picture, factor, from.alphaCutoff));
  }
  material.opacity_texture = entry->second;
  material.opacity_sampler = material.sampler;
  material.cut_out = is_cut_out(file.model.textures[entry->second]);
}

// As much of a factor as is there, from 0 to 1.
glm::dvec3 colour_of(std::span<const double> factor) {
  glm::dvec3 colour{0.0};
  for (std::size_t i = 0; i < std::min(factor.size(), std::size_t{3}); ++i) {
    colour[static_cast<int>(i)] = std::clamp(factor[i], 0.0, 1.0);
  }
  return colour;
}

double largest(glm::dvec3 v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

ShownColour shown_colour(GltfFile& file, const tinygltf::Material& from) {
  constexpr double kBlack = 0.01;
  const tinygltf::TextureInfo& base = from.pbrMetallicRoughness.baseColorTexture;
  const tinygltf::TextureInfo& light = from.emissiveTexture;
  const glm::dvec3 colour = colour_of(from.pbrMetallicRoughness.baseColorFactor);
  const glm::dvec3 emitted = colour_of(from.emissiveFactor);
  if (largest(emitted) > 0.0 && largest(colour) <= kBlack) {
    return {emitted, light.index, light.texCoord, &light.extensions, true};
  }
  if (largest(emitted) > 0.0) {
    warn_gltf(file, "material " + (from.name.empty() ? "without a name" : from.name) +
                        ": the light that it gives off is left out");
  }
  return {colour, base.index, base.texCoord, &base.extensions};
}

Material material_of(GltfFile& file, const tinygltf::Material& from) {
  const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
  Material material;
  material.name = from.name;
  material.two_sided = from.doubleSided;
  material.lit = extension(from.extensions, "KHR_materials_unlit") == nullptr;
  double metallic = std::clamp(pbr.metallicFactor, 0.0, 1.0);
  double roughness = std::clamp(pbr.roughnessFactor, 0.0, 1.0);
  if (pbr.metallicRoughnessTexture.index >= 0) {
    const std::array<double, 2> means =
        means_of(file, image_of(file, pbr.metallicRoughnessTexture.index));
    roughness *= means[0];
    metallic *= means[1];
  }
  const ShownColour shown = shown_colour(file, from);
  const glm::dvec3 base = shown.factor;
  if (shown.shines) material.lit = false;
  int image = -1;
  if (shown.texture >= 0) {
    image = image_of(file, shown.texture);
    if (image >= 0) material.texture = texture_of(file, image);
    material.sampler = sampler_of(file, shown.texture);
  }
  material.diffuse = glm::vec3{material.lit ? base * (1.0 - metallic / 2.0) : base};
  material.ambient = material.diffuse;
  const double square = roughness * roughness;
  const double exponent = std::clamp(2.0 / std::max(square * square, 1e-6) - 2.0, 1.0, 1024.0);
  material.shininess = static_cast<int>(exponent + 0.5);
  const glm::dvec3 seen =
      material.texture ? base * mean_colour(file.model.textures[*material.texture]) : base;
  const glm::dvec3 mirrored = glm::dvec3{0.04 * (1.0 - metallic)} + seen * metallic;
  for (int i = 0; i < 3; ++i) {
    const double lobe = std::min(mirrored[i] * (exponent + 8.0) / 8.0, 1.0);
    material.specular[i] = static_cast<float>(lobe * (1.0 - roughness));
  }
  // Alpha is the base colour's, also of what gives off light.
  const int base_texture = pbr.baseColorTexture.index;
  const int of_base = base_texture >= 0 ? image_of(file, base_texture) : -1;
  set_opacity(file, from, of_base, material);
  return material;
}

}  // namespace softfocus
