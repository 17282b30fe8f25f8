#pragma once
// A glTF file as tinygltf takes it apart, and its numbers, checked: what the readers of models
// share.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "scenes/models/model.h"

// Files are read by read_file_bytes(), pictures by texture_of_bytes().
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

namespace softfocus {

/// A file that is being read, and the model that grows of it.
struct GltfFile {
  std::filesystem::path path;
  tinygltf::Model gltf{};
  Model model{};
  std::map<int, std::optional<std::uint32_t>> texture_of_image{};
  std::map<std::tuple<int, double, double>, std::uint32_t> opacity_of_image{};
  /// Roughness and metallic, means of a picture.
  std::map<int, std::array<double, 2>> means_of_image{};
  std::map<std::string, std::size_t> length_of_buffer{};  ///< by its file's name
  std::set<std::string> told{};                           ///< warnings
  std::size_t animation_keys = 0;                         ///< that were read
  std::size_t numbers_left = std::size_t{1} << 30;        ///< that may still be read
};

/// Throws SceneError for a file that is no glTF 2.0, or needs an extension that is not understood.
GltfFile open_gltf(const std::filesystem::path& path);

/// Throws SceneError, "PATH: reason".
[[noreturn]] void fail_gltf(const GltfFile& file, const std::string& reason);

/// Each warning once.
void warn_gltf(GltfFile& file, const std::string& what);

/// "node 3".
std::string numbered(const char* what, std::size_t number);

/// An item by its number in the file, which may be wrong.
template <class Item>
const Item& item_of(const GltfFile& file, const std::vector<Item>& items, int number,
                    const char* what) {
  if (number < 0 || static_cast<std::size_t>(number) >= items.size()) {
    fail_gltf(file, std::string{"there is no "} + what + " " + std::to_string(number) + " of " +
                        std::to_string(items.size()));
  }
  return items[static_cast<std::size_t>(number)];
}

/// An accessor's elements: normalised ones as shares, sparse ones in their places.
struct GltfNumbers {
  std::size_t width = 0;  ///< of an element
  std::vector<double> values{};
  bool is_whole = false;  ///< in the file: unsigned, and no shares

  std::size_t count() const { return width == 0 ? 0 : values.size() / width; }
  const double* operator[](std::size_t i) const { return values.data() + i * width; }
  glm::dvec3 vec3(std::size_t i) const { return {(*this)[i][0], (*this)[i][1], (*this)[i][2]}; }
};

/// All of a bufferView.
std::string view_bytes(const GltfFile& file, int number);

/// Throws for one without elements.
GltfNumbers read_accessor(GltfFile& file, int number);

/// Of an attribute, or none; with `count` elements of `least` to `most` numbers.
std::optional<GltfNumbers> read_attribute(GltfFile& file, const std::map<std::string, int>& of,
                                          const std::string& name, std::size_t count,
                                          std::size_t least, std::size_t most);

/// An extension's object, or null.
const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions, const char* name);

/// A number in an object, or in an array of one.
double number_in(const tinygltf::Value& object, const char* key, double fallback);
double number_in(const tinygltf::Value& object, const char* key, std::size_t i, double fallback);
/// A whole number from 0 on, or -1.
int index_in(const tinygltf::Value& object, const char* key);

/// A URI's text: %20 is a blank.
std::string without_percents(std::string_view uri);

/// Of a radian.
inline constexpr double kDegrees = 57.295779513082320877;

inline constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// The complaint about geometry that an extension packs.
std::string packed_by(std::string_view extension);

/// The beginning of what may be very long.
std::string shortened(std::string text);

}  // namespace softfocus
