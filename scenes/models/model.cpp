#include "scenes/models/model.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "scenes/files/file_bytes.h"
#include "scenes/files/scene_error.h"
#include "scenes/models/gltf_model.h"
#include "scenes/models/obj_model.h"
#include "scenes/models/ply_stl.h"

namespace softfocus {
namespace {

bool is_gltf_name(std::string_view name) {
  return has_extension(name, ".gltf") || has_extension(name, ".glb");
}

}  // namespace

bool is_model_name(std::string_view name) {
  return is_gltf_name(name) || has_extension(name, ".obj") || has_extension(name, ".ply") ||
         has_extension(name, ".stl");
}

Model load_model(const std::filesystem::path& file, ThreadPool* pool) {
  const std::string name = file.string();
  if (is_gltf_name(name)) return load_gltf_model(file);
  if (has_extension(name, ".obj")) return load_obj_model(file, pool);
  constexpr std::size_t kMostBytes = std::size_t{1} << 29;
  check_no_pipe(file);
  const std::string bytes = read_file_bytes(file, kMostBytes);
  FileFaces read = has_extension(name, ".ply") ? parse_ply(bytes, name) : parse_stl(bytes, name);
  MtlMaterials materials;
  if (!read.texture.empty()) add_picture(file, read.texture, materials);
  return model_of_faces(std::move(read.faces), file, read.origin, std::move(materials), pool);
}

glm::dvec3 far_middle(glm::dvec3 low, glm::dvec3 high) {
  constexpr double kFar = 64.0;  // halves of the size
  const glm::dvec3 half = (high - low) / 2.0;
  const glm::dvec3 middle = (low + high) / 2.0;
  const double size = std::max({half.x, half.y, half.z});
  const double away = std::max({std::fabs(middle.x), std::fabs(middle.y), std::fabs(middle.z)});
  if (!(away > kFar * size && away > kFar)) return glm::dvec3{0.0};
  return {std::round(middle.x), std::round(middle.y), std::round(middle.z)};
}

std::string far_warning(const std::filesystem::path& file, glm::dvec3 subtracted) {
  std::string text = "(";
  for (int axis = 0; axis < 3; ++axis) {
    text.append(axis == 0 ? "" : ", ")
        .append(std::to_string(static_cast<std::int64_t>(subtracted[axis])));
  }
  return printable(file.string()) + ": is far from the origin for its size; " + text +
         ") is subtracted from its positions";
}

}  // namespace softfocus
