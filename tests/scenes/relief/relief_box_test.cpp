#include "scenes/relief/impostors/relief_box.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "raster/images/texel.h"
#include "scenes/make/shapes.h"
#include "tests/support/relief_scenes.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr int kBoxSize = 72;
constexpr float kBoxFar = 1000.0f;

/// Two walls side by side, turned by 45 degrees: a slit that no face sees into.
Scene slit_scene() {
  Scene scene = test::lit_mesh(make_cube(1.0, 1));
  for (const double side : {-1.0, 1.0}) {
    Object wall;
    wall.scale = {2.0, 0.05, 2.0};
    wall.rotation_degrees = {0.0, 0.0, 45.0};
    wall.position = glm::dvec3{-0.7071, 0.7071, 0.0} * (0.25 * side);
    scene.objects.push_back(wall);
  }
  scene.objects.erase(scene.objects.begin());
  return scene;
}

CameraMatrices box_seen_from(glm::dvec3 eye) {
  Camera camera;
  camera.position = eye;
  camera.target = {0.0, 0.0, 0.0};
  return camera_matrices(camera, 0.0, kBoxSize, kBoxSize);
}

Image far_picture() {
  Image picture = make_image(Format::rgba16f, kBoxSize, kBoxSize);
  clear_image(picture, {0.0f, 0.0f, 0.0f, kBoxFar}, Profile{});
  return picture;
}

Image drawn_from(const Scene& scene, const CameraMatrices& camera, ThreadPool& pool) {
  PreparedScene prepared = prepare_scene(scene, Profile{}, pool);
  Image picture = far_picture();
  prepared.depth = make_image(Format::r32f, kBoxSize, kBoxSize);
  prepared.pass.targets.colour[0] = &picture;
  prepared.pass.targets.depth = &prepared.depth;
  record_scene(prepared, camera, 0.0, prepared.pass);
  prepared.pass.clear_colour = glm::vec4{0.0f, 0.0f, 0.0f, kBoxFar};
  finish(prepared.pass, pool);
  return picture;
}

int count_of(const std::vector<FacePoint>& points, FacePoint which) {
  return static_cast<int>(std::count(points.begin(), points.end(), which));
}

}  // namespace

TEST_CASE("from outside of a box one to three faces are seen: those that the eye lies before") {
  const Scene scene = test::lit_mesh(make_cube(2.0, 1));
  ThreadPool pool(1);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefBox box = draw_relief_box(maker, {.texels = 16}, pool);
  for (const std::optional<BoxFace>& face : box.faces) REQUIRE(face);
  CHECK(faces_seen(box, {5.0, 0.0, 0.0}) == 1u);                    // +x
  CHECK(faces_seen(box, {0.0, -5.0, 4.0}) == (1u << 3 | 1u << 4));  // -y, +z
  CHECK(faces_seen(box, {-5.0, 4.0, -3.0}) == (1u << 1 | 1u << 2 | 1u << 5));
  CHECK(faces_seen(box, {0.5, 0.0, 0.2}) == 0u);
}

TEST_CASE("the faces of a box have texels of one size, the longest side as many as asked for") {
  Scene scene = test::lit_mesh(make_cube(1.0, 1));
  scene.objects[0].scale = {4.0, 2.0, 1.0};
  ThreadPool pool(1);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefBox box = draw_relief_box(maker, {.texels = 42}, pool);
  const auto size_of = [&](std::size_t face) {
    return std::pair{box.faces[face]->texture.width, box.faces[face]->texture.height};
  };
  CHECK(size_of(0) == std::pair{12, 22});
  CHECK(size_of(3) == std::pair{42, 12});
  CHECK(size_of(4) == std::pair{42, 22});
}

