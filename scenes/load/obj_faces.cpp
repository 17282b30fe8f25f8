#include "scenes/load/obj_faces.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <unordered_set>

#include "raster/numbers/random_bits.h"
#include "scenes/load/first_come_numbers.h"

namespace softfocus {
namespace {

FirstComeNumbers::Key bits_of(glm::vec3 p) {
  // 0 + -0 is 0: the two are one place.
  return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
          std::bit_cast<std::uint32_t>(p.z + 0.0f)};
}

// Polygons by their places, whatever the first corner and the way round. Drawn both, two such
// make speckles: interpolated depths differ in their last bits.
class FacesSoFar {
 public:
  explicit FacesSoFar(std::size_t expected) : triangles_(expected) {}
  /// Whether it is there for the first time.
  bool add(const std::vector<std::uint32_t>& places) {
    if (places.size() == 3) {  // most are; any two orders of three corners are alike
      std::array<std::uint32_t, 3> key{places[0], places[1], places[2]};
      std::sort(key.begin(), key.end());
      return triangles_.number(key).second;
    }
    const auto first = std::min_element(places.begin(), places.end());
    std::vector<std::uint32_t> key(first, places.end());
    key.insert(key.end(), places.begin(), first);
    if (key[1] > key.back()) std::reverse(key.begin() + 1, key.end());
    return known_.insert(std::move(key)).second;
  }

 private:
  struct Mix {
    std::size_t operator()(const std::vector<std::uint32_t>& key) const {
      std::uint64_t mixed = key.size();
      for (const std::uint32_t place : key) mixed = mix_bits(mixed + place);
      return static_cast<std::size_t>(mixed);
    }
  };
  FirstComeNumbers triangles_;
  std::unordered_set<std::vector<std::uint32_t>, Mix> known_;
};

// A side of a triangle, from one place to another: 3 * triangle + which.
using Side = std::uint32_t;

struct Edge {
  std::uint32_t to;  // the higher place
  Side side;
};

// For each side the one of another triangle that lies along it, if that is one alone.
constexpr Side kNone = std::numeric_limits<Side>::max();

// Sides in the order of the lower of their places; then those of a place by the higher one.
std::vector<Side> pair_sides(std::span<const std::array<std::uint32_t, 3>> triangles) {
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
  for (std::size_t place = 0; place < place_count; ++place) {
    const auto first = edges.begin() + starts[place], last = edges.begin() + starts[place + 1];
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
  }
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

std::size_t drop_doubled_faces(ObjText& obj, std::span<const std::uint32_t> place_of) {
  FacesSoFar so_far{obj.faces.size()};
  std::vector<std::uint32_t> places;
  return std::erase_if(obj.faces, [&](const ObjFace& face) {
    places.clear();
    for (std::uint32_t i = 0; i < face.corner_count; ++i) {
      const ObjCorner& corner = obj.corners[face.first_corner + i];
      places.push_back(place_of[static_cast<std::size_t>(corner.position)]);
    }
    return !so_far.add(places);
  });
}

std::vector<bool> triangles_to_turn(std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<bool> turned(triangles.size()), reached(triangles.size());
  const std::vector<Side> paired = pair_sides(triangles);
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
