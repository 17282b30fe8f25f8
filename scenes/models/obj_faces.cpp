#include "scenes/models/obj_faces.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "raster/numbers/random_bits.h"
#include "raster/threads/loops.h"
#include "scenes/models/first_come_numbers.h"

namespace softfocus {
namespace {

FirstComeNumbers::Key bits_of(glm::vec3 p) {
  // 0 + -0 is 0: the two are one place.
  return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
          std::bit_cast<std::uint32_t>(p.z + 0.0f)};
}

// A polygon's places from the lowest on, towards the lower of its neighbours: the same whatever the
// first corner and the way round. Drawn both, two such make speckles: interpolated depths differ in
// their last bits.
void set_outline(const ObjText& obj, std::span<const std::uint32_t> place_of, std::size_t face,
                 std::vector<std::uint32_t>& outline) {
  const ObjCorner* corners = &obj.corners[obj.faces[face].first_corner];
  outline.clear();
  for (std::uint32_t i = 0; i < obj.faces[face].corner_count; ++i) {
    outline.push_back(place_of[static_cast<std::size_t>(corners[i].position)]);
  }
  std::rotate(outline.begin(), std::min_element(outline.begin(), outline.end()), outline.end());
  if (outline[1] > outline.back()) std::reverse(outline.begin() + 1, outline.end());
}

// A face of those that have their lowest place in common. Alike have alike `others`.
struct FaceAtPlace {
  std::uint64_t others;  // the other two places of a triangle, a mixture of those of a polygon
  std::uint32_t face;
};

std::uint64_t others_of(std::span<const std::uint32_t> outline) {
  if (outline.size() == 3) return std::uint64_t{outline[1]} << 32 | outline[2];
  std::uint64_t mixed = outline.size();
  for (const std::uint32_t place : outline) mixed = mix_bits(mixed + place);
  return mixed;
}

// A side of a triangle, from one place to another: 3 * triangle + which.
using Side = std::uint32_t;

struct Edge {
  std::uint32_t to;  // the higher place
  Side side;
};

// For each side the one of another triangle that lies along it, if that is one alone.
constexpr Side kNone = std::numeric_limits<Side>::max();

// Sides in the order of the lower of their places; then those of a place by the higher one.
std::vector<Side> pair_sides(std::span<const std::array<std::uint32_t, 3>> triangles,
                             ThreadPool& pool) {
  const auto ends = [&](Side side) {
    const auto& triangle = triangles[side / 3];
    return std::minmax(triangle[side % 3], triangle[(side + 1) % 3]);
  };
  const auto side_count = static_cast<Side>(3 * triangles.size());
  std::uint32_t place_count = 0;
  for (const auto& triangle : triangles) {
    for (const std::uint32_t place : triangle) place_count = std::max(place_count, place + 1);
  }
  std::vector<Side> starts(place_count + std::size_t{1});
  for (Side side = 0; side < side_count; ++side) ++starts[ends(side).first + std::size_t{1}];
  for (std::size_t i = 0; i < place_count; ++i) starts[i + 1] += starts[i];
  std::vector<Edge> edges(side_count);
  std::vector<Side> next = starts;
  for (Side side = 0; side < side_count; ++side) {
    const auto [low, high] = ends(side);
    edges[next[low]++] = {high, side};
  }
  std::vector<Side> paired(side_count, kNone);
  constexpr int kBand = 1 << 14;
  for_each_row(pool, static_cast<int>(place_count), kBand, [&](int place) {
    const auto at = static_cast<std::size_t>(place);
    const auto of_place = std::span{edges}.subspan(starts[at], starts[at + 1] - starts[at]);
    const auto first = of_place.begin(), last = of_place.end();
    std::sort(first, last, [](const Edge& a, const Edge& b) {
      return a.to != b.to ? a.to < b.to : a.side < b.side;
    });
    for (auto edge = first; edge != last;) {
      const auto other = std::find_if(edge, last, [&](const Edge& e) { return e.to != edge->to; });
      if (other - edge == 2) {
        paired[edge[0].side] = edge[1].side;
        paired[edge[1].side] = edge[0].side;
      }
      edge = other;
    }
  });
  return paired;
}

}  // namespace

