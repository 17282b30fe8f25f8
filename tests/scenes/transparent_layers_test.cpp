#include "scenes/draw/transparent_layers.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/load/load_scene.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr int kSide = 65;  // whole tiles and parts of tiles

// Unlit squares that face the camera, each a material of its own, as wide as the picture and more
// unless `scale` says otherwise.
Scene empty_room() {
  Scene scene;
  scene.camera = {.position = {0, 0, 4}, .fov_y_degrees = 40, .near_m = 0.5, .far_m = 20};
  scene.background = {0.0f, 0.0f, 1.0f};
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back(mesh);
  return scene;
}

void add_pane(Scene& scene, double depth_m, glm::vec3 colour, float opacity, double scale = 9.0) {
  Material material;
  material.lit = false;
  material.diffuse = colour;
  material.opacity = opacity;
  scene.materials.push_back(material);
  Object object;
  object.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  object.position = {0, 0, 4.0 - depth_m};
  object.scale = glm::dvec3{scale};
  scene.objects.push_back(object);
}

// A texture of one texel, or of two beside each other.
std::uint32_t add_opacities(Scene& scene, std::initializer_list<float> texels) {
  Image image = make_image(Format::rgba8, static_cast<int>(texels.size()), 1);
  int x = 0;
  for (const float value : texels) store_texel(image, x++, 0, glm::vec4{value}, Profile{});
  scene.textures.push_back(make_texture(std::move(image)));
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

void give_texture(Scene& scene, std::size_t material, std::uint32_t texture) {
  scene.materials[material].opacity_texture = texture;
  scene.materials[material].opacity_sampler = {Filter::nearest, Wrap::clamp_to_edge,
                                               Wrap::clamp_to_edge};
}

CameraMatrices view_of(const Scene& scene) {
  return camera_matrices(scene.camera, 0, kSide, kSide);
}

Image drawn(const Scene& scene, Isa isa = Isa::scalar, const Profile& profile = {}) {
  ThreadPool pool{2, isa};
  return draw_scene(scene, view_of(scene), 0, kSide, kSide, profile, pool);
}

glm::vec4 centre_of(const Image& image) { return load_texel(image, kSide / 2, kSide / 2); }

constexpr glm::vec3 kRed{1.0f, 0.0f, 0.0f}, kGreen{0.0f, 1.0f, 0.0f}, kWhite{1.0f};

}  // namespace

TEST_CASE("transparent: panes before a wall have the colour that a hand computes") {
  Scene scene = empty_room();
  add_pane(scene, 8, kWhite, 1.0f);
  add_pane(scene, 4, kRed, 0.25f);
  add_pane(scene, 2, kGreen, 0.5f);
  for (const Isa isa : available_isas()) {
    CAPTURE(isa_name(isa));
    // White through red is (1, .75, .75); of that half, and half of green.
    CHECK(glm::vec3{centre_of(drawn(scene, isa))} == glm::vec3{0.5f, 0.875f, 0.375f});
  }
}

TEST_CASE("transparent: the order in which objects are drawn does not matter") {
  Scene scene = empty_room();
  add_pane(scene, 2, kGreen, 0.5f, 0.5);
  add_pane(scene, 8, kWhite, 1.0f);
  add_pane(scene, 4, kRed, 0.25f, 1.5);
  add_pane(scene, 3, kRed, 0.7f, 0.9);
  const Image expected = drawn(scene);
  std::sort(scene.objects.begin(), scene.objects.end(),
            [](const Object& a, const Object& b) { return a.material < b.material; });
  do {
    CHECK(equal(drawn(scene), expected));
  } while (std::next_permutation(
      scene.objects.begin(), scene.objects.end(),
      [](const Object& a, const Object& b) { return a.material < b.material; }));
}

TEST_CASE("transparent: what has opacity 0 is as good as not there") {
  Scene scene = empty_room();
  add_pane(scene, 8, kWhite, 1.0f);
  const Image without = drawn(scene);
  add_pane(scene, 2, kGreen, 0.0f);
  CHECK(equal(drawn(scene), without));
  scene.materials[1].opacity = 1.0f;
  give_texture(scene, 1, add_opacities(scene, {0.0f}));
  for (const Isa isa : available_isas()) CHECK(equal(drawn(scene, isa), without));
}

