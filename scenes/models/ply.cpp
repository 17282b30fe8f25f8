#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "raster/numbers/srgb.h"
#include "scenes/files/decimal.h"
#include "scenes/files/scene_error.h"
#include "scenes/models/model.h"
#include "scenes/models/ply_stl.h"

namespace softfocus {
namespace {

enum class PlyKind : std::uint8_t { whole, unsigned_whole, real };

struct PlyType {
  std::string_view name, also;
  std::size_t bytes;
  PlyKind kind;
};

constexpr std::array<PlyType, 8> kTypes{{
    {"char", "int8", 1, PlyKind::whole},
    {"uchar", "uint8", 1, PlyKind::unsigned_whole},
    {"short", "int16", 2, PlyKind::whole},
    {"ushort", "uint16", 2, PlyKind::unsigned_whole},
    {"int", "int32", 4, PlyKind::whole},
    {"uint", "uint32", 4, PlyKind::unsigned_whole},
    {"float", "float32", 4, PlyKind::real},
    {"double", "float64", 8, PlyKind::real},
}};

struct Property {
  std::string name;
  const PlyType* type;
  const PlyType* count_type;  // of a list; else null
};

struct Element {
  std::string name;
  std::size_t count;
  std::vector<Property> properties{};
};

enum class Form : std::uint8_t { text, little_endian, big_endian };

struct Reader {
  std::string_view rest;
  const std::string& file;
  std::size_t line = 1;  // of text
  Form form = Form::text;
  std::string what{};  // is being read: "vertex 3"
  bool has_a_line_a_row = false;

  [[noreturn]] void fail(const std::string& reason) const {
    const std::string where = form == Form::text ? ":" + std::to_string(line) : "";
    throw SceneError(file + where + ": " + (what.empty() ? "" : what + " ") + reason);
  }

  std::string_view word() {
    std::size_t at = 0;
    for (; at < rest.size() && static_cast<unsigned char>(rest[at]) <= ' '; ++at) {
      if (rest[at] == '\n') ++line;
    }
    rest.remove_prefix(at);
    at = 0;
    while (at < rest.size() && static_cast<unsigned char>(rest[at]) > ' ') ++at;
    const std::string_view found = rest.substr(0, at);
    rest.remove_prefix(at);
    if (found.empty()) fail("is missing: the file is cut off");
    return found;
  }

  // After a row. Some exporters write more behind it than the header says.
  void end_row() {
    if (has_a_line_a_row) rest.remove_prefix(std::min(rest.find_first_of("\r\n"), rest.size()));
  }

