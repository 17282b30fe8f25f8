// Materials by a user's shaders: what the loader takes and complains of, and that surface.vert and
// surface.frag, as such a material, draw the bits of the usual surface.

#include <doctest/doctest.h>

#include "raster/shaders/glsl/glsl.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/object_numbers.h"
#include "scenes/load/load_scene.h"
#include "tests/support/raster_helpers.h"
#include "tests/support/run_program.h"
#include "tests/support/scene_test_files.h"
#include "tests/support/skip.h"

using namespace softfocus;

namespace {

/// Files beside a scene.
struct Files {
  TemporaryDirectory folder{};

  void write(const std::string& name, const std::string& text) const {
    write_file(folder.file(name), text);
  }
  Scene read(const std::string& text) const { return read_scene_text(text, folder.file("s.toml")); }
  /// The complaint, without the folder.
  std::string complaint(const std::string& text) const {
    std::string said = test::scene_error_of([&] { read(text); });
    const std::string path = folder.path() + "/";
    for (std::size_t at = said.find(path); at != said.npos; at = said.find(path)) {
      said.erase(at, path.size());
    }
    return said;
  }
};

const std::string kObject = "[[object]]\nmaterial = \"m\"\nshape = \"cube\"\n";
const std::string kRed = "#version 330\nout vec4 c;\nvoid main() { c = vec4(1, 0, 0, 0.25); }\n";

std::string project_file(const std::string& path) {
  return read_file(std::string{SOFTFOCUS_TEST_DATA "/../../"} + path);
}

/// surface.vert and surface.frag as they are, with what a driver is given before them.
void write_our_surface(const Files& files) {
  const std::string before =
      "#version 430 core\n#define MAX_LIGHTS 2\n#define TEXTURED\n#define SPECULAR\n";
  files.write("lighting.glsl", project_file("scenes/surfaces/lighting.glsl"));
  files.write("our.vert", before + project_file("scenes/surfaces/surface.vert"));
  files.write("our.frag", before + project_file("scenes/surfaces/surface.frag"));
}

std::string our_scene(const std::string& shaders) {
  return "background = [0.1, 0.2, 0.3]\n[camera]\nposition = [0.3, 0.8, 2.2]\n"
         "target = [0, 0.2, 0]\nfov_degrees = 50\n[lens]\nfocus_m = 2\nf_number = 1.4\n"
         "[[light]]\nkind = \"directional\"\ndirection = [1, 2, 1]\n"
         "[[light]]\nkind = \"point\"\nposition = [-1, 1, 1]\ncolour = [0.2, 0.4, 0.6]\n"
         "[texture.t]\nkind = \"checker\"\nsize = 128\ncolours = [[1, 0.9, 0.2], [0.2, 0.3, 0.9]]\n"
         "[material.m]\ntexture = \"t\"\nspecular = [0.5, 0.4, 0.3]\nshininess = 20\n" +
         shaders +
         "[material.usual]\n"
         "[[object]]\nshape = \"plane\"\nwidth = 6\ndepth = 8\ntexture_repeat = [9, 12]\n"
         "material = \"m\"\n"
         "[[object]]\nshape = \"sphere\"\nradius = 0.3\nposition = [0, 0.3, 0]\n"
         "material = \"usual\"\n"
         "[[object]]\nshape = \"torus\"\nring_radius = 0.3\ntube_radius = 0.1\n"
         "position = [0.7, 0.3, 0.4]\nrotation_degrees = [60, 20, 0]\nmaterial = \"m\"\n";
}
const std::string kOurs = "vertex = \"our.vert\"\nfragment = \"our.frag\"\n";

}  // namespace

TEST_CASE("our own surface shaders as a material draw the bits of the usual surface") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  write_our_surface(files);
  const Scene usual = files.read(our_scene("")), ours = files.read(our_scene(kOurs));
  REQUIRE(ours.materials[0].shaders != nullptr);
  for (const char* const name : {"ieee", "llvmpipe"}) {
    CAPTURE(name);
    const Profile profile = test::profile_named(name);
    const CameraMatrices camera = camera_matrices(usual.camera, 0.0, 200, 150);
    for (const int threads : {1, 4}) {
      ThreadPool pool{threads};
      const std::vector<Image> a = draw_layers(usual, camera, 0.0, 200, 150, 3, profile, pool);
      const std::vector<Image> b = draw_layers(ours, camera, 0.0, 200, 150, 3, profile, pool);
      for (std::size_t layer = 0; layer < 3; ++layer) CHECK(a[layer].bytes == b[layer].bytes);
    }
  }
  // Objects in other colours, too.
  ThreadPool pool{2};
  const CameraMatrices camera = camera_matrices(usual.camera, 0.0, 120, 90);
  CHECK(draw_object_numbers(usual, camera, 0.0, 120, 90, {}, pool) ==
        draw_object_numbers(ours, camera, 0.0, 120, 90, {}, pool));
}

