#include "scenes/draw/object_numbers.h"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/load/load_scene.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr int kWidth = 96, kHeight = 71;

std::vector<std::uint16_t> numbers_of(const Scene& scene, ThreadPool& pool,
                                      const Profile& profile = {}) {
  return draw_object_numbers(scene, camera_matrices(scene.camera, 0, kWidth, kHeight), 0, kWidth,
                             kHeight, profile, pool);
}

// One picture an object, in which it is white and all others are black: where it is white, its
// triangle is the nearest at the pixel's centre.
std::vector<std::uint16_t> numbers_one_by_one(Scene scene, ThreadPool& pool) {
  const std::vector<Object> objects = scene.objects;
  const std::vector<Material> materials = scene.materials;
  scene.background = glm::vec3{0.0f};
  scene.materials.clear();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Material black = materials[objects[i].material];
    black.lit = false;
    black.texture.reset();
    black.diffuse = glm::vec3{0.0f};
    scene.materials.push_back(black);
    scene.objects[i].material = static_cast<std::uint32_t>(i);
  }
  std::vector<std::uint16_t> numbers(kWidth * kHeight);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    scene.materials[i].diffuse = glm::vec3{1.0f};
    const Image image = draw_scene(scene, camera_matrices(scene.camera, 0, kWidth, kHeight), 0,
                                   kWidth, kHeight, Profile{}, pool);
    scene.materials[i].diffuse = glm::vec3{0.0f};
    for (std::size_t at = 0; at < numbers.size(); ++at) {
      const auto x = static_cast<int>(at) % kWidth, y = static_cast<int>(at) / kWidth;
      if (load_texel(image, x, y).x > 0.5f) numbers[at] = static_cast<std::uint16_t>(i + 1);
    }
  }
  return numbers;
}

}  // namespace

TEST_CASE("a pixel's number is that of the object whose triangle is nearest at its centre" *
          doctest::test_suite("long")) {
  ThreadPool pool(2);
  for (const char* name : {"figures", "cube-room", "near-fence", "canopy", "random:3"}) {
    const Scene scene = load_scene(name, scene_search_path({}));
    const std::vector<std::uint16_t> numbers = numbers_of(scene, pool);
    INFO(std::string{name});
    CHECK(std::set<std::uint16_t>(numbers.begin(), numbers.end()).size() > 2);
    CHECK(numbers == numbers_one_by_one(scene, pool));
  }
}

TEST_CASE("object numbers are the same on every vector unit, for any threads and profile") {
  ThreadPool scalar(1, Isa::scalar);
  for (const char* name : {"random:5", "canopy"}) {
    const Scene scene = load_scene(name, scene_search_path({}));
    const std::vector<std::uint16_t> expected = numbers_of(scene, scalar);
    for (const Isa isa : available_isas()) {
      for (const int threads : {1, 3}) {
        ThreadPool pool(threads, isa);
        CHECK(numbers_of(scene, pool) == expected);
      }
    }
    Profile cutting;
    cutting.half_store = HalfRounding::toward_zero;
    CHECK(numbers_of(scene, scalar, cutting) == expected);
  }
}

TEST_CASE("numbers go beyond 255, and nothing drawn is 0") {
  // A row of triangles, one an object.
  Scene scene;
  scene.camera = {.position = {0, 0, 4}, .fov_y_degrees = 40, .near_m = 0.5, .far_m = 20};
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.indices = {0, 1, 2};
  scene.meshes.push_back(mesh);
  scene.materials.push_back(Material{});
  for (int i = 0; i < 700; ++i) {
    // Each before the last, and smaller.
    Object object;
    object.position = {0, 0, 0.001 * i};
    object.scale = glm::dvec3{1.0 - 0.001 * i};
    scene.objects.push_back(object);
  }
  ThreadPool pool(2);
  const std::vector<std::uint16_t> numbers = numbers_of(scene, pool);
  CHECK(numbers[kHeight / 2 * kWidth + kWidth / 2] == 700);
  CHECK(numbers[0] == 0);
}

TEST_CASE("nothing is drawn for a method that reads no numbers") {
  const Scene scene = load_scene("figures", scene_search_path({}));
  const CameraMatrices view = camera_matrices(scene.camera, 0, kWidth, kHeight);
  ThreadPool pool(2);
  const auto numbers_for = [&](const char* method) {
    return object_numbers_for(*find_method(method), scene, view, 0, kWidth, kHeight, {}, pool);
  };
  CHECK(numbers_for("disc-layers").empty());
  CHECK(numbers_for("object-identification") == numbers_of(scene, pool));
}
