// Cut-out surfaces, wherever surfaces are drawn.

#include "scenes/surfaces/surface_stages.h"

#include <doctest/doctest.h>

#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/object_numbers.h"
#include "scenes/load/load_scene.h"
#include "scenes/make/procedural_texture.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr int kSize = 65;

// A white square of 2 x 2 m at the origin, cut to its upper left and lower right quarters.
// Behind it a red square of 8 x 8 m, drawn later.
Scene scene_with_holes() {
  Image texels = make_image(Format::rgba8, 2, 2);
  for (const auto& [x, y, value] : {std::array{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}}) {
    store_texel(texels, x, y, glm::vec4{static_cast<float>(value)}, Profile{});
  }
  Scene scene;
  scene.camera = {.position = {0, 0, 4}, .fov_y_degrees = 40, .near_m = 0.5, .far_m = 20};
  scene.background = {0.0f, 0.0f, 1.0f};
  scene.textures.push_back(make_opacity_texture(texels));
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back(mesh);
  Material white;
  white.lit = false;
  white.diffuse = glm::vec3{1.0f};
  white.opacity_texture = 0;
  white.opacity_sampler = {Filter::nearest, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
  white.cut_out = true;
  Material red;
  red.lit = false;
  red.diffuse = {1.0f, 0.0f, 0.0f};
  scene.materials = {white, red};
  Object behind;
  behind.material = 1;
  behind.position = {0, 0, -2};
  behind.scale = glm::dvec3{4};
  scene.objects = {Object{}, behind};
  return scene;
}

CameraMatrices view_of(const Scene& scene) {
  return camera_matrices(scene.camera, 0, kSize, kSize);
}

Image drawn(const Scene& scene, Isa isa, const Profile& profile = {}) {
  ThreadPool pool{2, isa};
  return draw_scene(scene, view_of(scene), 0, kSize, kSize, profile, pool);
}

constexpr glm::vec4 kWhiteAt4{1.0f, 1.0f, 1.0f, 4.0f};
constexpr glm::vec4 kRedAt6{1.0f, 0.0f, 0.0f, 6.0f};

}  // namespace

TEST_CASE("through a hole one sees what is behind, with its depth") {
  for (const Isa isa : available_isas()) {
    CAPTURE(isa_name(isa));
    const Image image = drawn(scene_with_holes(), isa);
    CHECK(load_texel(image, 25, 25) == kWhiteAt4);
    CHECK(load_texel(image, 39, 39) == kWhiteAt4);
    CHECK(load_texel(image, 39, 25) == kRedAt6);
    CHECK(load_texel(image, 25, 39) == kRedAt6);
  }
}

TEST_CASE("vertex colours multiply the surface's, alike on all vector units") {
  Scene scene = scene_with_holes();
  scene.materials[0] = scene.materials[1];
  scene.materials[0].diffuse = {1.0f, 0.5f, 0.25f};
  scene.meshes[0].colours = {{1, 0, 1}, {1, 0, 1}, {1, 1, 1}, {1, 1, 1}};
  const Image expected = drawn(scene, Isa::scalar);
  const glm::vec4 middle = load_texel(expected, 32, 32);
  CHECK(middle.x == 1.0f);
  CHECK(middle.y == doctest::Approx(0.25).epsilon(0.02));  // half way from 0 to 1
  CHECK(middle.z == 0.25f);
  for (const Isa isa : available_isas())
    CHECK(hash_image(drawn(scene, isa)) == hash_image(expected));
}

TEST_CASE("an opacity of 1/2 is there, and one below is not") {
  for (const auto& [byte, is_there] : {std::pair{127, false}, {128, true}}) {
    Scene scene = scene_with_holes();
    Image texel = make_image(Format::rgba8, 1, 1);
    for (std::uint8_t& channel : row<std::uint8_t>(texel, 0)) {
      channel = static_cast<std::uint8_t>(byte);
    }
    scene.textures[0] = make_texture(std::move(texel));
    for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::trilinear}) {
      scene.materials[0].opacity_sampler.filter = filter;
      for (const Isa isa : available_isas()) {
        CHECK((load_texel(drawn(scene, isa), 39, 25) == kWhiteAt4) == is_there);
      }
    }
  }
}

TEST_CASE("the opacity texture of a mesh that says nowhere where cuts nothing") {
  Scene scene = scene_with_holes();
  scene.meshes[0].uvs.clear();
  CHECK(load_texel(drawn(scene, Isa::scalar), 39, 25) == kWhiteAt4);
}

TEST_CASE("a hole has the object's number that shows through it") {
  for (const Isa isa : available_isas()) {
    const Scene scene = scene_with_holes();
    ThreadPool pool{2, isa};
    const auto numbers =
        draw_object_numbers(scene, view_of(scene), 0, kSize, kSize, Profile{}, pool);
    CHECK(numbers[25 * kSize + 25] == 1);
    CHECK(numbers[25 * kSize + 39] == 2);
    CHECK(numbers[39 * kSize + 25] == 2);
    CHECK(numbers[39 * kSize + 39] == 1);
  }
}

TEST_CASE("cut-outs drawn in lanes have the scalar form's bits") {
  const Scene scene = load_scene("canopy", scene_search_path({}));
  constexpr int kWidth = 333, kHeight = 250;
  for (const char* profile_name : {"ieee", "llvmpipe", "d3d11", "softpipe"}) {
    const Profile profile = find_profile(profile_name).value();
    ThreadPool scalar{2, Isa::scalar};
    for (const double frame : {0.0, 40.0}) {
      const CameraMatrices view = camera_matrices(scene.camera, frame, kWidth, kHeight);
      const Image expected = draw_scene(scene, view, frame, kWidth, kHeight, profile, scalar);
      for (const Isa isa : available_isas()) {
        ThreadPool pool{2, isa};
        INFO(profile_name, ", ", isa_name(isa), ", frame ", frame);
        CHECK(equal(draw_scene(scene, view, frame, kWidth, kHeight, profile, pool), expected));
      }
    }
  }
}