TEST_CASE("a ring is whole from everywhere, its faces laid over each other by depth") {
  const Scene scene = test::lit_mesh(make_torus(0.7, 0.3, 48, 24));
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefBox box = draw_relief_box(maker, {.texels = 96, .depth_bits = 16}, pool);
  BoxMemory memory;
  for (const glm::dvec3 eye : {glm::dvec3{1.5, 2.0, 3.0}, {-3.0, 1.2, 0.8}, {0.3, -3.5, 0.9}}) {
    const CameraMatrices camera = box_seen_from(eye);
    const Image drawn = drawn_from(scene, camera, pool);
    Image shown = far_picture();
    draw_box(box, camera, {}, memory, shown, pool);
    int seen = 0, lost = 0, gained = 0, wrong_depths = 0;
    for (int y = 0; y < kBoxSize; ++y) {
      for (int x = 0; x < kBoxSize; ++x) {
        const float right = load_texel(drawn, x, y).w, own = load_texel(shown, x, y).w;
        seen += right < kBoxFar ? 1 : 0;
        lost += right < kBoxFar && own == kBoxFar ? 1 : 0;
        gained += right == kBoxFar && own < kBoxFar ? 1 : 0;
        wrong_depths += right < kBoxFar && own < kBoxFar && std::fabs(own - right) > 0.1f ? 1 : 0;
      }
    }
    CAPTURE(eye.x);
    CHECK(seen > 800);
    // The thin rims of what the faces share out.
    CHECK(lost < seen / 8);
    CHECK(gained < seen / 25);
    CHECK(wrong_depths < seen / 50);
    // The hole's waist is seen along its surface alone.
    CHECK(count_of(unseen_pixels(box, camera, drawn, kBoxFar, pool), FacePoint::by_none) <
          seen / 50);
  }
}

TEST_CASE("a box by slices is the ring too, the nearer the more there are") {
  const Scene scene = test::lit_mesh(make_torus(0.7, 0.3, 48, 24));
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefBox box = draw_relief_box(maker, {.texels = 96, .depth_bits = 16}, pool);
  const CameraMatrices camera = box_seen_from({2.0, 2.0, 2.0});
  const Image drawn = drawn_from(scene, camera, pool);
  BoxMemory memory;
  const auto wrong_by = [&](const BoxRule& rule) {
    Image shown = far_picture();
    draw_box(box, camera, rule, memory, shown, pool);
    int wrong = 0, lies_wrong = 0;
    for (int y = 0; y < kBoxSize; ++y) {
      for (int x = 0; x < kBoxSize; ++x) {
        const float right = load_texel(drawn, x, y).w, own = load_texel(shown, x, y).w;
        wrong += (right < kBoxFar) != (own < kBoxFar) ? 1 : 0;
        lies_wrong += right < kBoxFar && own < kBoxFar && std::fabs(own - right) > 0.1f ? 1 : 0;
      }
    }
    if (!rule.march || rule.march->slices >= 32) CHECK(lies_wrong < 40);
    return wrong;
  };
  const int by_warp = wrong_by({}), by_8 = wrong_by({.march = MarchSettings{8}});
  const int by_128 = wrong_by({.march = MarchSettings{128}});
  CHECK(by_warp > 0);
  CHECK(by_8 > 2 * by_128);
  CHECK(by_128 < 160);
  CHECK(wrong_by({.march = MarchSettings{32, 6}}) < 160);
  CHECK(wrong_by({}) == by_warp);  // the memory is of either kind
}

TEST_CASE("a ray below a rim does not come out in the hollow that the rim encloses") {
  // A ring, and under its hole a plate, which the upper face sees through the hole.
  Scene scene = test::lit_mesh(make_torus(0.7, 0.2, 48, 24));
  scene.objects[0].position.y = 0.8;
  scene.meshes.push_back(make_cube(1.4, 1));
  Object plate;
  plate.mesh = 1;
  plate.position.y = -0.9;
  plate.scale.y = 0.05;
  scene.objects.push_back(plate);
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefBox box = draw_relief_box(maker, {.texels = 96, .depth_bits = 16}, pool);
  const CameraMatrices camera = box_seen_from({2.5, 1.6, 2.5});
  const Image drawn = drawn_from(scene, camera, pool);
  Image shown = far_picture();
  BoxMemory memory;
  draw_box(box, camera, {.march = MarchSettings{64, 4}}, memory, shown, pool);
  int gained = 0;
  for (int y = 0; y < kBoxSize; ++y) {
    for (int x = 0; x < kBoxSize; ++x) {
      const bool is = load_texel(drawn, x, y).w < kBoxFar;
      gained += !is && load_texel(shown, x, y).w < kBoxFar ? 1 : 0;
    }
  }
  CHECK(gained < 60);
}

