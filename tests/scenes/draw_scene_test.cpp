#include "scenes/draw/draw_scene.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/load/load_scene.h"
#include "scenes/surfaces/lighting.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

const Profile kProfile = Profile{};

// A square of 2 x 2 m in the plane z = 0, facing +z.
Mesh square_mesh() {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

// The square seen from 4 m, unlit and white, before a grey background.
Scene square_scene() {
  Scene scene;
  scene.camera = {.position = {0, 0, 4}, .fov_y_degrees = 40, .near_m = 0.5, .far_m = 20};
  scene.background = glm::vec3{0.25f};
  scene.meshes.push_back(square_mesh());
  Material material;
  material.lit = false;
  material.diffuse = glm::vec3{1.0f};
  scene.materials.push_back(material);
  scene.objects.push_back(Object{});
  return scene;
}

Image draw_square(const Scene& scene, int size = 65) {
  ThreadPool pool(1);
  return draw_scene(scene, camera_matrices(scene.camera, 0, size, size), 0, size, size, kProfile,
                    pool);
}

glm::vec4 centre(const Image& image) {
  return load_texel(image, image.width / 2, image.height / 2);
}

}  // namespace

TEST_CASE("alpha holds the depth along the axis, and the far distance where nothing is") {
  const Image image = draw_square(square_scene());
  CHECK(centre(image).w == 4.0f);
  CHECK(load_texel(image, 32, 20).w == 4.0f);  // a plane across the axis: not the ray's length
  CHECK(load_texel(image, 0, 0) == glm::vec4{0.25f, 0.25f, 0.25f, 20.0f});
}

TEST_CASE("a depth that a half cannot hold is the largest half, not infinity") {
  Scene scene = square_scene();
  scene.camera.position = {0, 0, 100000};
  scene.camera.far_m = 1e6;
  scene.objects[0].scale = glm::dvec3{20000};
  const Image image = draw_square(scene);
  CHECK(centre(image) == glm::vec4{1.0f, 1.0f, 1.0f, 65504.0f});
  CHECK(load_texel(image, 0, 0).w == 65504.0f);
}

TEST_CASE("an unlit material is its colour") {
  CHECK(centre(draw_square(square_scene())) == glm::vec4{1.0f, 1.0f, 1.0f, 4.0f});
}

TEST_CASE("a back face is not drawn, unless the material has two sides") {
  Scene scene = square_scene();
  scene.objects[0].rotation_degrees = {0, 180, 0};
  CHECK(centre(draw_square(scene)).x == 0.25f);
  scene.materials[0].two_sided = true;
  CHECK(centre(draw_square(scene)).x == 1.0f);
}

TEST_CASE("a mirrored object still shows its front") {
  Scene scene = square_scene();
  scene.objects[0].scale = {-1, 1, 1};
  CHECK(centre(draw_square(scene)).x == 1.0f);
}

TEST_CASE("each side of a two-sided material is lit as it is seen") {
  Scene scene = square_scene();
  scene.materials[0].lit = true;
  scene.materials[0].two_sided = true;
  scene.materials[0].ambient = glm::vec3{0.0f};
  scene.lights.push_back({LightKind::directional, {0, 0, 1}, glm::vec3{1.0f}});
  CHECK(centre(draw_square(scene)).x == 1.0f);
  scene.objects[0].rotation_degrees = {0, 180, 0};
  CHECK(centre(draw_square(scene)).x == 1.0f);  // its back, which now faces the light
  scene.lights[0].position_or_direction = {0, 0, -1};
  CHECK(centre(draw_square(scene)).x == 0.0f);
}

