// Pictures carry the lens that they were made with, and compare reads it.

#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tools/pictures/png_text.h"

using namespace softfocus;
using nlohmann::json;

namespace {

const Words kCut{"--max-coc", "4"};

/// Renders `scene` into a file of a folder, without a warning of cut circles.
std::string render_into(const TemporaryDirectory& directory, const std::string& name,
                        const std::string& scene, Words more = {}) {
  more.insert(more.end(), kCut.begin(), kCut.end());
  const ProgramRun run = run_program(render(scene, directory.file(name), more));
  CHECK(run.status == 0);
  CHECK(run.err == "");
  return directory.file(name);
}

json compared(Words words) {
  words.insert(words.begin(), "compare");
  words.emplace_back("--json");
  const ProgramRun run = run_program(words);
  CAPTURE(run.err);
  CHECK(run.status <= 1);
  return json::parse(run.out);
}

}  // namespace

TEST_CASE("render: PNG in itself, PFM and NPY beside them have lens, view, method and hashes") {
  const TemporaryDirectory directory;
  for (const std::string name : {"a.png", "a.pfm", "a.npy"}) {
    CAPTURE(name);
    const std::string file =
        render_into(directory, name, "figures", {"--focus", "1.25", "--method", "two-pass"});
    const std::string bytes = read_file(file);
    const auto text = name == "a.png" ? find_png_text(std::as_bytes(std::span{bytes}), "softfocus")
                                      : std::optional{read_file(file + ".json")};
    REQUIRE(text);
    const json notes = json::parse(*text);
    CHECK(notes["scene"] == "figures");
    CHECK(
        notes["lens"] ==
        json{{"focus_m", 1.25}, {"focal_length_mm", 85.0}, {"f_number", 2.0}, {"coc_scale", 1.0}});
    CHECK(notes["fov_y_degrees"] == 28.0);
    CHECK(notes["method"]["name"] == "two-pass");
    CHECK(notes["method"]["max_coc_px"] == 4.0);
    CHECK(notes["picture_hash"].get<std::string>().starts_with("0x"));
    CHECK(notes.contains("file_hash") == (name != "a.png"));
  }
  CHECK(directory.listing() == Words{"a.npy", "a.npy.json", "a.pfm", "a.pfm.json", "a.png"});
}

TEST_CASE(
    "render: --json gives the camera at the frame, its field of view and the picture's hash") {
  const TemporaryDirectory directory;
  const std::string scene = directory.file("mine.toml");
  write_file(scene, kCube +
                        "[camera]\nposition = [0, 0, 4]\nfov_degrees = 30\nnear_m = 0.5\n"
                        "far_m = 50\norbit_degrees_per_frame = 10\n");
  const auto report = rendered_json(scene, {"--frame", "9", "--max-coc", "4"});
  const auto& camera = report["camera"];
  CHECK(camera["fov_y_degrees"] == 30.0);
  CHECK(camera["position"][0].get<double>() == doctest::Approx(4.0));
  CHECK(camera["position"][2].get<double>() == doctest::Approx(0.0));
  CHECK(camera["target"] == json{0.0, 0.0, 0.0});
  CHECK(camera["up"] == json{0.0, 1.0, 0.0});
  CHECK(camera["near_m"] == 0.5);
  CHECK(camera["far_m"] == 50.0);
  const Picture picture = rendered_picture(scene, {"--frame", "9", "--max-coc", "4"});
  char hash[24];
  std::snprintf(hash, sizeof hash, "0x%016llx",
                static_cast<unsigned long long>(hash_image(picture.image)));
  CHECK(report["picture_hash"] == hash);
}

TEST_CASE("render: a file that is no sidecar stays, with a warning") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.npy.json"), "{\"mine\": 1}");
  Words words = render("figures", directory.file("a.npy"), kCut);
  const ProgramRun run = run_program(words);
  CHECK(run.status == 0);
  CHECK(contains(run.err, "warning: "));
  CHECK(contains(run.err, "a.npy.json"));
  CHECK(read_file(directory.file("a.npy.json")) == "{\"mine\": 1}");
  CHECK(contains(read_file(render_into(directory, "b.npy", "figures") + ".json"), "\"figures\""));
  render_into(directory, "b.npy", "cube-room");
  CHECK(contains(read_file(directory.file("b.npy.json")), "\"cube-room\""));
}