TEST_CASE("transparent: what has opacity 1 all over has an opaque surface's bits") {
  Scene scene = load_scene("figures", scene_search_path({}));
  const Image opaque = drawn(scene);
  const std::uint32_t texture = add_opacities(scene, {1.0f});
  for (std::size_t i = 0; i < scene.materials.size(); ++i) give_texture(scene, i, texture);
  REQUIRE(has_transparent(scene));
  for (const Isa isa : available_isas()) {
    const Image blended = drawn(scene, isa);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        CHECK(glm::vec3{load_texel(blended, x, y)} == glm::vec3{load_texel(opaque, x, y)});
        // From the depth buffer, and not interpolated.
        CHECK(load_texel(blended, x, y).w ==
              doctest::Approx(load_texel(opaque, x, y).w).epsilon(0.001));
      }
    }
  }
}

TEST_CASE("transparent: the texture multiplies the opacity, and where it is 0 there are holes") {
  Scene scene = empty_room();
  add_pane(scene, 8, kWhite, 1.0f);
  add_pane(scene, 4, kRed, 0.5f, 1.0);
  give_texture(scene, 1, add_opacities(scene, {0.0f, 0.2f}));
  for (const Isa isa : available_isas()) {
    const Image image = drawn(scene, isa);
    CHECK(glm::vec3{load_texel(image, 25, 32)} == kWhite);
    CHECK(load_texel(image, 40, 32).x == 1.0f);
    CHECK(load_texel(image, 40, 32).y == doctest::Approx(0.9).epsilon(0.001));
  }
}

TEST_CASE("transparent: a cut-out may be so too, where it is") {
  Scene scene = empty_room();
  add_pane(scene, 8, kWhite, 1.0f);
  add_pane(scene, 4, kRed, 0.5f, 1.0);
  give_texture(scene, 1, add_opacities(scene, {0.4f, 0.6f}));
  scene.materials[1].cut_out = true;
  for (const Isa isa : available_isas()) {
    const Image image = drawn(scene, isa);
    CHECK(glm::vec3{load_texel(image, 25, 32)} == kWhite);
    CHECK(glm::vec3{load_texel(image, 40, 32)} == glm::vec3{1.0f, 0.5f, 0.5f});
  }
}

TEST_CASE("transparent: an opaque thing hides what is behind it and at its depth") {
  Scene scene = empty_room();
  add_pane(scene, 4, kWhite, 1.0f);
  const Image alone = drawn(scene);
  add_pane(scene, 5, kRed, 0.5f);
  add_pane(scene, 4, kGreen, 0.5f);
  for (const Isa isa : available_isas()) CHECK(equal(drawn(scene, isa), alone));
}

TEST_CASE("transparent: of many panes the nearest show") {
  Scene scene = empty_room();
  add_pane(scene, 12, kWhite, 1.0f);
  for (int i = 0; i < 4; ++i) add_pane(scene, 2 + i, kRed, 0.5f);
  const Image four = drawn(scene);
  add_pane(scene, 7, kGreen, 0.5f);
  for (const Isa isa : available_isas()) CHECK(equal(drawn(scene, isa), four));
}

TEST_CASE("transparent: alpha is the depth of the nearest surface of opacity 1/2 or more") {
  Scene scene = empty_room();
  add_pane(scene, 8, kWhite, 1.0f);
  add_pane(scene, 4, kRed, 0.5f);
  add_pane(scene, 2, kGreen, 0.49f);
  CHECK(centre_of(drawn(scene)).w == 4.0f);
  scene.materials[1].opacity = 0.4f;
  CHECK(centre_of(drawn(scene)).w == 8.0f);
  scene.materials[2].opacity = 0.9f;
  CHECK(centre_of(drawn(scene)).w == 2.0f);
}