TEST_CASE("a built-in scene by our own shaders has the bits of the built-in surfaces") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  write_our_surface(files);
  const Scene usual = read_scene_file(SOFTFOCUS_TEST_DATA "/../../scenes/interior.toml");
  Scene ours = usual;
  for (Material& material : ours.materials) {
    // One program a material, for what it has; its texture is bound as the loader would.
    std::string before = "#version 430 core\n#define MAX_LIGHTS 8\n";
    if (material.texture) before += "#define TEXTURED\n";
    if (material.lit && material.specular != glm::vec3{0.0f}) before += "#define SPECULAR\n";
    if (material.two_sided) before += "#define TWO_SIDED\n";
    files.write("our.vert", before + project_file("scenes/surfaces/surface.vert"));
    files.write("our.frag", before + project_file("scenes/surfaces/surface.frag"));
    std::string text = "[material.m]\n" + kOurs + kObject;
    if (material.texture) {
      text = "[texture.t]\nkind = \"checker\"\nsize = 2\ncolours = [[0, 0, 0], [1, 1, 1]]\n" + text;
      text.replace(text.find("[material.m]\n"), 13, "[material.m]\ntexture = \"t\"\n");
    }
    const Scene one = files.read(text);
    SurfaceShaders shaders = *one.materials[0].shaders;
    for (ShaderSurfaceTexture& texture : shaders.fragment.textures) {
      texture = {material.texture.value(), material.sampler, true};
    }
    material.shaders = std::make_shared<const SurfaceShaders>(std::move(shaders));
  }
  const CameraMatrices camera = camera_matrices(usual.camera, 3.0, 160, 120);
  ThreadPool pool{2};
  for (const char* const name : {"ieee", "llvmpipe"}) {
    CAPTURE(name);
    const Profile profile = test::profile_named(name);
    CHECK(draw_scene(usual, camera, 3.0, 160, 120, profile, pool).bytes ==
          draw_scene(ours, camera, 3.0, 160, 120, profile, pool).bytes);
  }
}

TEST_CASE("a triangle in shadow has its number in the draw") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  files.write("number.frag",
              "#version 330\nout vec4 c;\nvoid main() { c = vec4(gl_PrimitiveID); }\n");
  Scene scene = files.read(
      "[camera]\nposition = [1, 2, 3]\ntarget = [0, 0, 0]\n[lens]\nfocus_m = 3\n"
      "[[light]]\nkind = \"directional\"\ndirection = [1, 1, -1]\nshadows = \"projected\"\n"
      "[material.m]\nfragment = \"number.frag\"\n"
      "[[object]]\nshape = \"sphere\"\nradius = 1\nmaterial = \"m\"\n");
  ThreadPool pool{1};
  const CameraMatrices camera = camera_matrices(scene.camera, 0.0, 60, 60);
  const Image in_shadow = draw_scene(scene, camera, 0.0, 60, 60, {}, pool);
  scene.lights.clear();
  CHECK(in_shadow.bytes == draw_scene(scene, camera, 0.0, 60, 60, {}, pool).bytes);
}

TEST_CASE("alpha is the depth, and a discarded pixel shows what is behind") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  files.write("red.frag",
              "#version 330\n#include \"least.glsl\"\nin vec2 vUv;\nout vec4 c;\n"
              "uniform float amount;\nvoid main() {\n"
              "  if (gl_FragCoord.y < LEAST) discard;\n  c = vec4(amount, 0, 0, 0.25);\n}\n");
  std::filesystem::create_directory(files.folder.file("lib"));
  files.write("lib/least.glsl", "#define LEAST float(TENS) * 10.0\n");
  const Scene scene = files.read(
      "background = [0, 0, 1]\n[camera]\nposition = [0, 0, 3]\nfar_m = 50\n[material.m]\n"
      "fragment = \"red.frag\"\ndefines = { TENS = 5 }\ninclude = [\"lib\"]\n"
      "[material.m.uniforms]\namount = 0.5\n[[object]]\n"
      "material = \"m\"\nshape = \"cube\"\nsize = 3\nposition = [0, 0, -1.5]\n");
  ThreadPool pool{1};
  const Image picture =
      draw_scene(scene, camera_matrices(scene.camera, 0.0, 100, 100), 0.0, 100, 100, {}, pool);
  CHECK(load_texel(picture, 50, 20) == glm::vec4{0.5f, 0.0f, 0.0f, 3.0f});
  CHECK(load_texel(picture, 50, 80) == glm::vec4{0.0f, 0.0f, 1.0f, 50.0f});
}

TEST_CASE("a material's texture is cut into the faces that its shader reads") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  files.write("six.png", test::png_bytes(6, 1));
  files.write("two.png", test::png_bytes(2, 1));
  files.write("sky.frag",
              "#version 330\nout vec4 c;\nuniform samplerCube sky;\n"
              "void main() { c = texture(sky, vec3(gl_FragCoord.x - 32.0, 0.0, 0.0)); }\n");
  const auto read = [&](const std::string& name) {
    return files.read(
        "[camera]\nposition = [0, 0, 3]\nfar_m = 50\n[material.m]\n"
        "fragment = \"sky.frag\"\n[material.m.textures]\nsky = \"" +
        name + ".png\"\n[[object]]\nmaterial = \"m\"\nshape = \"cube\"\nsize = 3\n" +
        "position = [0, 0, -1.5]\n");
  };
  const Scene scene = read("six");
  ThreadPool pool{1};
  const Image picture =
      draw_scene(scene, camera_matrices(scene.camera, 0.0, 64, 64), 0.0, 64, 64, {}, pool);
  CHECK(load_texel(picture, 40, 32).x == 1.0f);
  CHECK(load_texel(picture, 24, 32).y == 1.0f);
  const std::string said = test::scene_error_of([&] { read("two"); });
  CAPTURE(said);
  CHECK(said.find("sky: is a samplerCube, and its file's 2 x 1 texels are no cube") !=
        std::string::npos);
}