std::vector<std::uint32_t> number_places(const ObjText& obj) {
  FirstComeNumbers places{obj.positions.size()};
  std::vector<std::uint32_t> place_of;
  place_of.reserve(obj.positions.size());
  for (const glm::vec3& position : obj.positions) {
    place_of.push_back(places.number(bits_of(position)).first);
  }
  return place_of;
}

std::vector<std::uint32_t> doubled_faces(const ObjText& obj,
                                         std::span<const std::uint32_t> place_of) {
  // Sorted by the lowest place first, so that what is compared lies together.
  std::vector<std::uint32_t> outline, starts(obj.positions.size() + 1);
  const auto lowest_of = [&](const ObjFace& face) {
    std::uint32_t lowest = std::numeric_limits<std::uint32_t>::max();
    for (std::uint32_t i = 0; i < face.corner_count; ++i) {
      const auto position = static_cast<std::size_t>(obj.corners[face.first_corner + i].position);
      lowest = std::min(lowest, place_of[position]);
    }
    return lowest;
  };
  for (const ObjFace& face : obj.faces) ++starts[lowest_of(face) + std::size_t{1}];
  for (std::size_t i = 1; i < starts.size(); ++i) starts[i] += starts[i - 1];
  std::vector<FaceAtPlace> faces(obj.faces.size());
  for (std::uint32_t face = 0; face < obj.faces.size(); ++face) {
    set_outline(obj, place_of, face, outline);
    faces[starts[outline[0]]++] = {others_of(outline), face};  // which makes it the place's end
  }
  std::vector<std::uint32_t> doubled, earlier;
  const auto is_there_before = [&](std::span<const FaceAtPlace> of_place, std::size_t i) {
    if (i == 0 || of_place[i - 1].others != of_place[i].others) return false;
    set_outline(obj, place_of, of_place[i].face, outline);
    for (std::size_t k = i; k > 0 && of_place[k - 1].others == of_place[i].others; --k) {
      set_outline(obj, place_of, of_place[k - 1].face, earlier);
      if (outline == earlier) return true;
    }
    return false;
  };
  std::size_t begin = 0;
  for (const std::uint32_t end : starts) {
    const std::span<FaceAtPlace> of_place = std::span{faces}.subspan(begin, end - begin);
    std::sort(of_place.begin(), of_place.end(), [](const FaceAtPlace& a, const FaceAtPlace& b) {
      return a.others != b.others ? a.others < b.others : a.face < b.face;
    });
    for (std::size_t i = 0; i < of_place.size(); ++i) {
      if (is_there_before(of_place, i)) doubled.push_back(of_place[i].face);
    }
    begin = end;
  }
  std::sort(doubled.begin(), doubled.end());
  return doubled;
}

std::vector<bool> triangles_to_turn(std::span<const std::array<std::uint32_t, 3>> triangles,
                                    ThreadPool& pool) {
  std::vector<bool> turned(triangles.size()), reached(triangles.size());
  const std::vector<Side> paired = pair_sides(triangles, pool);
  const auto start = [&](Side side) { return triangles[side / 3][side % 3]; };
  const auto is_wrong = [&](Side side) {
    return paired[side] != kNone && start(side) == start(paired[side]);
  };
  bool is_right = true;
  for (Side side = 0; side < paired.size() && is_right; ++side) is_right = !is_wrong(side);
  if (is_right) return turned;
  std::vector<std::uint32_t> piece;
  for (std::uint32_t first = 0; first < triangles.size(); ++first) {
    if (reached[first]) continue;
    reached[first] = true;
    piece.assign(1, first);
    std::size_t turned_count = 0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      for (Side side = 3 * piece[i]; side < 3 * piece[i] + 3; ++side) {
        if (paired[side] == kNone) continue;
        const std::uint32_t other = paired[side] / 3;
        if (reached[other]) continue;
        reached[other] = true;
        turned[other] = turned[piece[i]] != is_wrong(side);
        turned_count += turned[other] ? 1 : 0;
        piece.push_back(other);
      }
    }
    if (2 * turned_count <= piece.size()) continue;
    for (const std::uint32_t triangle : piece) turned[triangle] = !turned[triangle];
  }
  return turned;
}

}  // namespace softfocus
