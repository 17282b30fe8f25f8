// Scenes and models with transparent surfaces, from end to end.

#include <doctest/doctest.h>

#include <fstream>
#include <string>

#include "dof/measure/difference.h"
#include "dof/measure/flip.h"
#include "raster/images/texel.h"
#include "tests/support/cli_render.h"

using namespace softfocus;

namespace {

// A white wall at 4 m, and before it a red pane of one half.
std::string with_pane(const TemporaryDirectory& directory, const std::string& of_pane) {
  std::string file = directory.file("pane.toml");
  std::ofstream{file} << "background = [0, 0, 1]\n"
                         "[camera]\nposition = [0, 0, 2]\n"
                         "[material.wall]\nlit = false\ndiffuse = [1, 1, 1]\n"
                         "[material.pane]\nlit = false\ndiffuse = [1, 0, 0]\n" +
                             of_pane +
                             "\n[[object]]\nshape = \"plane\"\nwidth = 9\ndepth = 9\n"
                             "rotation_degrees = [90, 0, 0]\nposition = [0, 0, -2]\n"
                             "material = \"wall\"\n"
                             "[[object]]\nshape = \"plane\"\nwidth = 9\ndepth = 9\n"
                             "rotation_degrees = [90, 0, 0]\nmaterial = \"pane\"\n";
  return file;
}

Image pinhole_of(const std::string& scene, const Words& more = {}) {
  Words words{"--show", "pinhole"};
  words.insert(words.end(), more.begin(), more.end());
  return rendered_picture(scene, words).image;
}

}  // namespace

TEST_CASE("render: a pane of a scene lets through what its opacity leaves") {
  const TemporaryDirectory directory;
  const Image half = pinhole_of(with_pane(directory, "opacity = 0.5"));
  CHECK(load_texel(half, 20, 20) == glm::vec4{1.0f, 0.5f, 0.5f, 2.0f});
  const Image clear = pinhole_of(with_pane(directory, "opacity = 0.25"));
  CHECK(load_texel(clear, 20, 20) == glm::vec4{1.0f, 0.75f, 0.75f, 4.0f});
}

TEST_CASE("render: opacity 1 is the picture without it, and 0 the one without the pane") {
  const TemporaryDirectory directory;
  CHECK(
      equal(pinhole_of(with_pane(directory, "opacity = 1")), pinhole_of(with_pane(directory, ""))));
  const Image none = pinhole_of(with_pane(directory, "opacity = 0"));
  CHECK(load_texel(none, 20, 20) == glm::vec4{1.0f, 1.0f, 1.0f, 4.0f});
}

TEST_CASE("render: the opacity of a model's materials counts") {
  const TemporaryDirectory directory;
  std::ofstream{directory.file("a.mtl")} << "newmtl pane\nKd 1 1 1\nd 0.5\nnewmtl wall\nKd 1 1 1\n";
  const auto model = [&](const std::string& material) {
    const std::string file = directory.file(material + ".obj");
    std::ofstream{file} << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl " + material +
                               "\nf 1 2 3 4\n";
    return pinhole_of(file, {"-q"});
  };
  const Image wall = model("wall"), pane = model("pane");
  CHECK_FALSE(equal(wall, pane));
  const glm::vec4 beside = load_texel(wall, 0, 0);
  CHECK(load_texel(pane, 0, 0) == beside);
  CHECK(load_texel(pane, 24, 16).x ==
        doctest::Approx(0.5f * load_texel(wall, 24, 16).x + 0.5f * beside.x).epsilon(0.001));
}

TEST_CASE("render: glass has the same bits by the scalar form, in lanes and on threads") {
  const Image expected = pinhole_of("glass", {"--isa", "scalar", "--threads", "1"});
  CHECK(equal(pinhole_of("glass", {"--threads", "3"}), expected));
  CHECK(equal(rendered_picture("glass", {"--method", "pinhole"}).image, expected));
}

TEST_CASE("render: filters come nearer to the truth of glass than the sharp picture") {
  const Words lens{"--max-coc", "8", "--coc-scale", "8"};
  const auto by = [&](Words words) {
    words.insert(words.end(), lens.begin(), lens.end());
    return rendered_picture("glass", words).image;
  };
  ThreadPool pool{2};
  const auto error = [&, truth = by({"--method", "accumulation", "--samples", "256"})](
                         const Image& picture) { return mean_flip(picture, truth, pool); };
  const Image sharp = by({"--show", "pinhole"});
  const TemporaryDirectory directory;
  const std::string file = directory.file("sharp.npy");
  for (const char* method : {"disc-layers", "layered"}) {
    CAPTURE(std::string{method});
    const double in_layers = error(by({"--method", method}));
    CHECK(in_layers < 0.7 * error(sharp));
  }
}

TEST_CASE("render: what cannot have each surface's own circle says so") {
  const TemporaryDirectory directory;
  const auto warned = [&](const Words& words, const std::string& scene) {
    const ProgramRun run = run_program(render(scene, directory.file("a.npy"), words));
    CHECK(run.status == 0);
    return run.err;
  };
  CHECK(contains(warned({"--method", "surface-splatting"}, "glass"), "drawn opaque"));
  CHECK(contains(warned({"--method", "two-pass", "--arithmetic", "fixed"}, "glass"),
                 "--arithmetic: a transparent surface"));
  CHECK(contains(warned({"--method", "generalised-diffusion", "--sharp-depths", "1:2"}, "glass"),
                 "--sharp-depths: a transparent surface"));
  CHECK(warned({"--method", "two-pass"}, "glass") == "");
  CHECK(warned({"--method", "surface-splatting"}, "figures") == "");
}
