#include "scenes/models/gltf_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>
#include <type_traits>

#include "scenes/files/file_bytes.h"
#include "scenes/files/scene_error.h"
#include "scenes/models/obj_text.h"

// It asserts what only the file decides, and goes on well without.
#define TINYGLTF_IMPLEMENTATION
#ifndef NDEBUG
#define NDEBUG
#include <tiny_gltf.h>
#undef NDEBUG
#include <cassert>
#else
#include <tiny_gltf.h>
#endif

namespace softfocus {

void fail_gltf(const GltfFile& file, const std::string& reason) {
  throw SceneError(file.path.string() + ": " + reason);
}

void warn_gltf(GltfFile& file, const std::string& what) {
  if (!file.told.insert(what).second) return;
  file.model.warnings.push_back(printable(file.path.string() + ": " + what));
}

std::string numbered(const char* what, std::size_t number) {
  return std::string{what} + " " + std::to_string(number);
}

namespace {

int hex_digit(char letter) {
  if (letter >= '0' && letter <= '9') return letter - '0';
  if (letter >= 'a' && letter <= 'f') return letter - 'a' + 10;
  return letter >= 'A' && letter <= 'F' ? letter - 'A' + 10 : -1;
}

}  // namespace

std::string without_percents(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
    if (low >= 0) i += 2;
    text.push_back(low >= 0 ? static_cast<char>(16 * high + low) : uri[i]);
  }
  return text;
}

std::string packed_by(std::string_view extension) {
  return "its geometry is packed (" + std::string{extension} +
         "); the same model without compression would do";
}

std::string shortened(std::string text) {
  constexpr std::size_t kMost = 200;
  if (text.size() > kMost) text.replace(kMost, text.npos, "...");
  return text;
}

namespace {

constexpr std::size_t kMaxGltfBytes = std::size_t{1} << 30;

// Beside the model or below: tinygltf also looks where the program runs.
bool is_beside(const std::string& path, void* user) {
  const std::string folder = static_cast<const GltfFile*>(user)->path.parent_path().string();
  std::error_code unknown;
  return path.starts_with(folder) && std::filesystem::is_regular_file(path, unknown);
}

// A file may be longer than the buffer: exporters pad it.
bool read_buffer_file(std::vector<unsigned char>* bytes, std::string* error,
                      const std::string& path, void* user) {
  GltfFile& file = *static_cast<GltfFile*>(user);
  try {
    const std::string read = read_file_bytes(path, kMaxGltfBytes);
    file.model.files.emplace_back(path);
    const auto length = file.length_of_buffer.find(std::filesystem::path{path}.filename().string());
    const std::size_t most = length != file.length_of_buffer.end() ? length->second : read.size();
    bytes->assign(read.begin(),
                  read.begin() + static_cast<std::ptrdiff_t>(std::min(most, read.size())));
    return true;
  } catch (const SceneError& failed) {
    *error += failed.what();
    return false;
  }
}

// Later versions of tinygltf ask for the size first.
template <class Callbacks>
void set_size_callback(Callbacks& callbacks) {
  if constexpr (requires { callbacks.GetFileSizeInBytes; }) {
    callbacks.GetFileSizeInBytes = [](std::size_t* size, std::string*, const std::string& path,
                                      void*) {
      std::error_code failed;
      *size = static_cast<std::size_t>(std::filesystem::file_size(path, failed));
      return !failed;
    };
  }
}

// Keeps the bytes of a picture that the text holds. tinygltf checks no bounds of one in a buffer.
bool keep_picture(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
  return true;
}

// tinygltf takes nested lists apart on the stack, without a limit.
void check_nesting(const GltfFile& file, std::string_view json) {
  constexpr int kMostNested = 256;
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char letter = json[i];
    if (in_text && letter == '\\') {
      ++i;
    } else if (letter == '"') {
      in_text = !in_text;
    } else if (!in_text && (letter == '[' || letter == '{') && ++depth > kMostNested) {
      fail_gltf(file, "has lists in each other, deeper than " + std::to_string(kMostNested));
    } else if (!in_text && (letter == ']' || letter == '}')) {
      --depth;
    }
  }
}