  double number(const PlyType& type) {
    if (form == Form::text) {
      const std::string_view text = word();
      // A float is rounded once; whole numbers are below 2^53.
      std::optional<double> read;
      if (type.bytes == 4 && type.kind == PlyKind::real) {
        if (const auto single = decimal_to_float(text)) read = *single;
      } else {
        read = decimal_to_double(text);
      }
      if (!read) fail("has \"" + std::string{text.substr(0, 40)} + "\", which is no number");
      return *read;
    }
    if (rest.size() < type.bytes) fail("is missing: the file is cut off");
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < type.bytes; ++i) {
      const std::size_t at = form == Form::little_endian ? type.bytes - 1 - i : i;
      bits = bits << 8 | static_cast<unsigned char>(rest[at]);
    }
    rest.remove_prefix(type.bytes);
    if (type.kind == PlyKind::real) {
      return type.bytes == 8 ? std::bit_cast<double>(bits)
                             : std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    }
    if (type.kind == PlyKind::unsigned_whole) return static_cast<double>(bits);
    if (type.bytes == 1) return static_cast<std::int8_t>(bits);
    if (type.bytes == 2) return static_cast<std::int16_t>(bits);
    return static_cast<std::int32_t>(bits);
  }
};

const PlyType& type_named(const Reader& reader, std::string_view name) {
  for (const PlyType& type : kTypes) {
    if (name == type.name || name == type.also) return type;
  }
  reader.fail(
      "\"" + std::string{name.substr(0, 40)} +
      "\" is no type; char, uchar, short, ushort, int, uint, float or double would be right");
}

struct Header {
  std::vector<Element> elements{};
  std::string texture{};
  std::size_t textures = 0;
};

void read_property(const Reader& reader, std::string_view line, Header& header) {
  if (header.elements.empty()) reader.fail("a property before the first element");
  Property property{};
  std::string_view type = next_word(line);
  if (type == "list") {
    property.count_type = &type_named(reader, next_word(line));
    if (property.count_type->kind == PlyKind::real)
      reader.fail("a list's length is no whole number");
    type = next_word(line);
  }
  property.type = &type_named(reader, type);
  property.name = next_word(line);
  header.elements.back().properties.push_back(property);
}

void read_format(Reader& reader, Form& form, std::string_view line) {
  const std::string_view name = next_word(line);
  if (name == "ascii") {
    form = Form::text;
  } else if (name == "binary_little_endian") {
    form = Form::little_endian;
  } else if (name == "binary_big_endian") {
    form = Form::big_endian;
  } else {
    reader.fail("\"" + std::string{name.substr(0, 40)} +
                "\" is no format; ascii, binary_little_endian or binary_big_endian would be right");
  }
}

Header read_header(Reader& reader) {
  Header header;
  Form form = Form::text;
  bool has_format = false;
  const std::size_t end = reader.rest.find_first_of("\r\n");
  if (end == reader.rest.npos || trimmed(reader.rest.substr(0, end)) != "ply") {
    reader.fail("is no PLY: the first line is not \"ply\"");
  }
  // Lines end with a newline, perhaps after a return, or with returns alone.
  const bool has_returns = reader.rest[end] == '\r' && reader.rest.substr(end, 2) != "\r\n";
  const char line_end = has_returns ? '\r' : '\n';
  for (;;) {
    const std::size_t length = reader.rest.find(line_end);
    if (length == reader.rest.npos) reader.fail("the header has no end; end_header is missing");
    std::string_view line = reader.rest.substr(0, length);
    reader.rest.remove_prefix(length + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::string_view keyword = next_word(line);
    if (keyword == "end_header") break;
    if (keyword == "format") {
      read_format(reader, form, line);
      has_format = true;
    } else if (keyword == "element") {
      const std::string_view name = next_word(line);
      const std::string_view written = next_word(line);
      std::size_t count = 0;
      const auto [at, error] =
          std::from_chars(written.data(), written.data() + written.size(), count);
      if (error != std::errc{} || at != written.data() + written.size()) {
        reader.fail("an element's count is no whole number");
      }
      header.elements.push_back({std::string{name}, count});
    } else if (keyword == "property") {
      read_property(reader, line, header);
    } else if (keyword == "comment" && next_word(line) == "TextureFile") {
      if (header.texture.empty()) header.texture = trimmed(line);
      ++header.textures;
    }
    ++reader.line;
  }
  if (!has_format) reader.fail("the header has no format");
  ++reader.line;
  reader.form = form;
  std::size_t rows = 0;
  for (const Element& element : header.elements) {
    if (!element.properties.empty()) rows = std::max(rows, rows + element.count);
  }
  const auto lines =
      static_cast<std::size_t>(std::count(reader.rest.begin(), reader.rest.end(), line_end));
  reader.has_a_line_a_row = form == Form::text && lines + 1 >= rows;
  return header;
}

// What a vertex's properties mean, by any of their names.
enum Slot {
  slot_x,
  slot_y,
  slot_z,
  slot_nx,
  slot_ny,
  slot_nz,
  slot_red,
  slot_green,
  slot_blue,
  slot_u,
  slot_v,
  slot_count
};

std::optional<Slot> slot_named(std::string_view name) {
  for (const std::string_view prefix : {"diffuse_", "texture_"}) {
    if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
  }
  static const std::map<std::string_view, Slot> names{
      {"x", slot_x},     {"y", slot_y},         {"z", slot_z},       {"nx", slot_nx},
      {"ny", slot_ny},   {"nz", slot_nz},       {"red", slot_red},   {"r", slot_red},
      {"g", slot_green}, {"green", slot_green}, {"blue", slot_blue}, {"b", slot_blue},
      {"s", slot_u},     {"u", slot_u},         {"t", slot_v},       {"v", slot_v}};
  const auto found = names.find(name);
  if (found == names.end()) return std::nullopt;
  return found->second;
}

struct Growing {
  ObjText obj{};
  std::vector<glm::dvec3> positions{};
  std::vector<glm::vec2> uvs{};     // of vertices
  bool have_whole_colours = false;  // as stored, in obj
  std::size_t short_faces = 0, wild_uvs = 0;
};

// Colours as they are stored become light. Whole numbers are codes along the sRGB curve, up to 255
// unless there are larger ones; floats are light, 0 to 1 if not far beyond.
void finish_colours(const std::string& file, Growing& made) {
  ObjText& obj = made.obj;
  float most = 0.0f;
  for (const glm::vec3& colour : obj.colours) {
    for (int k = 0; k < 3; ++k) {
      if (colour[k] <= kLargestCoordinate) most = std::max(most, colour[k]);
    }
  }
  constexpr float kFarBeyond = 2.0f, kByte = 255.0f, kShort = 65535.0f;
  const bool are_bytes = made.have_whole_colours || most >= kFarBeyond;
  const bool are_shorts = made.have_whole_colours && most > kByte;
  const float one = !are_bytes ? 1.0f : are_shorts ? kShort : kByte;
  if (are_bytes && !made.have_whole_colours) {
    obj.warnings.push_back(file + ": colours beyond 1: they are taken for 0 to 255");
  }
  for (glm::vec3& colour : obj.colours) {
    for (int k = 0; k < 3; ++k) {
      const float share = colour[k] > 0.0f ? std::min(colour[k] / one, 1.0f) : 0.0f;
      const auto code = static_cast<std::uint8_t>(share * kByte + 0.5f);
      colour[k] = made.have_whole_colours ? srgb8_to_linear(code) : share;
    }
  }
}

// The numbers of a list, or past them.
void read_list(Reader& reader, const Property& property, std::vector<double>* list) {
  if (list != nullptr) list->clear();
  const double count = reader.number(*property.count_type);
  for (std::uint64_t left = count > 0.0 ? static_cast<std::uint64_t>(std::min(count, 0x1p32)) : 0;
       left > 0; --left) {
    const double number = reader.number(*property.type);
    if (list != nullptr) list->push_back(number);
  }
}

void read_vertices(Reader& reader, const Element& element, Growing& made) {
  std::vector<std::optional<Slot>> slots;
  std::array<bool, slot_count> has{};
  for (const Property& property : element.properties) {
    std::optional<Slot> slot = property.count_type ? std::nullopt : slot_named(property.name);
    if (slot && has[*slot]) slot.reset();
    if (slot) has[*slot] = true;
    slots.push_back(slot);
  }
  const auto has_all = [&](Slot first, int count) {
    return std::all_of(has.begin() + first, has.begin() + first + count,
                       [](bool is) { return is; });
  };
  if (!has_all(slot_x, 3)) throw SceneError(reader.file + ": the vertices have no x, y and z");
  ObjText& obj = made.obj;
  for (std::size_t i = 0; i < element.count; ++i) {
    reader.what = "vertex " + std::to_string(i);
    std::array<double, slot_count> values{};
    for (std::size_t k = 0; k < slots.size(); ++k) {
      const Property& property = element.properties[k];
      if (property.count_type != nullptr) {
        read_list(reader, property, nullptr);
        continue;
      }
      const double value = reader.number(*property.type);
      if (!slots[k]) continue;
      values[*slots[k]] = value;
      if (*slots[k] == slot_red) made.have_whole_colours = property.type->kind != PlyKind::real;
    }
    reader.end_row();
    const auto vector = [&](Slot first) {
      return glm::dvec3{values[first], values[first + 1], values[first + 2]};
    };
    made.positions.push_back(vector(slot_x));
    if (has_all(slot_nx, 3)) {
      const glm::dvec3 n = vector(slot_nx);
      const double square = n.x * n.x + n.y * n.y + n.z * n.z;
      obj.normals.emplace_back(square > 0.0 && square < 1e30 ? n : glm::dvec3{0.0});
    }
    if (has_all(slot_red, 3)) {
      obj.colours.emplace_back(vector(slot_red));
    }
    if (has_all(slot_u, 2)) {
      const bool is_number = std::fabs(values[slot_u]) <= kLargestCoordinate &&
                             std::fabs(values[slot_v]) <= kLargestCoordinate;
      made.wild_uvs += is_number ? 0 : 1;
      made.uvs.emplace_back(is_number ? static_cast<float>(values[slot_u]) : 0.0f,
                            is_number ? static_cast<float>(values[slot_v]) : 0.0f);
    }
  }
}

std::int32_t index_of(const Reader& reader, double index) {
  // That there are so many vertices is not known yet.
  if (!(index >= 0.0 && index < 0x1p31 && index == std::floor(index))) {
    reader.fail("has an index that is none");
  }
  return static_cast<std::int32_t>(index);
}

// `uvs`: of each corner, or none.
void add_face(const Reader& reader, const std::vector<double>& indices,
              const std::vector<double>& uvs, Growing& made) {
  if (indices.size() < 3) {
    ++made.short_faces;
    return;
  }
  if (indices.size() > kMaxFaceCorners) {
    reader.fail("has " + std::to_string(indices.size()) + " corners; up to " +
                std::to_string(kMaxFaceCorners) + " would be right");
  }
  ObjText& obj = made.obj;
  constexpr std::size_t kMostCorners = std::size_t{3} << 26;
  if (obj.corners.size() + indices.size() > kMostCorners) reader.fail("is one face too many");
  obj.faces.push_back({static_cast<std::uint32_t>(obj.corners.size()),
                       static_cast<std::uint32_t>(indices.size()),
                       obj.material_names.empty() ? -1 : 0});
  for (std::size_t i = 0; i < indices.size(); ++i) {
    ObjCorner corner{index_of(reader, indices[i])};
    if (uvs.size() == 2 * indices.size()) {
      glm::vec2 uv{static_cast<float>(uvs[2 * i]), static_cast<float>(uvs[2 * i + 1])};
      if (!(std::fabs(uv.x) <= kLargestCoordinate && std::fabs(uv.y) <= kLargestCoordinate)) {
        ++made.wild_uvs;
        uv = glm::vec2{0.0f};
      }
      corner.uv = static_cast<std::int32_t>(obj.uvs.size());
      obj.uvs.push_back(uv);
    }
    obj.corners.push_back(corner);
  }
}

void add_strips(const Reader& reader, const std::vector<double>& indices, Growing& made) {
  std::size_t first = 0;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] < 0.0) {
      first = i + 1;
    } else if (i >= first + 2) {
      const std::size_t odd = (i - first) % 2;
      add_face(reader, {indices[i - 2 + odd], indices[i - 1 - odd], indices[i]}, {}, made);
    }
  }
}