TEST_CASE("a texture keeps its place: (0, 0) is the image's upper left corner") {
  Scene scene = square_scene();
  Image texels = make_image(Format::rgba8, 2, 2);
  store_texel(texels, 0, 0, {1, 0, 0, 1}, kProfile);
  store_texel(texels, 1, 0, {0, 1, 0, 1}, kProfile);
  store_texel(texels, 0, 1, {0, 0, 1, 1}, kProfile);
  scene.textures.push_back(make_texture(std::move(texels)));
  scene.materials[0].texture = 0;
  scene.materials[0].sampler = {Filter::nearest, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
  const Image image = draw_square(scene);
  CHECK(load_texel(image, 25, 25).x == 1.0f);  // upper left: red
  CHECK(load_texel(image, 39, 25).y == 1.0f);  // upper right: green
  CHECK(load_texel(image, 25, 39).z == 1.0f);  // lower left: blue
}

TEST_CASE("a pixel across two texels has the part of its reads that lie on each") {
  constexpr double kPixelsPerMetre = 65.0 / (2.0 * 4.0 * 0.36397023426620234);  // tan(20 degrees)
  Scene scene = square_scene();
  Image texels = make_image(Format::rgba8, 2, 1);
  store_texel(texels, 0, 0, glm::vec4{0.0f}, kProfile);
  store_texel(texels, 1, 0, glm::vec4{1.0f}, kProfile);
  scene.textures.push_back(make_texture(std::move(texels)));
  scene.materials[0].texture = 0;
  scene.materials[0].sampler = {Filter::nearest, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
  struct Case {
    double seam_px;  // to the right of the centre, or below it
    int reads;
    float value;
  };
  for (const bool upright : {true, false}) {
    if (!upright) scene.meshes[0].uvs = {{1, 0}, {1, 0}, {0, 0}, {0, 0}};
    for (const Case& one : {Case{0.1, 1, 0.0f},
                            {-0.1, 1, 1.0f},
                            {0.2, 2, 0.5f},
                            {0.3, 2, 0.0f},
                            {-0.3, 2, 1.0f},
                            {0.45, 4, 0.0f},
                            {0.2, 4, 0.25f},
                            {0.05, 4, 0.5f},
                            {-0.2, 4, 0.75f},
                            {-0.45, 4, 1.0f}}) {
      CAPTURE(upright);
      CAPTURE(one.seam_px);
      CAPTURE(one.reads);
      const double metres = one.seam_px / kPixelsPerMetre;
      scene.objects[0].position = upright ? glm::dvec3{metres, 0, 0} : glm::dvec3{0, -metres, 0};
      for (const Isa isa : available_isas()) {
        ThreadPool pool{1, isa};
        PreparedScene prepared = prepare_scene(scene, kProfile, pool);
        prepared.texture_reads = one.reads;
        Image image = make_image(Format::rgba16f, 65, 65);
        draw_scene(prepared, camera_matrices(scene.camera, 0, 65, 65), 0, image, pool);
        CHECK(centre(image).x == one.value);
      }
    }
  }
}

TEST_CASE("several reads of textures in lanes have the scalar form's bits") {
  constexpr int kWidth = 165, kHeight = 122;
  for (const char* name : {"cube-room", "canopy"}) {
    const Scene scene = load_scene(name, scene_search_path({}));
    const CameraMatrices view = camera_matrices(scene.camera, 0, kWidth, kHeight);
    for (const char* profile_name : {"ieee", "llvmpipe", "softpipe"}) {
      const Profile profile = find_profile(profile_name).value();
      const auto hash_by = [&](Isa isa, int reads) {
        ThreadPool pool{2, isa};
        PreparedScene prepared = prepare_scene(scene, profile, pool);
        prepared.texture_reads = reads;
        Image image = make_image(Format::rgba16f, kWidth, kHeight);
        draw_scene(prepared, view, 0, image, pool);
        return hash_image(image);
      };
      const auto of_one = hash_by(Isa::scalar, 1);
      for (const int reads : {2, 4}) {
        CAPTURE(name);
        CAPTURE(profile_name);
        CAPTURE(reads);
        const auto expected = hash_by(Isa::scalar, reads);
        CHECK(expected != of_one);
        for (const Isa isa : available_isas()) CHECK(hash_by(isa, reads) == expected);
      }
    }
  }
}

TEST_CASE("a picture with edges reads its textures more than once, and is nearer to many samples") {
  const Scene scene = load_scene("grazing-floor", scene_search_path({}));
  constexpr int kSize = 128, kFiner = 8;
  ThreadPool pool{2};
  const auto drawn = [&](int samples) {
    PreparedScene prepared = prepare_scene(scene, kProfile, pool);
    Image image = make_image(Format::rgba16f, kSize, kSize);
    EdgePictures edges{.samples = samples};
    draw_layers(prepared, camera_matrices(scene.camera, 0, kSize, kSize), 0, image, {}, pool, {},
                samples == 1 ? nullptr : &edges);
    CHECK(prepared.texture_reads == 1);
    return image;
  };
  // Pixels of the mean of many views, each moved within the pixel.
  std::vector<glm::vec3> mean(std::size_t{kSize} * kSize, glm::vec3{0.0f});
  for (int i = 0; i < kFiner * kFiner; ++i) {
    CameraMatrices view = camera_matrices(scene.camera, 0, kSize, kSize);
    const int column = i % kFiner, row = i / kFiner;
    const glm::dvec2 place{(column + 0.5) / kFiner - 0.5, (row + 0.5) / kFiner - 0.5};
    for (int axis = 0; axis < 2; ++axis) view.eye_to_clip[2][axis] += 2.0 * place[axis] / kSize;
    const Image image = draw_scene(scene, view, 0, kSize, kSize, kProfile, pool);
    for (std::size_t at = 0; at < mean.size(); ++at) {
      const auto x = static_cast<int>(at % kSize), y = static_cast<int>(at / kSize);
      mean[at] += glm::vec3{load_texel(image, x, y)} / static_cast<float>(kFiner * kFiner);
    }
  }
  const auto error = [&](const Image& image) {
    double sum = 0.0;
    for (std::size_t at = 0; at < mean.size(); ++at) {
      const auto x = static_cast<int>(at % kSize), y = static_cast<int>(at / kSize);
      const glm::vec3 off = glm::vec3{load_texel(image, x, y)} - mean[at];
      sum += static_cast<double>(glm::dot(off, off));
    }
    return sum;
  };
  const double of_one = error(drawn(1)), of_four = error(drawn(4)), of_eight = error(drawn(8));
  CAPTURE(of_one);
  CAPTURE(of_four);
  CAPTURE(of_eight);
  CHECK(of_four < 0.7 * of_one);
  CHECK(of_eight < 0.9 * of_four);
}

TEST_CASE("normals stay perpendicular under an uneven scale") {
  // A plane tilted by 45 degrees, flattened to a fifth along z: light along its true
  // normal gives full brightness.
  Scene scene = square_scene();
  Mesh& mesh = scene.meshes[0];
  for (glm::vec3& p : mesh.positions) p.z = -p.x;
  const float half = std::sqrt(0.5f);
  mesh.normals.assign(4, {half, 0, half});
  scene.objects[0].scale = {1, 1, 0.2};
  scene.materials[0].lit = true;
  scene.materials[0].ambient = glm::vec3{0.0f};
  scene.lights.push_back({LightKind::directional, {0.2f, 0, 1}, glm::vec3{1.0f}});
  CHECK(centre(draw_square(scene)).x == doctest::Approx(1.0).epsilon(0.001));
}

TEST_CASE("light is ambient plus diffuse by the cosine plus the highlight") {
  Material material;
  material.ambient = {0.1f, 0.2f, 0.3f};
  material.diffuse = {0.5f, 0.5f, 0.5f};
  material.specular = glm::vec3{0.4f};
  material.shininess = 2;
  // 60 degrees from the normal, the eye on the normal: h is 30 degrees off.
  const float sine = std::sqrt(0.75f);
  const Light light{LightKind::directional, {sine, 0, 0.5f}, {1, 2, 0}};
  const LitColour lit =
      light_point(material, glm::vec3{0.5f}, std::span{&light, 1}, {0, 0, 0}, {0, 0, 1}, {0, 0, 1});
  CHECK(lit.base.x == doctest::Approx(0.05 + 0.25));
  CHECK(lit.base.y == doctest::Approx(0.10 + 0.50));
  CHECK(lit.base.z == doctest::Approx(0.15));
  CHECK(lit.specular.x == doctest::Approx(0.4 * 0.75));
  CHECK(lit.specular.y == doctest::Approx(0.8 * 0.75));
}

TEST_CASE("a light behind the surface gives neither diffuse light nor a highlight") {
  Material material;
  material.ambient = glm::vec3{0.0f};
  material.specular = glm::vec3{1.0f};
  const Light light{LightKind::point, {1, 0, -0.01f}, glm::vec3{1.0f}};
  const LitColour lit = light_point(material, glm::vec3{1.0f}, std::span{&light, 1}, {0, 0, 0},
                                    {0, 0, 1}, {-0.6f, 0, 0.8f});
  CHECK(lit.base == glm::vec3{0.0f});
  CHECK(lit.specular == glm::vec3{0.0f});
}

TEST_CASE("a light of no direction and a normal of no length light nothing and break nothing") {
  Material material;
  material.ambient = glm::vec3{0.25f};
  material.specular = glm::vec3{1.0f};
  const Light light{LightKind::directional, {0, 0, 0}, glm::vec3{1.0f}};
  const LitColour dark =
      light_point(material, glm::vec3{1.0f}, std::span{&light, 1}, {0, 0, 0}, {0, 0, 1}, {0, 0, 1});
  CHECK(dark.base == glm::vec3{0.25f});
  const Light sun{LightKind::directional, {0, 0, 1}, glm::vec3{1.0f}};
  const LitColour flat = light_point(material, glm::vec3{1.0f}, std::span{&sun, 1}, {0, 0, 0},
                                     glm::vec3{0.0f}, {0, 0, 1});
  CHECK(flat.base == glm::vec3{0.25f});
}

TEST_CASE("a whole power is the product written out") {
  CHECK(whole_power(0.5f, 1) == 0.5f);
  CHECK(whole_power(0.5f, 10) == 0x1p-10f);
  CHECK(whole_power(3.0f, 5) == 243.0f);
  CHECK(whole_power(1.0f, 1024) == 1.0f);
}

TEST_CASE("no highlight takes numbers below the normal ones, and what is left out is nothing") {
  for (int n = 1; n <= 1024; ++n) {
    const float least = least_highlight(n);
    const float power = whole_power(least, n);
    CHECK(power >= std::numeric_limits<float>::min());
    CHECK(power <= 0x1p-63f);
    // The largest square on the way to the power.
    CHECK(whole_power(least, static_cast<int>(std::bit_floor(static_cast<unsigned>(n)))) >=
          std::numeric_limits<float>::min());
  }
}

TEST_CASE(
    "scenes drawn in lanes have the scalar form's bits, drawn again with the same memory too") {
  for (const char* name : {"cube-room", "figures", "sphere-world"}) {
    ThreadPool scalar{2, Isa::scalar};
    const Scene scene = load_scene(name, scene_search_path({}));
    const int width = 333, height = 250;
    for (const char* profile_name : {"ieee", "llvmpipe"}) {
      const Profile profile = find_profile(profile_name).value();
      for (const Isa isa : available_isas()) {
        if (isa == Isa::scalar) continue;
        ThreadPool pool{2, isa};
        PreparedScene prepared = prepare_scene(scene, profile, pool);
        Image picture = make_image(Format::rgba16f, width, height);
        for (const double frame : {0.0, 40.0, 0.0}) {
          const CameraMatrices view = camera_matrices(scene.camera, frame, width, height);
          draw_scene(prepared, view, frame, picture, pool);
          const Image expected = draw_scene(scene, view, frame, width, height, profile, scalar);
          INFO(name, ", ", profile_name, ", ", isa_name(isa), ", frame ", frame);
          CHECK(equal(picture, expected));
        }
      }
    }
  }
}