// The JSON of a file: all of it, or the first chunk.
std::string_view json_of(std::string_view bytes, bool is_binary) {
  constexpr std::size_t kBeforeJson = 20;
  if (!is_binary || bytes.size() < kBeforeJson) return bytes;
  std::uint32_t length = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    length |= std::uint32_t{static_cast<unsigned char>(bytes[12 + i])} << (8 * i);
  }
  return bytes.substr(kBeforeJson, length);
}

// The lengths of buffers, by the last part of their files' names.
void find_lengths(GltfFile& file, std::string_view text) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("buffers")) return;
  for (const nlohmann::json& buffer : json["buffers"]) {
    if (!buffer.is_object() || !buffer.contains("uri") || !buffer.contains("byteLength")) continue;
    if (!buffer["uri"].is_string() || !buffer["byteLength"].is_number_unsigned()) continue;
    const std::string uri = buffer["uri"].get<std::string>();
    if (uri.starts_with("data:")) continue;
    const std::string name = std::filesystem::path{without_percents(uri)}.filename().string();
    std::size_t& length = file.length_of_buffer[name];
    length = std::max(length, buffer["byteLength"].get<std::size_t>());
  }
}

// What a file may require: what is understood, and what changes looks alone.
bool is_harmless(const std::string& extension) {
  constexpr std::array<std::string_view, 6> kBegin = {
      "KHR_materials_", "KHR_texture_",        "KHR_technique",
      "EXT_texture_",   "KHR_lights_punctual", "KHR_mesh_quantization"};
  return std::any_of(kBegin.begin(), kBegin.end(),
                     [&](std::string_view begin) { return extension.starts_with(begin); });
}

void check_extensions(GltfFile& file) {
  constexpr std::array<std::string_view, 4> kUnderstood = {
      "KHR_materials_unlit", "KHR_texture_transform", "KHR_lights_punctual",
      "KHR_mesh_quantization"};
  for (const std::string& name : file.gltf.extensionsRequired) {
    if (is_harmless(name)) continue;
    fail_gltf(file, name.ends_with("_compression")
                        ? packed_by(name)
                        : "needs " + name +
                              ", which is not understood; the same model without "
                              "it would do");
  }
  for (const std::string& name : file.gltf.extensionsUsed) {
    if (std::find(kUnderstood.begin(), kUnderstood.end(), name) == kUnderstood.end()) {
      warn_gltf(file, name + " is not understood");
    }
  }
}

void parse_gltf(GltfFile& file) {
  const std::string bytes = read_file_bytes(file.path, kMaxGltfBytes);
  const bool is_binary = bytes.starts_with("glTF");
  check_nesting(file, json_of(bytes, is_binary));
  find_lengths(file, json_of(bytes, is_binary));
  file.model.files.push_back(file.path);
  tinygltf::FsCallbacks callbacks{};
  callbacks.FileExists = is_beside;
  callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
  callbacks.ReadWholeFile = read_buffer_file;
  callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&,
                                void*) { return false; };
  callbacks.user_data = &file;
  set_size_callback(callbacks);
  tinygltf::TinyGLTF parser;
  parser.SetFsCallbacks(callbacks);
  parser.SetImageLoader(keep_picture, nullptr);
  std::string error, warning;
  const auto size = static_cast<unsigned>(bytes.size());
  const std::string folder = file.path.parent_path().string();
  const bool is_read =
      is_binary
          ? parser.LoadBinaryFromMemory(&file.gltf, &error, &warning,
                                        reinterpret_cast<const unsigned char*>(bytes.data()), size,
                                        folder)
          : parser.LoadASCIIFromString(&file.gltf, &error, &warning, bytes.data(), size, folder);
  if (!is_read) {
    // Packed geometry without another form has no bufferViews.
    const bool packs = error.find("bufferView") != error.npos && bytes.find(kDraco) != bytes.npos;
    std::replace(error.begin(), error.end(), '\n', ' ');
    fail_gltf(file, packs ? packed_by(kDraco)
                          : "cannot be read (" + shortened(std::string{trimmed(error)}) +
                                "); a glTF 2.0 file, .gltf or .glb, would do");
  }
  const std::string& version = file.gltf.asset.version;
  if (!version.starts_with("2.")) {
    fail_gltf(file, (version.empty() ? "tells no version" : "is glTF " + version) +
                        "; a glTF 2.0 file would do");
  }
  check_extensions(file);
}

}  // namespace