TEST_CASE("transparent: the same bits in lanes and on threads, for every profile" *
          doctest::test_suite("threads")) {
  const Scene scene = load_scene("glass", scene_search_path({}));
  constexpr int kWidth = 201, kHeight = 150;
  for (const char* profile_name : {"ieee", "llvmpipe", "d3d11", "softpipe"}) {
    const Profile profile = find_profile(profile_name).value();
    ThreadPool scalar{1, Isa::scalar};
    const CameraMatrices view = camera_matrices(scene.camera, 7, kWidth, kHeight);
    const Image expected = draw_scene(scene, view, 7, kWidth, kHeight, profile, scalar);
    for (const Isa isa : available_isas()) {
      for (const int threads : {1, 3}) {
        ThreadPool pool{threads, isa};
        INFO(profile_name, ", ", isa_name(isa), ", ", threads);
        CHECK(equal(draw_scene(scene, view, 7, kWidth, kHeight, profile, pool), expected));
      }
    }
  }
}

TEST_CASE("transparent: a prepared scene draws a second frame as a new one does") {
  const Scene scene = load_scene("glass", scene_search_path({}));
  ThreadPool pool{2};
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  for (const int side : {kSide, 100, kSide}) {
    Image picture = make_image(Format::rgba16f, side, side);
    const CameraMatrices view = camera_matrices(scene.camera, side, side, side);
    draw_scene(prepared, view, side, picture, pool);
    CHECK(equal(picture, draw_scene(scene, view, side, side, side, {}, pool)));
  }
}

TEST_CASE("transparent: a frame's parts, unfiltered, are the picture") {
  const Scene scene = load_scene("glass", scene_search_path({}));
  for (const Isa isa : {Isa::scalar, available_isas().back()}) {
    ThreadPool pool{2, isa};
    for (const char* profile_name : {"ieee", "llvmpipe"}) {
      const Profile profile = find_profile(profile_name).value();
      PreparedScene prepared = prepare_scene(scene, profile, pool);
      FrameParts parts;
      draw_parts(prepared, view_of(scene), 0, kSide, kSide, 1, parts, pool);
      blend(parts, profile, pool);
      const Image picture = drawn(scene, isa, profile);
      CHECK(parts.transparent.size() > 1);
      CHECK(equal(parts.picture(), picture));
      CHECK(equal(filtered_frame(*find_method("pinhole"), scene, view_of(scene), 0, picture, {},
                                 profile, pool),
                  picture));
    }
  }
}

TEST_CASE("transparent: where a layer shows nothing it is black and has the opaque depth") {
  Scene scene = empty_room();
  add_pane(scene, 8, kWhite, 1.0f);
  add_pane(scene, 4, kRed, 0.5f, 0.5);
  ThreadPool pool{2};
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  FrameParts parts;
  draw_parts(prepared, view_of(scene), 0, kSide, kSide, 1, parts, pool);
  blend(parts, {}, pool);
  REQUIRE(parts.transparent.size() == 1);
  const TransparentPicture& layer = parts.transparent[0];
  CHECK(load_texel(layer.colour, 3, 3) == glm::vec4{0.0f, 0.0f, 0.0f, 8.0f});
  CHECK(load_texel(layer.opacity, 3, 3) == glm::vec4{0.0f, 0.0f, 0.0f, 8.0f});
  CHECK(centre_of(layer.colour) == glm::vec4{0.5f, 0.0f, 0.0f, 4.0f});
  CHECK(centre_of(layer.opacity) == glm::vec4{0.5f, 0.5f, 0.5f, 4.0f});
}

TEST_CASE("transparent: a scene without such surfaces has no layers and keeps no depth") {
  const Scene scene = load_scene("canopy", scene_search_path({}));
  CHECK_FALSE(has_transparent(scene));
  ThreadPool pool{2};
  PreparedScene prepared = prepare_scene(scene, {}, pool);
  FrameParts parts;
  draw_parts(prepared, view_of(scene), 0, kSide, kSide, 1, parts, pool);
  blend(parts, {}, pool);
  CHECK(parts.transparent.empty());
  CHECK(parts.blended.bytes.empty());
  CHECK_FALSE(prepared.pass.keep_depth);
}
