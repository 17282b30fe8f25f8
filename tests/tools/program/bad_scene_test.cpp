#include "scenes/scene.h"
#include "tests/support/cli_refused.h"
#include "tools/cli/errors.h"
#include "tools/options/run_options.h"

using namespace softfocus;

namespace {

using Words = std::vector<std::string>;

/// A scene made of these files cannot be rendered: the line names `named`. The first
/// file is the scene.
struct SceneFile {
  std::string name;
  std::string text;
};
void check_scene_refused(const std::vector<SceneFile>& files, const Words& named) {
  const TemporaryDirectory directory;
  for (const SceneFile& file : files) write_file(directory.file(file.name), file.text);
  check_refused(directory,
                {"render", directory.file(files.front().name), "--size", "16x16", "-o",
                 directory.file("out.png")},
                1, named);
}

/// A scene of these files renders.
void check_scene_renders(const std::vector<SceneFile>& files) {
  const TemporaryDirectory directory;
  for (const SceneFile& file : files) write_file(directory.file(file.name), file.text);
  const ProgramRun run = run_program({"render", directory.file(files.front().name), "--size",
                                      "16x16", "-o", directory.file("out.png")});
  CAPTURE(run.err);
  CHECK(run.status == 0);
}

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

const std::string kCube = "[material.m]\n[[object]]\nshape = \"cube\"\nmaterial = \"m\"\n";

/// A scene with a textured cube.
SceneFile textured(const std::string& texture) {
  return {"scene.toml", "[texture.t]\nfile = \"" + texture +
                            "\"\n[material.m]\ntexture = \"t\"\n[[object]]\nshape = \"cube\"\n"
                            "material = \"m\"\n"};
}

/// A whole PNG to cut up.
std::string some_png() {
  return run_program({"render", "figures", "--size", "16x16", "-o", "-"}).out;
}

}  // namespace

TEST_CASE("bad input: a scene's file that is missing or a directory") {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory.file("folder.toml"));
  std::filesystem::create_directory(directory.file("folder.obj"));
  for (const std::string name : {"missing.toml", "missing.obj", "folder.toml", "folder.obj"}) {
    check_refused(directory, {"render", directory.file(name), "-o", directory.file("out.png")}, 1,
                  {name});
  }
}

TEST_CASE("bad input: a TOML scene that is truncated or absurd names the file and the line") {
  check_scene_refused({{"scene.toml", "[[object]\nshape = \"cube\"\n"}}, {"scene.toml", "1"});
  check_scene_refused({{"scene.toml", "title = \"A"}}, {"scene.toml", "1"});
  check_scene_refused({{"scene.toml", std::string("\0\1\2\3\xFF\xFE", 6)}}, {"scene.toml"});
  check_scene_refused(
      {{"scene.toml", "[material.m]\n[[object]]\nmaterial = \"m\"\nshape = \"dodecahedron\"\n"}},
      {"scene.toml:4", "dodecahedron"});
  check_scene_refused({{"scene.toml", "\ncolor = 3\n"}}, {"scene.toml:2", "color"});
  check_scene_refused({{"scene.toml", "[camera]\nfov_degrees = \"wide\"\n"}},
                      {"scene.toml:2", "fov_degrees"});
}

TEST_CASE("bad input: a scene whose numbers cannot be") {
  const auto refused = [](const std::string& text, const std::string& key) {
    check_scene_refused({{"scene.toml", text + "\n" + kCube}}, {"scene.toml", key});
  };
  refused("[lens]\nfocus_m = 0", "focus");
  refused("[lens]\nfocus_m = -3", "focus");
  refused("[lens]\nfocus_m = inf", "focus");
  refused("[lens]\nf_number = 0", "f_number");
  refused("[lens]\nf_number = nan", "f_number");
  refused("[lens]\nfocal_length_mm = 5000\nfocus_m = 2", "focal");
  refused("[lens]\nmax_coc_px = -1", "max_coc_px");
  refused("[camera]\nposition = [nan, 0, 0]", "position");
  refused("[camera]\nposition = [1, 2]", "position");
  refused("[camera]\nnear_m = 0", "near_m");
  refused("[camera]\nnear_m = 5\nfar_m = 4", "far_m");
  refused("[camera]\nfov_degrees = 180", "fov_degrees");
}

TEST_CASE("bad input: an OBJ whose indices are out of range names the file and the line") {
  for (const std::string face :
       {"f 1 2 4", "f 1 2 0", "f 1 2 -4", "f 1 2 99999999999999999999", "f 1//7 2//7 3//7"}) {
    check_scene_refused({{"bad.obj", kTriangle + face + "\n"}}, {"bad.obj:4"});
  }
}

TEST_CASE("bad input: an OBJ with a vertex that is NaN or infinite names the file and the line") {
  for (const std::string vertex : {"v nan 0 0", "v 0 inf 0", "v 0 0 -inf", "v 1e999 0 0"}) {
    check_scene_refused({{"bad.obj", kTriangle + vertex + "\nf 1 2 4\n"}}, {"bad.obj:4"});
  }
}