GltfFile open_gltf(const std::filesystem::path& path) {
  check_no_pipe(path);
  GltfFile file{path};
  parse_gltf(file);
  return file;
}

namespace {

std::size_t bytes_of_component(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return 4;
    default: return 0;
  }
}

// Of an accessor's type: 1 to 4, 16 of a matrix, 0 of others.
std::size_t numbers_of_type(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR: return 1;
    case TINYGLTF_TYPE_VEC2: return 2;
    case TINYGLTF_TYPE_VEC3: return 3;
    case TINYGLTF_TYPE_VEC4: return 4;
    case TINYGLTF_TYPE_MAT4: return 16;
    default: return 0;
  }
}

// The lowest byte comes first.
template <class Number>
double number_at(const unsigned char* bytes, bool normalized) {
  std::array<unsigned char, sizeof(Number)> own;
  std::memcpy(own.data(), bytes, own.size());
  if constexpr (std::endian::native == std::endian::big) std::reverse(own.begin(), own.end());
  const auto value = static_cast<double>(std::bit_cast<Number>(own));
  if (!normalized || std::is_floating_point_v<Number>) return value;
  return std::max(value / static_cast<double>(std::numeric_limits<Number>::max()), -1.0);
}

double component_at(const unsigned char* bytes, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return number_at<std::int8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return number_at<std::uint8_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT: return number_at<std::int16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return number_at<std::uint16_t>(bytes, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return number_at<std::uint32_t>(bytes, normalized);
    default: return number_at<float>(bytes, normalized);
  }
}

// `count` elements of `element` bytes, `stride` apart, that begin at `offset` in a view of a
// buffer.
const unsigned char* elements_of(const GltfFile& file, int view_number, std::size_t offset,
                                 std::size_t count, std::size_t element, std::size_t& stride) {
  const tinygltf::BufferView& view =
      item_of(file, file.gltf.bufferViews, view_number, "bufferView");
  const tinygltf::Buffer& buffer = item_of(file, file.gltf.buffers, view.buffer, "buffer");
  stride = view.byteStride != 0 ? view.byteStride : element;
  const std::size_t all = buffer.data.size();
  const bool is_inside = view.byteOffset <= all && view.byteLength <= all - view.byteOffset;
  const std::size_t length = view.byteLength;
  if (!is_inside || element == 0 || (count > 1 && stride < element) || count == 0 ||
      offset > length || element > length - offset ||
      (count - 1) > (length - offset - element) / stride) {
    fail_gltf(file, "bufferView " + std::to_string(view_number) +
                        " is shorter than what is read from it, or its buffer ends before");
  }
  return buffer.data.data() + view.byteOffset + offset;
}

bool is_whole(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

void put_sparse(const GltfFile& file, const tinygltf::Accessor& accessor, GltfNumbers& numbers) {
  const auto& sparse = accessor.sparse;
  if (!sparse.isSparse || sparse.count <= 0) return;
  const auto count = static_cast<std::size_t>(sparse.count);
  const std::size_t component = bytes_of_component(accessor.componentType);
  const std::size_t index = bytes_of_component(sparse.indices.componentType);
  if (index == 0 || !is_whole(sparse.indices.componentType)) {
    fail_gltf(file, "a sparse accessor's indices have an unknown type");
  }
  std::size_t index_stride = 0, stride = 0;
  const unsigned char* places =
      elements_of(file, sparse.indices.bufferView,
                  static_cast<std::size_t>(sparse.indices.byteOffset), count, index, index_stride);
  const unsigned char* values = elements_of(file, sparse.values.bufferView,
                                            static_cast<std::size_t>(sparse.values.byteOffset),
                                            count, component * numbers.width, stride);
  for (std::size_t i = 0; i < count; ++i) {
    const double place =
        component_at(places + i * index_stride, sparse.indices.componentType, false);
    if (!(place >= 0.0 && place < static_cast<double>(numbers.count()))) {
      fail_gltf(file,
                "a sparse accessor puts an element past its " + std::to_string(numbers.count()));
    }
    for (std::size_t k = 0; k < numbers.width; ++k) {
      numbers.values[static_cast<std::size_t>(place) * numbers.width + k] = component_at(
          values + i * stride + k * component, accessor.componentType, accessor.normalized);
    }
  }
}

}  // namespace