TEST_CASE("compare: --regions takes the lens of B, else of A, else the default, and says so") {
  const TemporaryDirectory directory;
  const std::string a = render_into(directory, "a.npy", "figures");
  const std::string b = render_into(directory, "b.npy", "figures", {"--focus", "1.25"});
  const json of_b = compared({a, b, "--regions"})["lens"];
  CHECK(of_b["focus_m"] == 1.25);
  CHECK(of_b["fov_y_degrees"] == 28.0);
  CHECK(of_b["source"] == "picture");
  CHECK(of_b["name"] == b + ".json");
  const json overruled = compared({a, b, "--regions", "--focus", "3", "--fov", "50"})["lens"];
  CHECK(overruled["focus_m"] == 3.0);
  CHECK(overruled["focal_length_mm"] == 85.0);
  CHECK(overruled["given"] == json{"--focus", "--fov"});
  std::filesystem::remove(b + ".json");
  CHECK(compared({a, b, "--regions"})["lens"]["name"] == a + ".json");
  std::filesystem::remove(a + ".json");
  const json assumed = compared({a, b, "--regions"})["lens"];
  CHECK(assumed["source"] == "default");
  CHECK(assumed["name"].is_null());
  CHECK(contains(run_program({"compare", a, b, "--regions"}).out,
                 "\nlens                50 mm, f/2, focused at 2 m, coc scale 1, field of view 40 "
                 "degrees\n                    assumed: no picture says"));
  const json scene = compared({a, b, "--regions", "--scene", "cube-room"});
  CHECK(scene["lens"]["source"] == "scene");
  CHECK(scene["lens"]["name"] == "cube-room");
  CHECK(scene["lens"]["fov_y_degrees"] == 55.0);
}

TEST_CASE("compare: two lenses, and a sidecar of another picture, are told") {
  const TemporaryDirectory directory;
  const std::string a = render_into(directory, "a.png", "figures");
  const std::string b = render_into(directory, "b.png", "cube-room");
  const ProgramRun run = run_program({"compare", a, b});
  CHECK(contains(run.out, "\nnote                the pictures have different lenses: "));
  CHECK(compared({a, b})["notes"].size() == 1);
  CHECK_FALSE(compared({a, a}).contains("notes"));
  const std::string near = directory.file("near.png");
  CHECK(run_program({"render", "figures", "--size", "64x48", "--focus", "2.0000001", "-o", near})
            .status == 0);
  const std::string at = directory.file("at.png");
  CHECK(run_program({"render", "figures", "--size", "64x48", "--focus", "2", "-o", at}).status ==
        0);
  CHECK_FALSE(compared({near, at}).contains("notes"));
  const std::string c = render_into(directory, "c.npy", "figures");
  const std::string d = render_into(directory, "d.npy", "cube-room");
  std::filesystem::copy_file(c + ".json", d + ".json",
                             std::filesystem::copy_options::overwrite_existing);
  const json found = compared({d, d, "--regions"});
  CHECK(found["lens"]["source"] == "default");
  CHECK(contains(found["notes"][0].get<std::string>(), "of another picture"));
}

TEST_CASE("compare: --diff never writes over what is compared, by whatever name") {
  const TemporaryDirectory directory;
  const std::string a = render_into(directory, "a.png", "figures");
  const std::string b = render_into(directory, "b.png", "cube-room");
  std::filesystem::create_symlink("a.png", directory.file("link.png"));
  std::filesystem::create_hard_link(b, directory.file("hard.png"));
  for (const char* option : {"--diff", "--diff-ulps"}) {
    for (const std::string& map : {a, b, directory.file("link.png"), directory.file("hard.png"),
                                   directory.file("./a.png")}) {
      check_refused(directory, {"compare", a, b, option, map}, 2, {option, map, "write over"});
    }
  }
  check_refused(directory,
                {"compare", a, b, "--diff", directory.file("m.png"), "--diff-ulps",
                 directory.file("./m.png")},
                2, {"--diff", "--diff-ulps", "same file"});
}