TEST_CASE("bad input: an OBJ that is empty, truncated or no OBJ at all") {
  check_scene_refused({{"bad.obj", ""}}, {"bad.obj"});
  check_scene_refused({{"bad.obj", kTriangle}}, {"bad.obj"});
  check_scene_refused({{"bad.obj", kTriangle + "f 1 2"}}, {"bad.obj:4"});
  check_scene_refused({{"bad.obj", kTriangle + "f 1 2 x\n"}}, {"bad.obj:4"});
  check_scene_refused({{"bad.obj", "v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}}, {"bad.obj:1"});
  check_scene_refused({{"bad.obj", some_png()}}, {"bad.obj"});
}

TEST_CASE("bad input: an OBJ's harmless faults are no errors") {
  for (const std::string fault :
       {"f 1 2\n", "f 3\n", "vt 1e30 nan\nf 1/1 2/1 3/1\n", "f 1/7 2/7 3/7\n", "f 3 2 1\n"}) {
    check_scene_renders({{"odd.obj", std::string{kTriangle}.append("f 1 2 3\n").append(fault)}});
  }
}

TEST_CASE("bad input: degenerate triangles are legal and draw nothing") {
  check_scene_renders({{"thin.obj", kTriangle + "f 1 2 3\nf 1 1 2\nf 1 2 1\n"}});
}

TEST_CASE("bad input: a texture that is missing, truncated or no picture names its file") {
  check_scene_refused({textured("t.png")}, {"t.png"});
  check_scene_refused({textured("t.png"), {"t.png", ""}}, {"t.png"});
  check_scene_refused({textured("t.jpg"), {"t.jpg", "not a JPEG"}}, {"t.jpg"});
  const std::string png = some_png();
  check_scene_renders({textured("t.png"), {"t.png", png}});
  for (const std::size_t length :
       {std::size_t{7}, std::size_t{20}, std::size_t{40}, png.size() / 2, png.size() - 13}) {
    CAPTURE(length);
    check_scene_refused({textured("t.png"), {"t.png", png.substr(0, length)}}, {"t.png"});
  }
}

TEST_CASE("bad input: a JPEG that is cut short after its headers names its file") {
  // Start of image, a quantisation table that ends too early.
  const std::string jpeg("\xFF\xD8\xFF\xDB\x00\x43\x00\x10\x0B\x0C", 10);
  check_scene_refused({textured("t.jpg"), {"t.jpg", jpeg}}, {"t.jpg"});
}

TEST_CASE("bad scene: what is nearly a name is told with the nearest that exists") {
  const std::string material = "[material.wood]\ndiffuse = [1, 1, 1]\n";
  const std::vector<SceneFile> slips{
      {"[camera]\npositon = [0, 0, 1]\n", "'position'"},
      {"[[light]]\nkind = \"pont\"\n", "'point'"},
      {"[[effect]]\nname = \"blom\"\n", "'bloom'"},
      {"[[effect]]\nname = \"bloom\"\nstrenght = 1\n", "'strength'"},
      {material + "[[object]]\nshape = \"sphere\"\nmaterial = \"wod\"\n", "'wood'"},
      {material + "[[object]]\nshape = \"spere\"\nmaterial = \"wood\"\n", "'sphere'"}};
  for (const auto& [scene, nearest] : slips) {
    check_scene_refused({{"s.toml", scene}}, {"; did you mean " + nearest + "?"});
  }
}

TEST_CASE("bad input: a PNG that claims to be 100,000 x 100,000 names its file") {
  std::string png = some_png();
  png.replace(16, 8, std::string("\x00\x01\x86\xA0\x00\x01\x86\xA0", 8));
  check_scene_refused({textured("t.png"), {"t.png", png}}, {"t.png"});
}

TEST_CASE("bad scene: shadows that need more memory than there is, and what of them is large") {
  Scene scene;
  scene.lights.resize(4096);
  for (Light& light : scene.lights) {
    light.shadows = ShadowKind::map;
    light.map.size = kMostMapSize;
    light.map.cascades = kMostCascades;
  }
  const auto refusal = [&] {
    try {
      check_shadow_memory(scene);
    } catch (const UsageError& error) {
      return std::string{error.what()};
    }
    return std::string{};
  };
  CHECK(contains(refusal(), "4398.05 GB for maps"));
  CHECK(contains(refusal(), "--map size=N"));
  scene.lights.resize(1);
  CHECK(refusal() == "");
  scene.meshes.resize(1);
  scene.meshes[0].indices.resize(3'000'000);
  scene.objects.resize(100'000);
  CHECK(contains(refusal(), "100000000000 triangles"));
  CHECK(contains(refusal(), "coarser meshes"));
  scene.lights[0].shadows = ShadowKind::none;
  CHECK(refusal() == "");
}
