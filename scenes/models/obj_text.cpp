#include "scenes/models/obj_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <exception>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "scenes/files/decimal.h"
#include "scenes/files/scene_error.h"
#include "scenes/models/model.h"

namespace softfocus {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

}  // namespace

std::string_view next_word(std::string_view& line) {
  std::size_t start = 0;
  while (start < line.size() && is_blank(line[start])) ++start;
  std::size_t end = start;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view word{line.data() + start, end - start};
  line.remove_prefix(end);
  return word;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

namespace {

// The line that is being read.
struct Place {
  const std::string& file;
  std::size_t lines_before = 0;  // of its piece
  std::size_t line = 0;          // of its piece, from 1
};

[[noreturn]] void fail(const Place& place, const std::string& reason) {
  throw SceneError(place.file + ":" + std::to_string(place.lines_before + place.line) + ": " +
                   reason);
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
  if (line.empty()) return std::nullopt;
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

// What a piece of the text has, or what lies before it.
struct Counts {
  std::size_t lines = 0, positions = 0, uvs = 0, normals = 0;
};

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

// Most corners: whole numbers from 1, of at most nine digits. False for any other.
bool read_plain_corner(std::string_view word, ObjCorner& corner) {
  std::size_t at = 0;
  for (std::int32_t* index : {&corner.position, &corner.uv, &corner.normal}) {
    std::int32_t number = 0;
    const std::size_t begin = at;
    for (; at < word.size() && word[at] >= '0' && word[at] <= '9' && at < begin + 9; ++at) {
      number = 10 * number + (word[at] - '0');
    }
    if (number > 0) *index = number - 1;
    const bool is_left_out = index == &corner.uv && at == begin && at < word.size();
    if (number == 0 && !is_left_out) return false;
    if (at == word.size()) return true;
    if (word[at++] != '/') return false;
  }
  return false;
}

ObjCorner read_corner(const Place& place, std::string_view word, const Counts& so_far) {
  ObjCorner corner;
  if (read_plain_corner(word, corner)) return corner;
  corner = {};
  const std::size_t first = word.find('/');
  corner.position = read_index(place, word.substr(0, first), so_far.positions, "position");
  if (first == std::string_view::npos) return corner;
  const std::size_t second = word.find('/', first + 1);
  const std::string_view uv = word.substr(first + 1, second - first - 1);
  if (!uv.empty()) corner.uv = read_index(place, uv, so_far.uvs, "texture coordinate");
  if (second == std::string_view::npos) return corner;
  const std::string_view normal = word.substr(second + 1);
  if (!normal.empty()) corner.normal = read_index(place, normal, so_far.normals, "normal");
  return corner;
}

// A kind of thing that is tolerated, and the line of the first, as Place has it.
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

// Reads a text line by line.
class LineReader {
 public:
  explicit LineReader(std::string_view text)
      : text_(text), has_returns_(text.find('\r') != text.npos) {}

  bool has_more() const { return start_ < text_.size(); }
  /// The lines that were read, those that continue another as well.
  std::size_t count() const { return count_; }

  /// The next line, with the lines that continue it.
  std::string_view next() {
    joined_.clear();
    for (;;) {
      std::string_view line = next_alone();
      std::size_t end = line.size();
      while (end > 0 && is_blank(line[end - 1])) --end;
      const bool continues = end > 0 && line[end - 1] == '\\';
      if (continues) line = line.substr(0, end - 1);
      if (!continues && joined_.empty()) return line;
      joined_.append(line).append(" ");
      if (!continues || !has_more()) return joined_;
    }
  }

 private:
  std::string_view next_alone() {
    if (newline_ <= start_) newline_ = std::min(text_.find('\n', start_), text_.size());
    std::size_t end = newline_;
    if (has_returns_) end = std::min(text_.substr(0, newline_).find('\r', start_), newline_);
    const std::string_view line = text_.substr(start_, end - start_);
    start_ = std::min(end + (text_.substr(end).starts_with("\r\n") ? 2 : 1), text_.size());
    ++count_;
    return line;
  }

  std::string_view text_;
  bool has_returns_;
  std::size_t start_ = 0;
  std::size_t newline_ = 0;  // the next, if it lies beyond `start_`
  std::size_t count_ = 0;
  std::string joined_;
};

Counts count_lines(std::string_view text) {
  Counts counts;
  LineReader reader{text};
  while (reader.has_more()) {
    std::string_view line = reader.next();
    const std::string_view keyword = next_word(line);
    counts.positions += keyword == "v" ? 1 : 0;
    counts.uvs += keyword == "vt" ? 1 : 0;
    counts.normals += keyword == "vn" ? 1 : 0;
  }
  counts.lines = reader.count();
  return counts;
}

// A piece of the text, read alone. The faces before its first `usemtl` have the material of the
// piece before, the faces before its first `s` the smoothing group.
struct Piece {
  std::string_view text;
  bool is_counted = false;  // what lies `before`, as it is read
  Counts before;
  std::size_t lines = 0;
  ObjText obj;
  std::vector<std::size_t> face_lines;
  std::optional<std::size_t> faces_before_material, faces_before_group;
  std::int32_t last_material = -1;
  std::uint32_t last_group = 0;
  Tolerated short_faces, wild_uvs, wild_normals, bright_colours, missing_uvs;
  std::exception_ptr error;
};

// Cuts a text where a line begins that continues no other.
std::vector<Piece> cut_into_pieces(std::string_view text) {
  constexpr std::size_t kPieceBytes = std::size_t{1} << 20;
  std::vector<Piece> pieces;
  while (!text.empty()) {
    std::size_t end = text.find('\n', std::min(kPieceBytes, text.size()));
    const auto is_continued = [&] {
      std::size_t last = end;
      while (last > 0 && (is_blank(text[last - 1]) || text[last - 1] == '\r')) --last;
      return last > 0 && text[last - 1] == '\\';
    };
    while (end != text.npos && is_continued()) end = text.find('\n', end + 1);
    const std::size_t size = end == text.npos ? text.size() : end + 1;
    pieces.emplace_back().text = text.substr(0, size);
    text.remove_prefix(size);
  }
  return pieces;
}

void read_piece(Piece& piece, Place place, glm::dvec3 origin) {
  ObjText& obj = piece.obj;
  place.lines_before = piece.before.lines;
  FaceState state;
  std::unordered_map<std::string, std::int32_t> number_of_material;
  LineReader reader{piece.text};
  while (reader.has_more()) {
    place.line = reader.count() + 1;
    std::string_view line = reader.next();
    const std::string_view keyword = next_word(line);
    if (keyword == "v") {
      obj.positions.push_back(read_position(place, line, origin));
      const auto colour = read_colour(line);
      if (!colour && obj.colours.empty()) continue;
      obj.colours.resize(obj.positions.size() - 1, glm::vec3{1.0f});
      obj.colours.push_back(colour.value_or(glm::vec3{1.0f}));
      const glm::vec3& last = obj.colours.back();
      if (std::max({last.x, last.y, last.z}) > 1.0f) tolerate(piece.bright_colours, place);
    } else if (keyword == "vt") {
      obj.uvs.push_back(read_uv(place, line, piece.wild_uvs));
    } else if (keyword == "vn") {
      const auto normal = read_normal(line);
      if (!normal) tolerate(piece.wild_normals, place);
      obj.normals.push_back(normal.value_or(glm::vec3{0.0f}));
    } else if (keyword == "f") {
      // Until it is known, 0: an index that counts back is an error then (read_pieces()).
      const auto so_far = [&](std::size_t before, std::size_t here) {
        return piece.is_counted ? before + here : 0;
      };
      const Counts counts{0, so_far(piece.before.positions, obj.positions.size()),
                          so_far(piece.before.uvs, obj.uvs.size()),
                          so_far(piece.before.normals, obj.normals.size())};
      ObjFace face{static_cast<std::uint32_t>(obj.corners.size()), 0, state.material,
                   state.smoothing_group};
      for (auto word = next_word(line); !word.empty() && word[0] != '#'; word = next_word(line)) {
        if (face.corner_count++ == kMaxFaceCorners) {
          fail(place, "the face has more than " + std::to_string(kMaxFaceCorners) +
                          " corners; smaller faces would do");
        }
        obj.corners.push_back(read_corner(place, word, counts));
      }
      if (face.corner_count < 3) {
        tolerate(piece.short_faces, place);
        obj.corners.resize(face.first_corner);
        continue;
      }
      obj.faces.push_back(face);
      piece.face_lines.push_back(place.line);
    } else if (keyword == "usemtl") {
      if (!piece.faces_before_material) piece.faces_before_material = obj.faces.size();
      const std::string name{trimmed(line)};
      const auto [entry, is_new] =
          number_of_material.emplace(name, static_cast<std::int32_t>(obj.material_names.size()));
      if (is_new) obj.material_names.push_back(name);
      state.material = entry->second;
    } else if (keyword == "mtllib") {
      obj.libraries.emplace_back(trimmed(line));
    } else if (keyword == "s") {
      if (!piece.faces_before_group) piece.faces_before_group = obj.faces.size();
      const std::string_view group = next_word(line);
      state.smoothing_group = 0;  // for `off` too
      std::from_chars(group.data(), group.data() + group.size(), state.smoothing_group);
      obj.has_smoothing_groups = true;
    }
  }
  piece.last_material = state.material;
  piece.last_group = state.smoothing_group;
  piece.lines = reader.count();
}

// Counts of each piece as of what lies before it; returns those of all.
Counts set_before(const std::vector<Counts>& counts, std::vector<Piece>& pieces) {
  Counts all;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    pieces[i].before = all;
    all.lines += counts[i].lines;
    all.positions += counts[i].positions;
    all.uvs += counts[i].uvs;
    all.normals += counts[i].normals;
  }
  return all;
}

// Materials by numbers of the whole text, and what the pieces before say of the first faces.
void settle_states(std::vector<Piece>& pieces, ObjText& obj) {
  std::unordered_map<std::string, std::int32_t> number_of_material;
  std::unordered_set<std::string> known_libraries;
  FaceState state;
  for (Piece& piece : pieces) {
    std::vector<std::int32_t> numbers;
    for (const std::string& name : piece.obj.material_names) {
      const auto [entry, is_new] =
          number_of_material.emplace(name, static_cast<std::int32_t>(obj.material_names.size()));
      if (is_new) obj.material_names.push_back(name);
      numbers.push_back(entry->second);
    }
    const std::size_t face_count = piece.obj.faces.size();
    const std::size_t other_material = piece.faces_before_material.value_or(face_count);
    const std::size_t other_group = piece.faces_before_group.value_or(face_count);
    for (std::size_t i = 0; i < face_count; ++i) {
      ObjFace& face = piece.obj.faces[i];
      face.material =
          i < other_material ? state.material : numbers[static_cast<std::size_t>(face.material)];
      if (i < other_group) face.smoothing_group = state.smoothing_group;
    }
    if (piece.faces_before_material) {
      state.material = numbers[static_cast<std::size_t>(piece.last_material)];
    }
    if (piece.faces_before_group) state.smoothing_group = piece.last_group;
    for (std::string& library : piece.obj.libraries) {
      if (known_libraries.insert(library).second) obj.libraries.push_back(std::move(library));
    }
    obj.has_smoothing_groups = obj.has_smoothing_groups || piece.obj.has_smoothing_groups;
  }
}

template <class Value>
void put(const std::vector<Value>& from, std::vector<Value>& to, std::size_t first) {
  if (from.empty()) return;  // `to` may be, too
  std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(first));
}

// At the end only: files exist in which faces come before their vertices.
void check_faces(Piece& piece, Place place, const Counts& all) {
  place.lines_before = piece.before.lines;
  for (std::size_t i = 0; i < piece.obj.faces.size(); ++i) {
    place.line = piece.face_lines[i];
    const ObjFace& face = piece.obj.faces[i];
    for (std::uint32_t k = 0; k < face.corner_count; ++k) {
      ObjCorner& corner = piece.obj.corners[face.first_corner + k];
      check_index(place, corner.position, all.positions, "position");
      if (corner.uv >= 0 && static_cast<std::size_t>(corner.uv) >= all.uvs) {
        tolerate(piece.missing_uvs, place);
        corner.uv = -1;
      }
      check_index(place, corner.normal, all.normals, "normal");
    }
  }
}

// Joins what the pieces have, each at its place.
void join_pieces(std::vector<Piece>& pieces, const Counts& all, ObjText& obj, ThreadPool& pool) {
  std::vector<std::size_t> first_corners, first_faces;
  std::size_t corner_count = 0, face_count = 0;
  bool has_colours = false;
  for (const Piece& piece : pieces) {
    first_corners.push_back(corner_count);
    first_faces.push_back(face_count);
    corner_count += piece.obj.corners.size();
    face_count += piece.obj.faces.size();
    has_colours = has_colours || !piece.obj.colours.empty();
  }
  obj.positions.resize(all.positions);
  obj.uvs.resize(all.uvs);
  obj.normals.resize(all.normals);
  obj.corners.resize(corner_count);
  obj.faces.resize(face_count);
  if (has_colours) obj.colours.resize(all.positions, glm::vec3{1.0f});
  pool.for_each(static_cast<int>(pieces.size()), [&](int i) {
    const auto number = static_cast<std::size_t>(i);
    ObjText part = std::move(pieces[number].obj);
    const Counts& before = pieces[number].before;
    for (ObjFace& face : part.faces) {
      face.first_corner += static_cast<std::uint32_t>(first_corners[number]);
    }
    put(part.positions, obj.positions, before.positions);
    put(part.colours, obj.colours, before.positions);
    put(part.uvs, obj.uvs, before.uvs);
    put(part.normals, obj.normals, before.normals);
    put(part.corners, obj.corners, first_corners[number]);
    put(part.faces, obj.faces, first_faces[number]);
  });
}

Tolerated sum_of(const std::vector<Piece>& pieces, Tolerated Piece::*kind) {
  Tolerated sum;
  for (const Piece& piece : pieces) {
    const Tolerated& more = piece.*kind;
    if (sum.count == 0 && more.count > 0) sum.first_line = piece.before.lines + more.first_line;
    sum.count += more.count;
  }
  return sum;
}

// Does something with each piece, and throws the error of the first that has one.
template <class Work>
void for_each_piece(std::vector<Piece>& pieces, ThreadPool& pool, const Work& work) {
  pool.for_each(static_cast<int>(pieces.size()), [&](int i) {
    Piece& piece = pieces[static_cast<std::size_t>(i)];
    try {
      work(piece);
    } catch (...) {
      piece.error = std::current_exception();
    }
  });
  for (const Piece& piece : pieces) {
    if (piece.error) std::rethrow_exception(piece.error);
  }
}

// Reads all; returns what there is. Few files need what lies before a piece while it is read: for a
// message's line, and for indices that count back. After an error it is counted, and read again.
Counts read_pieces(std::vector<Piece>& pieces, const Place& place, glm::dvec3 origin,
                   ThreadPool& pool) {
  std::vector<Counts> counts;
  if (!pieces.empty()) pieces[0].is_counted = true;  // nothing lies before it
  try {
    for_each_piece(pieces, pool, [&](Piece& piece) { read_piece(piece, place, origin); });
    for (const Piece& piece : pieces) {
      counts.push_back({piece.lines, piece.obj.positions.size(), piece.obj.uvs.size(),
                        piece.obj.normals.size()});
    }
    return set_before(counts, pieces);
  } catch (const SceneError&) {
    if (pieces[0].error) throw;
  }
  counts.resize(pieces.size());
  pool.for_each(static_cast<int>(pieces.size()), [&](int i) {
    const auto number = static_cast<std::size_t>(i);
    counts[number] = count_lines(pieces[number].text);
    Piece again;
    again.text = pieces[number].text;
    again.is_counted = true;
    pieces[number] = std::move(again);
  });
  const Counts all = set_before(counts, pieces);
  for_each_piece(pieces, pool, [&](Piece& piece) { read_piece(piece, place, origin); });
  return all;
}

}  // namespace

