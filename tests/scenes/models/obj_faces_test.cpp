#include "scenes/models/obj_faces.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "scenes/models/obj_model.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/random.h"
#include "tests/support/scene_test_files.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

Model model_of(std::string_view text) {
  const TemporaryDirectory directory;
  write_file(directory.file("a.obj"), text);
  return load_obj_model(directory.file("a.obj"));
}

}  // namespace

TEST_CASE("a face that is there twice, perhaps reversed, is drawn once") {
  // With vertices of its own, another first corner, and normals of the other side.
  constexpr std::string_view kQuads[] = {"f 1 2 3 4\n", "f 4 3 2 1\n", "f 2 1 4 3\n",
                                         "f 7 8 5 6\n", "f 5 8 7 6\n", "f 1//1 4//1 3//1 2//1\n"};
  const std::string vertices =
      "v 0 0 0\nv 2 0 0\nv 2 1 0\nv -0 1 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvn 0 0 -1\n";
  for (const std::string_view first : kQuads) {
    for (const std::string_view second : kQuads) {
      CAPTURE(first);
      CAPTURE(second);
      const Model alone = model_of(vertices + std::string(first));
      const Model model = model_of(vertices + std::string(first) + std::string(second));
      CHECK(model.parts[0].mesh.indices == alone.parts[0].mesh.indices);
      CHECK(model.parts[0].mesh.positions == alone.parts[0].mesh.positions);
      CHECK(model.parts[0].mesh.normals == alone.parts[0].mesh.normals);
      REQUIRE(model.warnings.size() == 1);
      CHECK(contains(model.warnings[0],
                     "a.obj: 1 of 2 faces are there before, perhaps reversed; each is drawn once"));
    }
  }
}

TEST_CASE("a face with a corner more, or with its corners in another order, is another face") {
  const std::string vertices = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n";
  CHECK(model_of(vertices + "f 1 2 3 4\nf 1 2 3\nf 1 3 2 4\n").warnings.empty());
}

TEST_CASE("which faces are doubled is what comparing all pairs says") {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random{seed};
    const auto below = [&](unsigned n) { return random.next() % n; };
    std::string text;
    for (int i = 0; i < 8; ++i) {
      text += "v " + std::to_string(i % 4) + " " + std::to_string(i % 4 / 2) + " " +
              std::to_string(i % 4 % 3) + "\n";  // each place twice
    }
    std::vector<std::vector<int>> kept;
    std::size_t doubled = 0;
    for (int face = 0; face < 30; ++face) {
      const int skipped = static_cast<int>(below(4));
      std::vector<int> corners;
      for (int i = 0; i < 4; ++i) {
        if (i != skipped || face % 3 == 0) corners.push_back(i);
      }
      for (std::size_t i = corners.size() - 1; i > 0; --i)
        std::swap(corners[i], corners[below(static_cast<unsigned>(i))]);
      text += "f";
      for (const int corner : corners) {
        text += " " + std::to_string(corner + 1 + 4 * static_cast<int>(below(2)));
      }
      text += "\n";
      const bool is_doubled = std::any_of(kept.begin(), kept.end(), [&](std::vector<int> other) {
        if (other.size() != corners.size()) return false;
        for (int way = 0; way < 2; ++way) {
          for (std::size_t turn = 0; turn < other.size(); ++turn) {
            if (other == corners) return true;
            std::rotate(other.begin(), other.begin() + 1, other.end());
          }
          std::reverse(other.begin(), other.end());
        }
        return false;
      });
      if (is_doubled) ++doubled;
      if (!is_doubled) kept.push_back(corners);
    }
    REQUIRE(doubled > 0);
    CHECK(contains(model_of(text).warnings.at(0), std::to_string(doubled) + " of 30 faces"));
  }
}

