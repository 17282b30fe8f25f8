#pragma once
// glTF models as tests write them, and what the reader makes of them.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "scenes/models/gltf_model.h"
#include "tests/support/scene_test_files.h"
#include "tests/support/skip.h"
#include "tools/files/base64.h"

namespace softfocus::test {

inline constexpr int kByte = 5121, kShort = 5123, kInt = 5125, kFloat = 5126;

/// Red and opaque beside green of an alpha of 100.
inline const std::string kTwoTexels =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAD0lEQVR4nGP4z8DwHwhT"
    "ABBdA2K1LfSlAAAAAElFTkSuQmCC";

/// The text of a model: what tests put into its lists, and a buffer of their numbers.
struct Gltf {
  std::string bytes, views, accessors, meshes, nodes, more;

  static void item(std::string& list, const std::string& text) {
    list += (list.empty() ? "" : ",") + text;
  }

  /// A view of bytes; its number.
  int view(const std::string& of, int stride = 0) {
    item(views, "{\"buffer\":0,\"byteOffset\":" + std::to_string(bytes.size()) +
                    ",\"byteLength\":" + std::to_string(of.size()) +
                    (stride != 0 ? ",\"byteStride\":" + std::to_string(stride) : "") + "}");
    bytes += of;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    return view_count++;
  }
  /// An accessor of numbers of a type; its number.
  template <class Number>
  int add(const std::vector<Number>& numbers, const std::string& type, int width, int component,
          const std::string& also = "") {
    std::string of;
    for (const Number number : numbers) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &number, sizeof number);
      if constexpr (sizeof(Number) == 4) {
        std::uint32_t word = 0;
        std::memcpy(&word, &number, 4);
        bits = word;
      } else if constexpr (sizeof(Number) == 2) {
        bits = static_cast<std::uint16_t>(number);
      } else {
        bits = static_cast<std::uint8_t>(number);
      }
      for (std::size_t i = 0; i < sizeof number; ++i) {
        of.push_back(static_cast<char>(bits >> (8 * i) & 255));
      }
    }
    const int number_of_view = view(of);
    item(accessors, "{\"bufferView\":" + std::to_string(number_of_view) +
                        ",\"componentType\":" + std::to_string(component) + ",\"count\":" +
                        std::to_string(numbers.size() / static_cast<std::size_t>(width)) +
                        ",\"type\":\"" + type + "\"" + also + "}");
    return accessor_count++;
  }
  int floats(const std::vector<float>& numbers, const std::string& type, int width) {
    return add(numbers, type, width, kFloat);
  }
  void mesh(const std::string& attributes, const std::string& also = "") {
    item(meshes, "{\"primitives\":[{\"attributes\":{" + attributes + "}" + also + "}]}");
  }
  void node(const std::string& text) { item(nodes, "{" + text + "}"); }

  std::string text(const std::string& buffer_uri) const {
    return "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{" + buffer_uri +
           "\"byteLength\":" + std::to_string(bytes.size()) + "}],\"bufferViews\":[" + views +
           "],\"accessors\":[" + accessors + "],\"meshes\":[" + meshes + "],\"nodes\":[" +
           (nodes.empty() ? "{\"mesh\":0}" : nodes) + "]" + more + "}";
  }
  std::string text() const {
    const auto* data = reinterpret_cast<const std::byte*>(bytes.data());
    return text("\"uri\":\"data:application/octet-stream;base64," + base64({data, bytes.size()}) +
                "\",");
  }
  std::string binary() const {
    std::string json = text("");
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string made;
    const auto word = [&](std::size_t value) {
      for (int i = 0; i < 4; ++i) made.push_back(static_cast<char>(value >> (8 * i) & 255));
    };
    made += "glTF";
    word(2);
    word(12 + 8 + json.size() + 8 + bytes.size());
    word(json.size());
    made += "JSON" + json;
    word(bytes.size());
    made += std::string{"BIN\0", 4} + bytes;
    return made;
  }

  int view_count = 0, accessor_count = 0;
};

/// One triangle: (0, 0, 0), (1, 0, 0), (0, 2, 0).
inline Gltf triangle(const std::string& attributes = "", const std::string& also = "") {
  Gltf gltf;
  gltf.floats({0, 0, 0, 1, 0, 0, 0, 2, 0}, "VEC3", 3);
  gltf.mesh("\"POSITION\":0" + attributes, also);
  return gltf;
}

inline Model load(const std::string& bytes, const std::string& name = "model.gltf") {
  const TemporaryDirectory directory;
  write_file(directory.file(name), bytes);
  return load_gltf_model(directory.file(name));
}

inline Model load(const Gltf& gltf) { return load(gltf.text()); }

/// What is wrong with it, without the file's name.
inline std::string complaint(const std::string& bytes) {
  const TemporaryDirectory directory;
  const std::string file = directory.file("model.gltf");
  write_file(file, bytes);
  const std::string said = scene_error_of([&] { load_gltf_model(file); });
  return said.starts_with(file + ": ") ? said.substr(file.size() + 2) : "unnamed: " + said;
}

inline bool lacks_gltf() {
  if (complaint(triangle().text() + "x").find("was built without glTF") == std::string::npos) {
    return false;
  }
  skip("glTF", "built without tinygltf");
  return true;
}

inline bool warns(const Model& model, const std::string& of) {
  return std::any_of(model.warnings.begin(), model.warnings.end(),
                     [&](const std::string& line) { return line.find(of) != std::string::npos; });
}

inline std::vector<glm::vec3> corners(const Model& model, std::size_t part = 0) {
  const Mesh& mesh = model.parts.at(part).mesh;
  std::vector<glm::vec3> made;
  for (const std::uint32_t index : mesh.indices) made.push_back(mesh.positions.at(index));
  return made;
}

using Corners = std::vector<glm::vec3>;

inline std::string material(const std::string& text) { return ",\"materials\":[{" + text + "}]"; }

}  // namespace softfocus::test