TEST_CASE("of a ball there is nothing that no face has") {
  const Scene scene = test::lit_mesh(make_sphere(1.0, 48, 24));
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefBox box = draw_relief_box(maker, {.texels = 64, .depth_bits = 16}, pool);
  const CameraMatrices camera = box_seen_from({2.0, 2.0, 2.0});
  CHECK(faces_seen(box, camera.eye) == (1u | 1u << 2 | 1u << 4));
  const auto points = unseen_pixels(box, camera, drawn_from(scene, camera, pool), kBoxFar, pool);
  CHECK(count_of(points, FacePoint::by_none) == 0);
  CHECK(count_of(points, FacePoint::by_unseen) == 0);
}

TEST_CASE("a texel that is steep to a face is left to a seen face that has its point") {
  const Scene scene = test::lit_mesh(make_sphere(1.0, 48, 24));
  ThreadPool pool(1);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefBox box = draw_relief_box(maker, {.texels = 48, .depth_bits = 16}, pool);
  BoxMemory memory;
  const auto left_from = [&](glm::dvec3 eye) {
    Image picture = far_picture();
    draw_box(box, box_seen_from(eye), {}, memory, picture, pool);
    return static_cast<double>(memory.left[0]->extent.filled) /
           static_cast<double>(box.faces[0]->extent.filled);
  };
  CHECK(left_from({5.0, 0.0, 0.0}) == 1.0);  // +x alone
  // +y and +z are better on the rim beyond sin 60 degrees, a quarter of the disc.
  CHECK(left_from({3.0, 3.0, 3.0}) > 0.8);
  CHECK(left_from({3.0, 3.0, 3.0}) < 0.93);
  CHECK(left_from({5.0, 0.0, 0.0}) == 1.0);
}

TEST_CASE("a slit across all axes is seen by no face, and counted") {
  const Scene scene = slit_scene();
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefBox box = draw_relief_box(maker, {.texels = 96, .depth_bits = 16}, pool);
  const auto unseen_from = [&](glm::dvec3 eye) {
    const CameraMatrices camera = box_seen_from(eye);
    return count_of(unseen_pixels(box, camera, drawn_from(scene, camera, pool), kBoxFar, pool),
                    FacePoint::by_none);
  };
  CHECK(unseen_from({2.6, 2.6, 0.0}) > 30);  // into the slit
  CHECK(unseen_from({-3.0, 3.0, 0.3}) == 0);
}

TEST_CASE("a face has the points that its texels show, and none behind them") {
  const Scene scene = test::lit_mesh(make_cube(2.0, 1));
  ThreadPool pool(1);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const ReliefBox box = draw_relief_box(maker, {.texels = 40, .depth_bits = 16}, pool);
  const BoxFace& top = *box.faces[2];
  CHECK(has_point(top, {0.3, 1.0, -0.7}, 0.0));
  CHECK(!has_point(top, {0.3, 0.8, -0.7}, 0.0));
  CHECK(has_point(top, {0.3, 0.8, -0.7}, 0.2));
  CHECK(!has_point(top, {1.5, 1.0, 0.0}, 0.0));
}

TEST_CASE("a view of a box has the same bits for any number of threads and vector unit") {
  const Scene scene = test::lit_mesh(make_torus(0.7, 0.3, 24, 12));
  const CameraMatrices camera = box_seen_from({1.5, 2.0, 3.0});
  const auto picture_by = [&](ThreadPool& pool) {
    ReliefMaker maker = prepare_relief(scene, 0.0, pool);
    const ReliefBox box = draw_relief_box(maker, {.texels = 48}, pool);
    BoxMemory memory;
    Image picture = far_picture();
    draw_box(box, camera, {}, memory, picture, pool);
    return picture;
  };
  ThreadPool plain(1, Isa::scalar);
  const Image right = picture_by(plain);
  for (const Isa isa : available_isas()) {
    ThreadPool pool(3, isa);
    CHECK_MESSAGE(equal(picture_by(pool), right), isa_name(isa));
  }
}