TEST_CASE("opacity blends a surface by shaders") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  files.write("red.frag", kRed);
  const Scene scene = files.read(
      "background = [0, 0, 1]\n[camera]\nposition = [0, 0, 3]\nfar_m = 50\n[material.m]\n"
      "fragment = \"red.frag\"\nopacity = 0.75\n[[object]]\n"
      "material = \"m\"\nshape = \"cube\"\nsize = 3\nposition = [0, 0, -1.5]\n");
  ThreadPool pool{1};
  const Image picture =
      draw_scene(scene, camera_matrices(scene.camera, 0.0, 64, 64), 0.0, 64, 64, {}, pool);
  const glm::vec4 texel = load_texel(picture, 32, 32);
  CHECK(texel.x == 0.75f);
  CHECK(texel.z == 0.25f);
}

TEST_CASE("complaints about shaders of a material name the file and the line") {
  if (!missing_glsl().empty()) return skip("GLSL", missing_glsl());
  const Files files;
  files.write("red.frag", kRed);
  files.write("bad.frag", "#version 330\nout vec4 c;\nvoid main() { c = nothing; }\n");
  files.write("odd.frag",
              "#version 330\nin vec2 odd;\nout vec4 c;\nvoid main() { c = odd.xyxy; }\n");
  files.write("sampled.frag",
              "#version 330\nuniform sampler2D noise;\nuniform vec2 size;\nout vec4 c;\n"
              "void main() { c = texture(noise, size); }\n");
  files.write("other.vert",
              "#version 330\nin vec3 tangent;\nvoid main() { gl_Position = vec4(tangent, 1); }\n");
  files.write("camera.frag",
              "#version 330\nuniform mat3 viewMatrix;\nout vec4 c;\n"
              "void main() { c = vec4(viewMatrix[0], 1); }\n");
  const auto of = [&](const std::string& keys) {
    return files.complaint("[material.m]\n" + keys + kObject);
  };
  CHECK(of("vertex = \"other.vert\"\n") ==
        "s.toml:1: material.m.fragment: is missing; the file of a fragment shader would be right "
        "(docs/shaders.md)");
  CHECK(of("fragment = \"bad.frag\"\n")
            .starts_with(
                "s.toml:2: material.m.fragment: bad.frag:3: 'nothing': undeclared identifier"));
  CHECK(of("fragment = \"odd.frag\"\n")
            .starts_with("s.toml:2: material.m.fragment: the vertex shader has no output 'odd', "
                         "which the fragment "
                         "shader reads; it has 'vUv', "));
  CHECK(of("fragment = \"red.frag\"\nvertex = \"other.vert\"\n") ==
        "s.toml:2: material.m.fragment: the vertex shader reads 'tangent'; meshes have position, "
        "normal, uv and colour");
  CHECK(of("fragment = \"camera.frag\"\n") ==
        "s.toml:2: material.m.fragment: the uniform 'viewMatrix' is given by the scene, as mat4; "
        "another name would be right for another type");
  CHECK(of("fragment = \"sampled.frag\"\n") ==
        "s.toml:1: material.m.textures: the shaders read a texture 'noise'; "
        "material.m.textures.noise = \"FILE.png\" would be right");
  CHECK(of("fragment = \"sampled.frag\"\n[material.m.uniforms]\nsize = [1, 2, 3]\n") ==
        "s.toml:4: material.m.uniforms.size: has 3 numbers; 2 would be right");
  CHECK(of("fragment = \"sampled.frag\"\n[material.m.uniforms]\nsise = [1, 2]\n") ==
        "s.toml:4: material.m.uniforms.sise: the shaders have no uniform of that name; there are "
        "size; did you mean 'size'?");
  CHECK(of("fragment = \"sampled.frag\"\n[material.m.textures]\nnois = \"t.png\"\n") ==
        "s.toml:4: material.m.textures.nois: the shaders have no texture of that name; there are "
        "noise; did you mean 'noise'?");
  CHECK(of("fragment = \"red.frag\"\n[material.m.uniforms]\nmodelMatrix = 1\n") ==
        "s.toml:4: material.m.uniforms.modelMatrix: is given by the scene; another name would be "
        "right");
  CHECK(of("uniforms = { a = 1 }\n").starts_with("s.toml:1: material.m.fragment: is missing"));
  CHECK(of("fragment = \"none.frag\"\n").find("none.frag") != std::string::npos);
}
