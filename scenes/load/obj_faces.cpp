#include "scenes/load/obj_faces.h"

#include <algorithm>
#include <bit>
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

// An edge, and the triangles that meet there.
struct SharedEdge {
  std::uint32_t count = 0;
  std::array<std::uint32_t, 2> triangles{};  // the first two
  std::array<bool, 2> upwards{};             // whether each runs from the lower to the higher place
};

// The edges of triangles, and the three of each.
struct EdgeList {
  std::vector<SharedEdge> edges;
  std::vector<std::array<std::uint32_t, 3>> of_triangle;
};

EdgeList list_edges(std::span<const std::array<std::uint32_t, 3>> triangles) {
  EdgeList list;
  FirstComeNumbers numbers{triangles.size() * 3 / 2};
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    auto& own = list.of_triangle.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = triangles[t][i], to = triangles[t][(i + 1) % 3];
      const auto [number, is_new] = numbers.number({std::min(from, to), std::max(from, to), 0});
      if (is_new) list.edges.emplace_back();
      SharedEdge& edge = list.edges[number];
      if (edge.count < 2) {
        edge.triangles[edge.count] = t;
        edge.upwards[edge.count] = from < to;
      }
      ++edge.count;
      own[i] = number;
    }
  }
  return list;
}

}  // namespace

std::vector<std::uint32_t> number_places(const ObjText& obj) {
  FirstComeNumbers places{obj.positions.size()};
  std::vector<std::uint32_t> place_of;
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
  const EdgeList list = list_edges(triangles);
  std::vector<bool> turned(triangles.size()), reached(triangles.size());
  std::vector<std::uint32_t> piece;
  for (std::uint32_t first = 0; first < triangles.size(); ++first) {
    if (reached[first]) continue;
    reached[first] = true;
    piece.assign(1, first);
    std::size_t turned_count = 0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      for (const std::uint32_t number : list.of_triangle[piece[i]]) {
        const SharedEdge& edge = list.edges[number];
        if (edge.count != 2) continue;
        const std::uint32_t other = edge.triangles[edge.triangles[0] == piece[i] ? 1 : 0];
        if (reached[other]) continue;
        reached[other] = true;
        turned[other] = turned[piece[i]] != (edge.upwards[0] == edge.upwards[1]);
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
