#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <limits>
#include <string>

#include "scenes/files/decimal.h"
#include "scenes/files/scene_error.h"
#include "scenes/models/model.h"
#include "scenes/models/ply_stl.h"

namespace softfocus {

bool is_position(glm::dvec3 p) {
  return std::fabs(p.x) <= kLargestCoordinate && std::fabs(p.y) <= kLargestCoordinate &&
         std::fabs(p.z) <= kLargestCoordinate;
}

void place_positions(const std::vector<glm::dvec3>& exact, FileFaces& made) {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high = -low;
  for (const ObjCorner& corner : made.faces.corners) {
    const glm::dvec3 p = exact[static_cast<std::size_t>(corner.position)];
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  made.origin = far_middle(low, high);
  made.faces.positions.reserve(exact.size());
  for (const glm::dvec3& p : exact) made.faces.positions.emplace_back(p - made.origin);
}

namespace {

// Facets that grow.
struct StlFacets {
  std::vector<glm::dvec3> positions;
  ObjText obj;

  void add_corner(glm::dvec3 p) {
    obj.corners.push_back({static_cast<std::int32_t>(positions.size())});
    positions.push_back(p);
  }
  // Of the corners since the last; left out if one is no position.
  void add_facet() {
    const ObjFace none{};
    const ObjFace& last = obj.faces.empty() ? none : obj.faces.back();
    const std::size_t first = last.first_corner + last.corner_count;
    const auto from = positions.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::all_of(from, positions.end(), is_position)) {
      obj.faces.push_back({static_cast<std::uint32_t>(first),
                           static_cast<std::uint32_t>(obj.corners.size() - first)});
      return;
    }
    ++left_out;
    positions.resize(first);
    obj.corners.resize(first);
  }

  std::size_t left_out = 0;
};

constexpr std::size_t kHeader = 84, kFacet = 50;

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  }
  return word;
}

// 80 bytes of any text, the count, and for each facet a normal, three corners and two bytes more.
void read_binary(std::string_view bytes, const std::string& file, StlFacets& facets) {
  const std::size_t count = bytes.size() < kHeader ? 0 : word_at(bytes, kHeader - 4);
  if (bytes.size() < kHeader || (bytes.size() - kHeader) / kFacet < count) {
    throw SceneError(file + ": is no STL, or cut off: " + std::to_string(bytes.size()) +
                     " bytes where " + std::to_string(kHeader + kFacet * count) + " for " +
                     std::to_string(count) + " facets would be right");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t corners = kHeader + kFacet * i + 12;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      glm::dvec3 p{0.0};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        p[static_cast<int>(axis)] =
            std::bit_cast<float>(word_at(bytes, corners + 12 * corner + 4 * axis));
      }
      facets.add_corner(p);
    }
    facets.add_facet();
  }
}

// A file of text, word by word.
struct Words {
  std::string_view text;
  const std::string& file;
  std::size_t line = 1;

  // In small letters, as far as it matters; empty at the end.
  std::string next() {
    std::size_t at = 0;
    for (; at < text.size() && static_cast<unsigned char>(text[at]) <= ' '; ++at) {
      if (text[at] == '\n') ++line;
    }
    std::string word;
    for (; at < text.size() && static_cast<unsigned char>(text[at]) > ' '; ++at) {
      const char c = text[at];
      word.push_back(c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c);
    }
    text.remove_prefix(at);
    return word;
  }
  // Past a name: to the line's end, or to the first facet in it.
  void end_line() {
    const std::string_view line_rest = text.substr(0, text.find_first_of("\r\n"));
    text.remove_prefix(std::min(line_rest.find("facet normal"), line_rest.size()));
  }
  [[noreturn]] void fail(const std::string& reason) const {
    throw SceneError(file + ":" + std::to_string(line) + ": " + reason);
  }
  double number() {
    const std::string word = next();
    const auto read = decimal_to_float(word);
    if (!read) fail("\"" + word.substr(0, 40) + "\" is no number");
    return *read;
  }
  glm::dvec3 position() {
    glm::dvec3 p{0.0};
    for (int axis = 0; axis < 3; ++axis) p[axis] = number();
    return p;
  }
};

void read_words(Words words, StlFacets& facets) {
  std::uint32_t corners = 0;
  bool is_in_facet = false;
  for (std::string word = words.next(); !word.empty(); word = words.next()) {
    if (word == "end") word += words.next();
    if (word == "vertex") {
      if (!is_in_facet) words.fail("a vertex outside a facet");
      if (++corners > kMaxFaceCorners) words.fail("a facet of too many vertices");
      facets.add_corner(words.position());
    } else if (word == "solid" || word == "endsolid" || word == "color" || word[0] == '#') {
      words.end_line();
    } else if (word == "facet") {
      if (is_in_facet) words.fail("a facet within a facet; endfacet is missing");
      is_in_facet = true;
      corners = 0;
    } else if (word == "endfacet") {
      if (!is_in_facet || corners < 3) words.fail("a facet of fewer than three vertices");
      is_in_facet = false;
      facets.add_facet();
    } else if (word == "normal") {
      for (int axis = 0; axis < 3; ++axis) words.next();
    } else if (word != "outer" && word != "loop" && word != "endloop") {
      words.fail("\"" + word.substr(0, 40) +
                 "\" is unknown; facet, outer loop, vertex, endloop, endfacet or endsolid would be "
                 "right");
    }
  }
  if (is_in_facet) words.fail("the file ends within a facet");
}

}  // namespace

FileFaces parse_stl(std::string_view bytes, const std::string& file) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (bytes.starts_with(kMark)) bytes.remove_prefix(kMark.size());
  StlFacets facets;
  facets.obj.has_smoothing_groups = true;  // and all are in none: flat
  // Some binary files begin with "solid" too; their length tells them, or that no facet follows.
  const bool has_length =
      bytes.size() >= kHeader && bytes.size() - kHeader == kFacet * word_at(bytes, kHeader - 4);
  constexpr std::size_t kLongName = 4096;
  Words words{bytes.substr(0, kLongName), file};
  bool is_text = !has_length && words.next() == "solid";
  if (is_text) {
    std::string word = words.next();
    while (!word.empty() && !word.ends_with("facet") && word != "endsolid") word = words.next();
    is_text = !word.empty() || bytes.size() < kHeader;
  }
  if (is_text) {
    read_words({bytes, file}, facets);
  } else {
    read_binary(bytes, file, facets);
  }
  if (facets.obj.faces.empty()) throw SceneError(file + ": has no facets; a mesh would be right");
  FileFaces made{std::move(facets.obj)};
  if (facets.left_out > 0) {
    made.faces.warnings.push_back(file + ": " + std::to_string(facets.left_out) +
                                  " facets with a coordinate that is no number, or beyond 1e9, are "
                                  "left out");
  }
  place_positions(facets.positions, made);
  return made;
}

}  // namespace softfocus
