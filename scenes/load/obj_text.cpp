#include "scenes/load/obj_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "scenes/files/decimal.h"
#include "scenes/files/scene_error.h"

namespace softfocus {
namespace {

constexpr std::string_view kBlanks = " \t";

// The line that is being read.
struct Place {
  const std::string& file;
  std::size_t line = 0;
};

[[noreturn]] void fail(const Place& place, const std::string& reason) {
  throw SceneError(place.file + ":" + std::to_string(place.line) + ": " + reason);
}

// Takes the next word off the line; empty at its end.
std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

[[noreturn]] void fail_as_number(const Place& place, std::string_view word, int read, int needed) {
  fail(place, word.empty() ? "has " + std::to_string(read) + " numbers; " + std::to_string(needed) +
                                 " would be right"
                           : "\"" + std::string(word.substr(0, 40)) + "\" is no number");
}

// Takes a position off a v line.
glm::vec3 read_position(const Place& place, std::string_view& line, glm::dvec3 origin) {
  glm::vec3 position{0.0f};
  for (int i = 0; i < 3; ++i) {
    const std::string_view word = next_word(line);
    const auto number = decimal_to_float(word);
    if (!number) fail_as_number(place, word, i, 3);
    if (!(std::fabs(*number) <= kLargestCoordinate)) {
      fail(place, std::string(word.substr(0, 40)) +
                      " is out of range; a number from -1e9 to 1e9 would be right");
    }
    position[i] =
        origin[i] == 0.0 ? *number : static_cast<float>(*decimal_to_double(word) - origin[i]);
  }
  return position;
}

// What follows a position: r g b, and perhaps more. A fourth number alone is a weight.
std::optional<glm::vec3> read_colour(std::string_view line) {
  glm::vec3 colour{0.0f};
  for (int i = 0; i < 3; ++i) {
    const auto number = decimal_to_float(next_word(line));
    if (!number || !(*number >= 0.0f && *number <= 255.0f)) return std::nullopt;
    colour[i] = *number;
  }
  return colour;
}

// One of length 0, which counts as none, if it is none.
std::optional<glm::vec3> read_normal(std::string_view line) {
  glm::vec3 normal{0.0f};
  for (int i = 0; i < 3; ++i) {
    const auto number = decimal_to_float(next_word(line));
    if (!number || !(std::fabs(*number) <= kLargestCoordinate)) return std::nullopt;
    normal[i] = *number;
  }
  return normal;
}

// One index of a corner such as 7/-1/3; `count` is how many there are so far, from
// which a negative one counts back.
std::int32_t read_index(const Place& place, std::string_view text, std::size_t count,
                        const char* what) {
  std::int32_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (end != text.data() + text.size() || error != std::errc{} || index == 0) {
    fail(place, "\"" + std::string(text.substr(0, 40)) + "\" is no index of a " + what +
                    "; a whole number from 1, or from -1 backwards, would be right");
  }
  if (index > 0) return index - 1;
  const std::int64_t from_end = static_cast<std::int64_t>(count) + index;
  if (from_end < 0) {
    fail(place, std::to_string(index) + " goes back before the first " + what + "; there are " +
                    std::to_string(count) + " so far");
  }
  return static_cast<std::int32_t>(from_end);
}

ObjCorner read_corner(const Place& place, std::string_view word, const ObjText& obj) {
  ObjCorner corner;
  const std::size_t first = word.find('/');
  corner.position = read_index(place, word.substr(0, first), obj.positions.size(), "position");
  if (first == std::string_view::npos) return corner;
  const std::size_t second = word.find('/', first + 1);
  const std::string_view uv = word.substr(first + 1, second - first - 1);
  if (!uv.empty()) corner.uv = read_index(place, uv, obj.uvs.size(), "texture coordinate");
  if (second == std::string_view::npos) return corner;
  const std::string_view normal = word.substr(second + 1);
  if (!normal.empty()) corner.normal = read_index(place, normal, obj.normals.size(), "normal");
  return corner;
}

// A kind of thing that is tolerated, and the line of the first.
struct Tolerated {
  std::size_t count = 0;
  std::size_t first_line = 0;
};

void tolerate(Tolerated& kind, const Place& place) {
  if (kind.count++ == 0) kind.first_line = place.line;
}

void warn(ObjText& obj, const Place& place, const Tolerated& kind, const char* one,
          const char* many) {
  if (kind.count == 0) return;
  obj.warnings.push_back(
      place.file + ":" + std::to_string(kind.first_line) + ": " +
      (kind.count == 1 ? one : std::to_string(kind.count) + many + ", the first in this line"));
}

// u, and v where it is there.
glm::vec2 read_uv(const Place& place, std::string_view line, Tolerated& out_of_range) {
  glm::vec2 uv{0.0f};
  for (int i = 0; i < 2; ++i) {
    const std::string_view word = next_word(line);
    if (word.empty() && i > 0) break;
    const auto number = decimal_to_float(word);
    if (!number || !(std::fabs(*number) <= kLargestCoordinate)) {
      tolerate(out_of_range, place);
      return glm::vec2{0.0f};
    }
    uv[i] = *number;
  }
  return uv;
}

void check_index(const Place& place, std::int32_t index, std::size_t count, const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) < count) return;
  fail(place, "the face refers to " + std::string(what) + " " + std::to_string(index + 1) +
                  "; the file has " + std::to_string(count));
}

// State that usemtl and s have set for the faces that follow.
struct FaceState {
  std::int32_t material = -1;
  std::uint32_t smoothing_group = 0;
};

