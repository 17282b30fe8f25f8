#include "scenes/models/mtl_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "raster/numbers/exact_math.h"
#include "scenes/files/decimal.h"
#include "scenes/files/file_bytes.h"
#include "scenes/files/texture_file.h"
#include "scenes/make/procedural_texture.h"
#include "scenes/models/obj_text.h"

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

std::string lower(std::string_view word) {
  std::string text{word};
  for (char& letter : text) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return text;
}

bool is_picture(const std::filesystem::path& file) {
  const std::string extension = lower(file.extension().string());
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

struct Map {
  std::string file;  // empty: none
  Wrap wrap = Wrap::repeat;
  UvPlacement placement{};
};

// A material's maps, which tinyobjloader takes apart otherwise than files are written.
struct Maps {
  Map diffuse, opacity;
};

// What a library says, line by line: maps for us, numbers as tinyobjloader reads them.
struct MtlText {
  const std::filesystem::path& library;
  std::vector<std::string>& warnings;
  std::string numbers{};
  std::map<std::string, Maps> maps{};  // by material; the first of a name stays
  // The material that is being read.
  std::string name{};
  bool is_first = false;  // of its name
  bool has_dissolve = false;
  std::string transparency{};  // Tr's number
  std::set<std::string> told{};
};

void warn(MtlText& mtl, const std::string& reason) {
  mtl.warnings.push_back(mtl.library.string() + ": material " + mtl.name + ": " + reason);
}

void end_material(MtlText& mtl) {
  if (!mtl.transparency.empty() && !mtl.has_dissolve) {
    if (*decimal_to_float(mtl.transparency) >= 1.0f) {
      warn(mtl, "Tr 1 without d would make it invisible; it is taken for opaque");
    } else {
      mtl.numbers.append("Tr ").append(mtl.transparency).append("\n");
    }
  }
  mtl.has_dissolve = false;
  mtl.transparency.clear();
}

// "Kd 0.5 0.5 0.5", or nothing.
void read_colour(MtlText& mtl, const std::string& key, std::string_view line) {
  const std::string_view written = trimmed(line);
  const std::string_view first = next_word(line);
  if (const std::string kind = lower(first); kind == "spectral" || kind == "xyz") {
    warn(mtl, key + " " + kind + " is not known; grey stands in");
    if (key == "Kd") mtl.numbers.append("Kd 0.5 0.5 0.5\n");
    return;
  }
  std::string numbers = key;
  std::string_view word = first;
  std::string_view last = "0";
  bool is_right = !word.empty();
  for (int i = 0; i < 3; ++i) {
    if (!word.empty() && !word.starts_with('#')) {
      const auto number = decimal_to_float(word);
      last = number && *number >= 0.0f ? word : "0";
      is_right = is_right && number && *number >= 0.0f;
      word = next_word(line);
    }
    numbers.append(" ").append(last);
  }
  if (!is_right) {
    warn(mtl, key + " " + std::string{written.substr(0, 40)} +
                  " is no colour; three numbers from 0 to 1 would be right");
  }
  mtl.numbers.append(numbers).append("\n");
}

// The word of a number from 0 up, or nothing.
std::optional<std::string_view> read_number(MtlText& mtl, const char* key, std::string_view line) {
  std::string_view word = next_word(line);
  if (word == "-halo") word = next_word(line);
  const auto number = decimal_to_float(word);
  if (number && *number >= 0.0f) return word;
  warn(mtl, std::string{key} + " " + std::string{word.substr(0, 40)} +
                " is out of range and passed over");
  return std::nullopt;
}

glm::vec2 read_pair(std::string_view& line, glm::vec2 otherwise) {
  for (int i = 0; i < 3; ++i) {
    std::string_view rest = line;
    const auto number = decimal_to_float(next_word(rest));
    // A file may be called 4.
    if (!number || trimmed(rest).empty()) break;
    if (i < 2 && std::fabs(*number) <= 1e6f) otherwise[i] = *number;
    line = rest;
  }
  return otherwise;
}

Map read_map(MtlText& mtl, const std::string& key, std::string_view line) {
  Map map;
  for (;;) {
    std::string_view rest = line;
    const std::string option = lower(next_word(rest));
    if (!option.starts_with('-') || trimmed(rest).empty()) break;
    if (option == "-s") {
      map.placement.scale = read_pair(rest, map.placement.scale);
    } else if (option == "-o") {
      map.placement.offset = read_pair(rest, map.placement.offset);
    } else if (option == "-t") {
      map.placement.turbulence = read_pair(rest, map.placement.turbulence);
    } else if (option == "-clamp") {
      map.wrap = lower(next_word(rest)) == "on" ? Wrap::clamp_to_edge : Wrap::repeat;
    } else {
      constexpr std::array<std::string_view, 9> kOthers = {
          "-blendu", "-blendv", "-boost", "-mm", "-texres", "-bm", "-imfchan", "-type", "-cc"};
      if (std::find(kOthers.begin(), kOthers.end(), option) == kOthers.end())
        break;  // a file's name
      next_word(rest);
      if (option == "-mm") next_word(rest);
      if (mtl.told.insert(option).second) {
        warn(mtl, std::string{key}
                      .append("'s option ")
                      .append(option)
                      .append(" is not obeyed, here and in what follows"));
      }
    }
    line = rest;
  }
  map.file = trimmed(line);
  if (map.file.size() > 1 && map.file.front() == '"' && map.file.back() == '"') {
    map.file = map.file.substr(1, map.file.size() - 2);
  }
  return map;
}

void read_line(MtlText& mtl, std::string_view line) {
  const std::string key = lower(next_word(line));
  if (key == "newmtl") {
    end_material(mtl);
    mtl.name = trimmed(line);
    mtl.is_first = mtl.maps.try_emplace(mtl.name).second;
    mtl.numbers.append("newmtl ").append(mtl.name).append("\n");
  } else if (key == "kd" || key == "ka" || key == "ks") {
    read_colour(mtl, key == "kd" ? "Kd" : key == "ka" ? "Ka" : "Ks", line);
  } else if (key == "ns") {
    if (const auto number = read_number(mtl, "Ns", line)) {
      mtl.numbers.append("Ns ").append(*number).append("\n");
    }
  } else if (key == "d") {
    if (const auto number = read_number(mtl, "d", line)) {
      mtl.has_dissolve = true;
      mtl.numbers.append("d ").append(*number).append("\n");
    }
  } else if (key == "tr") {
    if (const auto number = read_number(mtl, "Tr", line)) mtl.transparency = *number;
  } else if (mtl.is_first && (key == "map_kd" || key == "map_d")) {
    Maps& maps = mtl.maps.at(mtl.name);
    (key == "map_d" ? maps.opacity : maps.diffuse) = read_map(mtl, key, line);
  }
}

void add_opacity(const std::filesystem::path& library, const tinyobj::material_t& from,
                 const Map& map, MtlMaterials& materials, Material& material) {
  material.opacity = from.dissolve >= 0.0f ? std::min(from.dissolve, 1.0f) : 0.0f;
  if (map.file.empty()) return;
  const auto picture = texture_index(library, from.name, map.file, materials);
  if (!picture) return;
  const auto [entry, is_new] = materials.opacity_of_texture.emplace(
      *picture, static_cast<std::uint32_t>(materials.textures.size()));
  if (is_new) {
    materials.textures.push_back(make_opacity_texture(materials.textures[*picture].levels[0]));
  }
  material.opacity_texture = entry->second;
  material.cut_out = is_cut_out(materials.textures[entry->second]);
  material.opacity_sampler.wrap_u = material.opacity_sampler.wrap_v = map.wrap;
}

Material make_material(const std::filesystem::path& library, const tinyobj::material_t& from,
                       const Maps& maps, MtlMaterials& materials) {
  constexpr glm::vec3 kBlack{0.0f};
  constexpr glm::vec3 kWhite{1.0f};
  Material material;
  material.name = from.name;
  material.two_sided = true;
  material.diffuse = reflectance(from.diffuse);
  if (!maps.diffuse.file.empty()) {
    material.texture = texture_index(library, from.name, maps.diffuse.file, materials);
    material.sampler.wrap_u = material.sampler.wrap_v = maps.diffuse.wrap;
    if (material.texture && material.diffuse == kBlack) material.diffuse = kWhite;
    if (!material.texture) material.diffuse = neutral_grey().diffuse;
  }
  material.ambient = reflectance(from.ambient);
  if (material.ambient == kBlack || material.ambient == kWhite) {
    material.ambient = material.diffuse;
  }
  // An exponent of 0 would be a highlight all over.
  if (from.shininess > 0.0f) material.specular = reflectance(from.specular);
  const float shininess = from.shininess >= 1.0f ? std::min(from.shininess, 1024.0f) : 1.0f;
  material.shininess = static_cast<int>(shininess + 0.5f);
  add_opacity(library, from, maps.opacity, materials, material);
  return material;
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

void place_uvs(Mesh& mesh, const UvPlacement& placement) {
  if (placement == UvPlacement{}) return;
  // Waves of unlike lengths across each other, -1 to 1.
  const auto waves = [](double along, double across) {
    return 0.6 * exact_math::sin_degrees(360.0 * (across + 0.31 * along)) +
           0.4 * exact_math::sin_degrees(360.0 * (2.7 * across - 1.9 * along));
  };
  for (glm::vec2& uv : mesh.uvs) {
    const glm::dvec2 p{uv.x, 1.0 - static_cast<double>(uv.y)};
    const glm::dvec2 wave{waves(p.x, p.y), waves(p.y, p.x)};
    const glm::dvec2 placed = p * glm::dvec2{placement.scale} + glm::dvec2{placement.offset} +
                              glm::dvec2{placement.turbulence} * wave;
    uv = {placed.x, 1.0 - placed.y};
  }
}

void load_mtl(const std::filesystem::path& library, MtlMaterials& materials) {
  const std::string text = read_file_text(library, kMaxMtlBytes);
  materials.files.push_back(library);
  MtlText mtl{library, materials.warnings};
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find_first_of("\r\n", start), text.size());
    read_line(mtl, std::string_view{text}.substr(start, end - start));
    start = end + 1;
  }
  end_material(mtl);
  std::istringstream numbers(mtl.numbers);
  std::map<std::string, int> index_of_name;
  std::vector<tinyobj::material_t> read;
  std::string warning;
  std::string error;
  tinyobj::LoadMtl(&index_of_name, &read, &numbers, &warning, &error);
  for (const tinyobj::material_t& from : read) {
    if (from.name.empty() || materials.by_name.contains(from.name)) continue;
    const auto found = mtl.maps.find(from.name);  // tinyobjloader ends a name at a zero
    const Maps maps = found != mtl.maps.end() ? found->second : Maps{};
    materials.by_name.emplace(from.name, make_material(library, from, maps, materials));
    const Map& placed = maps.diffuse.file.empty() ? maps.opacity : maps.diffuse;
    materials.placements.emplace(from.name, placed.placement);
  }
}

void add_picture(const std::filesystem::path& file, const std::string& picture,
                 MtlMaterials& materials) {
  Material material = neutral_grey();
  material.name = picture;
  material.texture = texture_index(file, picture, picture, materials);
  if (material.texture) material.diffuse = material.ambient = glm::vec3{1.0f};
  materials.by_name.emplace(picture, material);
}

}  // namespace softfocus