GltfNumbers read_accessor(GltfFile& file, int number) {
  const tinygltf::Accessor& accessor = item_of(file, file.gltf.accessors, number, "accessor");
  const std::size_t component = bytes_of_component(accessor.componentType);
  GltfNumbers numbers{numbers_of_type(accessor.type)};
  const std::string name = numbered("accessor", static_cast<std::size_t>(number));
  if (component == 0 || numbers.width == 0) fail_gltf(file, name + " has an unknown type");
  if (accessor.count == 0) fail_gltf(file, name + " has no elements");
  if (accessor.count > file.numbers_left / numbers.width) {
    fail_gltf(file, name + " has " + std::to_string(accessor.count) +
                        " elements: with its copies the model has too many");
  }
  file.numbers_left -= accessor.count * numbers.width;
  numbers.is_whole = is_whole(accessor.componentType) && !accessor.normalized;
  if (accessor.bufferView >= 0) {
    std::size_t stride = 0;
    const unsigned char* from = elements_of(file, accessor.bufferView, accessor.byteOffset,
                                            accessor.count, component * numbers.width, stride);
    numbers.values.reserve(accessor.count * numbers.width);
    for (std::size_t i = 0; i < accessor.count; ++i, from += stride) {
      for (std::size_t k = 0; k < numbers.width; ++k) {
        numbers.values.push_back(
            component_at(from + k * component, accessor.componentType, accessor.normalized));
      }
    }
  } else {
    // Zeros, unless sparse elements replace them. A small file could claim gigabytes.
    constexpr std::size_t kMostZeros = std::size_t{1} << 22;
    if (accessor.count * numbers.width > kMostZeros) {
      fail_gltf(file, name + " has " + std::to_string(accessor.count) +
                          " elements and no buffer; up to " +
                          std::to_string(kMostZeros / numbers.width) + " would do");
    }
    numbers.values.resize(accessor.count * numbers.width);
  }
  put_sparse(file, accessor, numbers);
  return numbers;
}

std::string view_bytes(const GltfFile& file, int number) {
  const std::size_t length = item_of(file, file.gltf.bufferViews, number, "bufferView").byteLength;
  std::size_t stride = 0;
  const unsigned char* bytes = elements_of(file, number, 0, 1, length, stride);
  return {bytes, bytes + length};
}

std::optional<GltfNumbers> read_attribute(GltfFile& file, const std::map<std::string, int>& of,
                                          const std::string& name, std::size_t count,
                                          std::size_t least, std::size_t most) {
  const auto found = of.find(name);
  if (found == of.end()) return std::nullopt;
  GltfNumbers numbers = read_accessor(file, found->second);
  if (numbers.count() != count || numbers.width < least || numbers.width > most) {
    fail_gltf(file, name + " has " + std::to_string(numbers.count()) + " elements of " +
                        std::to_string(numbers.width) + " numbers where " + std::to_string(count) +
                        " of " + std::to_string(least) + " would be right");
  }
  return numbers;
}

const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found == extensions.end() ? nullptr : &found->second;
}

double number_in(const tinygltf::Value& object, const char* key, double fallback) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return fallback;
  return object.Get(key).GetNumberAsDouble();
}

double number_in(const tinygltf::Value& object, const char* key, std::size_t i, double fallback) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsArray()) return fallback;
  const tinygltf::Value& array = object.Get(key);
  if (i >= array.ArrayLen()) return fallback;
  const tinygltf::Value& item = array.Get(static_cast<int>(i));
  return item.IsNumber() ? item.GetNumberAsDouble() : fallback;
}

int index_in(const tinygltf::Value& object, const char* key) {
  const double number = number_in(object, key, -1.0);
  return number >= 0.0 && number <= 1e9 ? static_cast<int>(number) : -1;
}

}  // namespace softfocus