// Takes the next line off the text, with the lines that continue it.
std::string_view next_line(std::string_view& text, std::string& joined, std::size_t& line_count) {
  joined.clear();
  for (;;) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    std::string_view line = text.substr(0, end);
    const std::size_t ending = text.substr(end).starts_with("\r\n") ? 2 : 1;
    text.remove_prefix(std::min(end + ending, text.size()));
    ++line_count;
    const std::size_t last = line.find_last_not_of(kBlanks);
    const bool continues = last != line.npos && line[last] == '\\';
    if (continues) line = line.substr(0, last);
    if (!continues && joined.empty()) return line;
    joined.append(line).append(" ");
    if (!continues || text.empty()) return joined;
  }
}

}  // namespace

ObjText parse_obj_text(std::string_view text, const std::string& file, glm::dvec3 origin) {
  Place place{file};
  if (text.find('\0') != std::string_view::npos) {
    throw SceneError(file + ": is binary; an OBJ model is text");
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
  ObjText obj;
  FaceState state;
  std::vector<std::size_t> face_lines;
  Tolerated short_faces, wild_uvs, missing_uvs, wild_normals, bright_colours;
  std::unordered_map<std::string, std::int32_t> number_of_material;
  std::unordered_set<std::string> known_libraries;
  std::string joined;
  std::size_t lines_read = 0;
  while (!text.empty()) {
    place.line = lines_read + 1;
    std::string_view line = next_line(text, joined, lines_read);
    const std::string_view keyword = next_word(line);
    if (keyword == "v") {
      obj.positions.push_back(read_position(place, line, origin));
      const auto colour = read_colour(line);
      if (!colour && obj.colours.empty()) continue;
      obj.colours.resize(obj.positions.size() - 1, glm::vec3{1.0f});
      obj.colours.push_back(colour.value_or(glm::vec3{1.0f}));
      const glm::vec3& last = obj.colours.back();
      if (std::max({last.x, last.y, last.z}) > 1.0f) tolerate(bright_colours, place);
    } else if (keyword == "vt") {
      obj.uvs.push_back(read_uv(place, line, wild_uvs));
    } else if (keyword == "vn") {
      const auto normal = read_normal(line);
      if (!normal) tolerate(wild_normals, place);
      obj.normals.push_back(normal.value_or(glm::vec3{0.0f}));
    } else if (keyword == "f") {
      ObjFace face{static_cast<std::uint32_t>(obj.corners.size()), 0, state.material,
                   state.smoothing_group};
      for (auto word = next_word(line); !word.empty() && word[0] != '#'; word = next_word(line)) {
        if (face.corner_count++ == kMaxFaceCorners) {
          fail(place, "the face has more than " + std::to_string(kMaxFaceCorners) +
                          " corners; smaller faces would do");
        }
        obj.corners.push_back(read_corner(place, word, obj));
      }
      if (face.corner_count < 3) {
        tolerate(short_faces, place);
        obj.corners.resize(face.first_corner);
        continue;
      }
      obj.faces.push_back(face);
      face_lines.push_back(place.line);
    } else if (keyword == "usemtl") {
      const std::string name{trimmed(line)};
      const auto [entry, is_new] =
          number_of_material.emplace(name, static_cast<std::int32_t>(obj.material_names.size()));
      if (is_new) obj.material_names.push_back(name);
      state.material = entry->second;
    } else if (keyword == "mtllib") {
      const std::string library{trimmed(line)};
      if (known_libraries.insert(library).second) obj.libraries.push_back(library);
    } else if (keyword == "s") {
      const std::string_view group = next_word(line);
      state.smoothing_group = 0;  // for `off` too
      std::from_chars(group.data(), group.data() + group.size(), state.smoothing_group);
      obj.has_smoothing_groups = true;
    }
  }

  // At the end only: files exist in which faces come before their vertices.
  for (std::size_t i = 0; i < obj.faces.size(); ++i) {
    place.line = face_lines[i];
    for (std::uint32_t k = 0; k < obj.faces[i].corner_count; ++k) {
      ObjCorner& corner = obj.corners[obj.faces[i].first_corner + k];
      check_index(place, corner.position, obj.positions.size(), "position");
      if (corner.uv >= 0 && static_cast<std::size_t>(corner.uv) >= obj.uvs.size()) {
        tolerate(missing_uvs, place);
        corner.uv = -1;
      }
      check_index(place, corner.normal, obj.normals.size(), "normal");
    }
  }
  if (obj.faces.empty() && short_faces.count > 0) {
    place.line = short_faces.first_line;
    fail(place,
         "the face has fewer than 3 corners, as all have; a face of 3 or more would be right");
  }
  if (obj.faces.empty()) {
    throw SceneError(file + ": has no face; an OBJ model with `v` and `f` lines would be right");
  }
  warn(obj, place, short_faces, "a face has fewer than 3 corners and is left out",
       " faces have fewer than 3 corners and are left out");
  warn(obj, place, wild_uvs, "a texture coordinate is out of range; 0 stands in",
       " texture coordinates are out of range; 0 stands in");
  warn(obj, place, wild_normals, "a normal is no direction and is left out",
       " normals are no directions and are left out");
  if (bright_colours.count > 0) {
    for (glm::vec3& colour : obj.colours) colour /= 255.0f;
    warn(obj, place, bright_colours, "a colour is beyond 1: colours are taken for 0 to 255",
         " colours are beyond 1: they are taken for 0 to 255");
  }
  warn(obj, place, missing_uvs, "a corner's texture coordinate is not there; it gets none",
       " corners' texture coordinates are not there; they get none");
  return obj;
}

}  // namespace softfocus