TEST_CASE("corners that are alike share a vertex of their part, whatever lies between them") {
  constexpr int kPositions = 6;
  std::string vertices = "vt 0 0\nvt 0.5 0\nvt 0 0.5\n";
  std::vector<std::array<int, 3>> faces;  // each edge has four, so that none is turned
  for (int a = 0; a < kPositions; ++a) {
    vertices += "v " + std::to_string(a) + " " + std::to_string(a * a) + " 0\n";
    for (int b = a + 1; b < kPositions; ++b) {
      for (int c = b + 1; c < kPositions; ++c) faces.push_back({a, b, c});
    }
  }
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    CAPTURE(seed);
    Random random{seed};
    for (int i = static_cast<int>(faces.size()) - 1; i > 0; --i) {
      std::swap(faces[static_cast<std::size_t>(i)],
                faces[static_cast<std::size_t>(random.whole(0, i))]);
    }
    std::string text = vertices;
    std::vector<std::pair<int, int>> known[2];  // position and texture coordinate of a vertex
    std::vector<std::uint32_t> indices[2];
    for (std::size_t face = 0; face < faces.size(); ++face) {
      const std::size_t part = face < 2 ? face : static_cast<std::size_t>(random.whole(0, 1));
      text += part == 0 ? "usemtl a\nf" : "usemtl b\nf";
      for (const int position : faces[face]) {
        const int uv = random.whole(0, 2);
        text += " " + std::to_string(position + 1) + "/" + std::to_string(uv + 1);
        const auto at = std::find(known[part].begin(), known[part].end(), std::pair{position, uv});
        indices[part].push_back(static_cast<std::uint32_t>(at - known[part].begin()));
        if (at == known[part].end()) known[part].emplace_back(position, uv);
      }
      text += "\n";
    }
    const Model model = model_of(text);
    REQUIRE(model.parts.size() == 2);
    for (std::size_t part = 0; part < 2; ++part) {
      CHECK(model.parts[part].mesh.indices == indices[part]);
      CHECK(model.parts[part].mesh.positions.size() == known[part].size());
    }
  }
}

TEST_CASE("a cube whose sides are wound anyhow is a closed surface with normals to one side") {
  const std::string vertices =
      "v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\nv -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\n";
  constexpr const char* kSides[6][2] = {
      {"f 1 2 3 4\n", "f 4 3 2 1\n"}, {"f 6 5 8 7\n", "f 7 8 5 6\n"},
      {"f 2 6 7 3\n", "f 3 7 6 2\n"}, {"f 5 1 4 8\n", "f 8 4 1 5\n"},
      {"f 4 3 7 8\n", "f 8 7 3 4\n"}, {"f 5 6 2 1\n", "f 1 2 6 5\n"}};
  for (unsigned turned = 0; turned < 64; ++turned) {
    std::string text = vertices;
    int inwards = 0;
    for (unsigned side = 0; side < 6; ++side) {
      text += kSides[side][turned >> side & 1];
      inwards += static_cast<int>(turned >> side & 1);
    }
    CAPTURE(turned);
    const Mesh mesh = model_of(text).parts[0].mesh;
    CHECK(is_closed(weld(mesh)));
    CHECK(std::fabs(volume(mesh)) == doctest::Approx(8.0));
    if (inwards != 3) CHECK((volume(mesh) < 0.0) == (inwards > 3));
    const float outwards = volume(mesh) < 0.0 ? -1.0f : 1.0f;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      CHECK(outwards * mesh.normals[i].x * mesh.positions[i].x > 0.3f);
    }
  }
}

TEST_CASE("pieces that fit stay, and edges of three triangles join none") {
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  ThreadPool pool{2};
  CHECK(triangles_to_turn(Triangles{}, pool).empty());
  CHECK(triangles_to_turn(Triangles{{0, 1, 2}, {2, 1, 3}}, pool) ==
        std::vector<bool>{false, false});
  CHECK(triangles_to_turn(Triangles{{0, 1, 2}, {1, 2, 3}}, pool) == std::vector<bool>{false, true});
  CHECK(triangles_to_turn(Triangles{{0, 1, 2}, {1, 2, 3}, {2, 1, 4}}, pool) ==
        std::vector<bool>{false, false, false});
  // The first of three is the one that does not fit.
  CHECK(triangles_to_turn(Triangles{{0, 2, 1}, {2, 1, 3}, {2, 3, 4}}, pool) ==
        std::vector<bool>{true, false, false});
}

TEST_CASE("a strip with one side only comes to an end") {
  std::vector<std::array<std::uint32_t, 3>> strip;
  constexpr std::uint32_t kCount = 7;  // of triangles, odd: Moebius's
  for (std::uint32_t i = 0; i < kCount; ++i) {
    strip.push_back({i, (i + 1) % kCount, (i + 2) % kCount});
  }
  ThreadPool pool{1};
  CHECK(triangles_to_turn(strip, pool).size() == kCount);
}

TEST_CASE("faces whose normals are given are not turned to fit") {
  const Mesh mesh = model_of(
                        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 -1\n"
                        "f 1//1 2//1 3//1\nf 1//2 4//2 3//2\n")
                        .parts[0]
                        .mesh;
  CHECK(mesh.indices.size() == 6);
  CHECK(area_normal(triangles_of(mesh)[0]).z > 0.0);
  CHECK(area_normal(triangles_of(mesh)[1]).z < 0.0);
}