ObjText parse_obj_text(std::string_view text, const std::string& file, glm::dvec3 origin,
                       ThreadPool* pool) {
  if (pool == nullptr) {
    ThreadPool here{1};
    return parse_obj_text(text, file, origin, &here);
  }
  Place place{file};
  if (text.find('\0') != std::string_view::npos) {
    throw SceneError(file + ": is binary; an OBJ model is text");
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
  std::vector<Piece> pieces = cut_into_pieces(text);
  const Counts all = read_pieces(pieces, place, origin, *pool);
  for_each_piece(pieces, *pool, [&](Piece& piece) { check_faces(piece, place, all); });

  ObjText obj;
  settle_states(pieces, obj);
  join_pieces(pieces, all, obj, *pool);
  const Tolerated short_faces = sum_of(pieces, &Piece::short_faces);
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
  warn(obj, place, sum_of(pieces, &Piece::wild_uvs),
       "a texture coordinate is out of range; 0 stands in",
       " texture coordinates are out of range; 0 stands in");
  warn(obj, place, sum_of(pieces, &Piece::wild_normals), "a normal is no direction and is left out",
       " normals are no directions and are left out");
  const Tolerated bright_colours = sum_of(pieces, &Piece::bright_colours);
  if (bright_colours.count > 0) {
    for (glm::vec3& colour : obj.colours) colour /= 255.0f;
    warn(obj, place, bright_colours, "a colour is beyond 1: colours are taken for 0 to 255",
         " colours are beyond 1: they are taken for 0 to 255");
  }
  warn(obj, place, sum_of(pieces, &Piece::missing_uvs),
       "a corner's texture coordinate is not there; it gets none",
       " corners' texture coordinates are not there; they get none");
  return obj;
}

}  // namespace softfocus
