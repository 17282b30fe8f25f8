#include "scenes/load/mtl_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "scenes/files/file_bytes.h"
#include "scenes/files/texture_file.h"
#include "scenes/make/procedural_texture.h"

#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

namespace softfocus {
namespace {

constexpr std::size_t kMaxMtlBytes = std::size_t{1} << 24;

bool is_there(const std::filesystem::path& file) {
  std::error_code unknown;
  return std::filesystem::exists(file, unknown);
}

// 0 to 1 and a little over; NaN and what is below give 0.
glm::vec3 reflectance(const float (&value)[3]) {
  const auto limited = [](float x) { return x > 0.0f ? std::min(x, 10.0f) : 0.0f; };
  return {limited(value[0]), limited(value[1]), limited(value[2])};
}

// As it is written, with forward slashes, and by its last part: libraries carry the
// paths of the machine they were made on.
std::filesystem::path find_texture(const std::filesystem::path& library, std::string written) {
  std::replace(written.begin(), written.end(), '\\', '/');
  const std::filesystem::path as_written = library.parent_path() / written;
  const std::filesystem::path beside =
      library.parent_path() / std::filesystem::path(written).filename();
  return is_there(as_written) ? as_written : is_there(beside) ? beside : std::filesystem::path{};
}

bool is_picture(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& letter : extension) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  constexpr std::array<std::string_view, 3> kKnown = {".png", ".jpg", ".jpeg"};
  return std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end();
}

// The index of a texture that a material names, loaded once.
std::optional<std::uint32_t> texture_index(const std::filesystem::path& library,
                                           const std::string& material, const std::string& written,
                                           MtlMaterials& materials) {
  const auto warn = [&](const std::string& reason) {
    materials.warnings.push_back(library.string() + ": material " + material + ": texture " +
                                 written + " " + reason);
  };
  const std::filesystem::path file = find_texture(library, written);
  if (file.empty()) {
    warn("is missing");
    return std::nullopt;
  }
  if (!is_picture(file)) {
    warn("is neither PNG nor JPEG, and left out");
    return std::nullopt;
  }
  const auto [entry, is_new] = materials.texture_of_file.emplace(
      file.lexically_normal().string(), static_cast<std::uint32_t>(materials.textures.size()));
  if (is_new) {
    materials.textures.push_back(load_texture(file));
    materials.files.push_back(file);
  }
  return entry->second;
}

Wrap wrap_of(const tinyobj::texture_option_t& options) {
  return options.clamp ? Wrap::clamp_to_edge : Wrap::repeat;
}

void add_opacity(const std::filesystem::path& library, const tinyobj::material_t& from,
                 MtlMaterials& materials, Material& material) {
  material.opacity = from.dissolve >= 0.0f ? std::min(from.dissolve, 1.0f) : 0.0f;
  if (from.alpha_texname.empty()) return;
  const auto picture = texture_index(library, from.name, from.alpha_texname, materials);
  if (!picture) return;
  const auto [entry, is_new] = materials.opacity_of_texture.emplace(
      *picture, static_cast<std::uint32_t>(materials.textures.size()));
  if (is_new) {
    materials.textures.push_back(make_opacity_texture(materials.textures[*picture].levels[0]));
  }
  material.opacity_texture = entry->second;
  material.cut_out = is_cut_out(materials.textures[entry->second]);
  material.opacity_sampler.wrap_u = material.opacity_sampler.wrap_v = wrap_of(from.alpha_texopt);
}

Material make_material(const std::filesystem::path& library, const tinyobj::material_t& from,
                       MtlMaterials& materials) {
  constexpr glm::vec3 kBlack{0.0f};
  constexpr glm::vec3 kWhite{1.0f};
  Material material;
  material.name = from.name;
  material.two_sided = true;
  material.diffuse = reflectance(from.diffuse);
  if (!from.diffuse_texname.empty()) {
    material.texture = texture_index(library, from.name, from.diffuse_texname, materials);
    material.sampler.wrap_u = material.sampler.wrap_v = wrap_of(from.diffuse_texopt);
    if (material.texture && material.diffuse == kBlack) material.diffuse = kWhite;
    if (!material.texture) material.diffuse = neutral_grey().diffuse;
  }
  material.ambient = reflectance(from.ambient);
  if (material.ambient == kBlack || material.ambient == kWhite) {
    material.ambient = material.diffuse;
  }
  material.specular = reflectance(from.specular);
  const float shininess = from.shininess >= 1.0f ? std::min(from.shininess, 1024.0f) : 1.0f;
  material.shininess = static_cast<int>(shininess + 0.5f);
  add_opacity(library, from, materials, material);
  return material;
}

// `d -halo 0.5`, less opaque towards the outline, as `d 0.5`: tinyobjloader takes it for d 0.
std::string without_halos(std::string text) {
  constexpr std::string_view kHalo = "d -halo ";
  for (std::size_t at = 0; (at = text.find(kHalo, at)) != text.npos; ++at) {
    text.replace(at, kHalo.size(), "d ");
  }
  return text;
}

}  // namespace

Material neutral_grey() {
  Material grey;
  grey.name = "neutral grey";
  grey.ambient = grey.diffuse = glm::vec3{0.5f};
  grey.specular = glm::vec3{0.08f};
  grey.two_sided = true;
  return grey;
}

void load_mtl(const std::filesystem::path& library, MtlMaterials& materials) {
  std::istringstream text(without_halos(read_file_bytes(library, kMaxMtlBytes)));
  materials.files.push_back(library);
  std::map<std::string, int> index_of_name;
  std::vector<tinyobj::material_t> read;
  std::string warning;
  std::string error;
  tinyobj::LoadMtl(&index_of_name, &read, &text, &warning, &error);
  for (const tinyobj::material_t& from : read) {
    if (from.name.empty() || materials.by_name.contains(from.name)) continue;
    materials.by_name.emplace(from.name, make_material(library, from, materials));
  }
}

}  // namespace softfocus