TEST_CASE("compare: a map is not written over a texture of --scene") {
  const TemporaryDirectory directory;
  const std::string wood = render_into(directory, "wood.png", "figures");
  const std::string a = render_into(directory, "a.npy", "figures");
  const std::string scene = directory.file("mine.toml");
  write_file(scene, kCube + "[texture.t]\nfile = \"wood.png\"\n");
  const std::string before = read_file(wood);
  check_refused(directory, {"compare", a, a, "--regions", "--scene", scene, "--diff", wood}, 2,
                {"--diff", "wood.png"});
  CHECK(read_file(wood) == before);
}

TEST_CASE("render: never writes over its scene, model, material library, texture or profile") {
  const TemporaryDirectory directory;
  const std::string texture = render_into(directory, "t.png", "figures");
  write_file(directory.file("m.mtl"), "newmtl red\nKd 1 0 0\nmap_Kd t.png\n");
  write_file(directory.file("m.obj"),
             "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl red\nf 1/1 2/1 3/1\n");
  write_file(directory.file("s.toml"),
             "[[object]]\nshape = \"model\"\nfile = \"m.obj\"\n[texture.t]\nfile = \"t.png\"\n");
  write_file(directory.file("p.toml"), "name = \"mine\"\n");
  std::filesystem::create_symlink("t.png", directory.file("link.png"));
  std::filesystem::create_hard_link(directory.file("m.obj"), directory.file("hard.png"));
  const std::string scene = directory.file("s.toml");
  for (const std::string name :
       {"s.toml", "m.obj", "m.mtl", "t.png", "link.png", "hard.png", "./t.png", "p.toml"}) {
    const std::string file = directory.file(name);
    const std::string before = read_file(file);
    check_refused(directory,
                  render(scene, file, {"--format", "png", "--profile", directory.file("p.toml")}),
                  2, {"-o", name, "write over"});
    check_refused(directory,
                  render(scene, directory.file("new.png"),
                         {"--report", file, "--profile", directory.file("p.toml")}),
                  2, {"--report", name, "write over"});
    CHECK(read_file(file) == before);
  }
  check_refused(
      directory,
      render("figures", directory.file("a.npy"), {"--report", directory.file("a.npy.json")}), 2,
      {"--report", "a.npy.json"});
}

TEST_CASE("render: circles that the default cuts are told, with what cuts none") {
  const TemporaryDirectory directory;
  const auto warned = [&](Words more) {
    Words words{"render", "figures", "--size", "96x96", "-o", directory.file("a.png")};
    words.insert(words.end(), more.begin(), more.end());
    return run_program(words).err;
  };
  CHECK(warned({"--f-number", "0.7"}) == "");
  const std::string line = warned({"--f-number", "0.7", "--method", "two-pass"});
  CHECK(is_one_line(line));
  CHECK(contains(line, "--max-coc, 1.5 by default, cuts the circles of "));
  const std::size_t place = line.find("; --max-coc ");
  REQUIRE(place != line.npos);
  const std::string enough = line.substr(place + 12, line.find(" cuts none") - place - 12);
  CHECK(std::stoi(enough) > 4);
  for (const Words& more : {Words{"--f-number", "0.7", "--max-coc", enough},
                            Words{"--f-number", "0.7", "--max-coc", "1"},  // given, so meant
                            Words{"--f-number", "16"}}) {
    Words words = more;
    words.insert(words.end(), {"--method", "two-pass"});
    CHECK(warned(words) == "");
  }
  for (const char* method :
       {"pinhole", "disc-layers", "diffusion", "generalised-diffusion", "auto", "accumulation"}) {
    CAPTURE(method);
    CHECK_FALSE(contains(warned({"--f-number", "0.7", "--method", method}), "--max-coc"));
  }
  CHECK(contains(warned({"--f-number", "0.7", "--method", "scatter"}), "--max-coc"));
  CHECK(warned({"--f-number", "0.7", "--show", "coc"}) == "");
}

TEST_CASE("render: methods of any radius take all circles if no --max-coc is given") {
  for (const std::string method :
       {"disc-layers", "diffusion", "generalised-diffusion", "mipmap", "object-identification"}) {
    CAPTURE(method);
    const Words words{"--method", method, "--f-number", "0.7"};
    Words given = words;
    given.insert(given.end(), {"--max-coc", "1024"});
    CHECK(rendered("figures", words) == rendered("figures", given));
    const auto lens = rendered_json("figures", words)["lens"];
    CHECK(lens["max_coc_px"].get<double>() > 2.0);
  }
}