void read_faces(Reader& reader, const Element& element, bool are_strips, Growing& made) {
  std::vector<double> indices, uvs;
  for (std::size_t i = 0; i < element.count; ++i) {
    reader.what = element.name + " " + std::to_string(i);
    indices.clear();
    uvs.clear();
    for (const Property& property : element.properties) {
      if (property.count_type == nullptr) {
        reader.number(*property.type);
      } else if (property.name == "vertex_indices" || property.name == "vertex_index") {
        read_list(reader, property, &indices);
      } else {
        read_list(reader, property, property.name == "texcoord" ? &uvs : nullptr);
      }
    }
    reader.end_row();
    if (are_strips) {
      add_strips(reader, indices, made);
    } else {
      add_face(reader, indices, uvs, made);
    }
  }
}

void pass_over(Reader& reader, const Element& element) {
  for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
    reader.what = element.name + " " + std::to_string(i);
    for (const Property& property : element.properties) {
      if (property.count_type != nullptr) {
        read_list(reader, property, nullptr);
      } else {
        reader.number(*property.type);
      }
    }
    reader.end_row();
  }
}

}  // namespace

FileFaces parse_ply(std::string_view bytes, const std::string& file) {
  Reader reader{bytes, file};
  FileFaces result;
  const Header header = read_header(reader);
  result.texture = header.texture;
  Growing made;
  ObjText& obj = made.obj;
  if (!header.texture.empty()) obj.material_names.push_back(header.texture);
  for (const Element& element : header.elements) {
    if (element.name == "vertex") {
      if (!made.positions.empty()) reader.fail("vertices for the second time");
      if (element.count > 0) read_vertices(reader, element, made);
    } else if (element.name == "face" || element.name == "tristrips") {
      if (!element.properties.empty()) {
        read_faces(reader, element, element.name == "tristrips", made);
      }
    } else {
      pass_over(reader, element);
    }
  }
  const auto has_corners = [](const Property& property) {
    return property.count_type != nullptr &&
           (property.name == "vertex_indices" || property.name == "vertex_index");
  };
  for (const Element& element : header.elements) {
    if (element.name == "face" && element.count > 0 &&
        std::none_of(element.properties.begin(), element.properties.end(), has_corners)) {
      throw SceneError(file + ": its faces have no list vertex_indices");
    }
  }
  if (obj.faces.empty()) {
    throw SceneError(file + ": has no faces; points alone cannot be drawn, a mesh would be right");
  }
  // A vertex's normal and coordinates have its number, coordinates behind those of faces.
  const bool has_normals = !obj.normals.empty(), has_uvs = !made.uvs.empty();
  const auto first_uv = static_cast<std::int32_t>(obj.uvs.size());
  obj.uvs.insert(obj.uvs.end(), made.uvs.begin(), made.uvs.end());
  for (ObjCorner& corner : obj.corners) {
    const auto number = static_cast<std::size_t>(corner.position);
    if (number >= made.positions.size() || !is_position(made.positions[number])) {
      throw SceneError(file + ": a face has vertex " + std::to_string(number) +
                       (number < made.positions.size()
                            ? ", whose place is no number, or beyond 1e9"
                            : " of " + std::to_string(made.positions.size())));
    }
    if (has_normals) corner.normal = corner.position;
    if (has_uvs && corner.uv < 0) corner.uv = first_uv + corner.position;
  }
  // Depth cameras leave vertices without a place, which no face has.
  for (glm::dvec3& p : made.positions) {
    if (!is_position(p)) p = glm::dvec3{0.0};
  }
  const auto warn = [&](std::size_t count, const char* what) {
    if (count > 0) obj.warnings.push_back(file + ": " + std::to_string(count) + " " + what);
  };
  warn(made.short_faces, "faces of fewer than three corners are left out");
  warn(header.textures > 1 ? header.textures - 1 : 0, "textures behind the first are left out");
  warn(made.wild_uvs, "texture coordinates are out of range, or none, and 0");
  finish_colours(file, made);
  result.faces = std::move(obj);
  place_positions(made.positions, result);
  return result;
}

}  // namespace softfocus
