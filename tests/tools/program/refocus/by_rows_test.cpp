// softfocus refocus, a band of rows at a time: the files of the whole form, in little memory.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <limits>
#include <thread>

#include "raster/images/texel.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tests/support/random.h"
#include "tests/support/sanitizers.h"
#include "tests/support/skip.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/picture_file.h"

using namespace softfocus;
using nlohmann::json;

namespace {

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Colours that differ from pixel to pixel, and surfaces at 1 to 8 m with steps between them.
struct Scene {
  int width, height;
  Image picture;  ///< depth in alpha
  std::vector<float> depth;

  Scene(int of_width, int of_height)
      : width(of_width), height(of_height), picture(make_image(Format::rgba16f, width, height)) {
    test::Random random{static_cast<std::uint64_t>(1000 * width + height)};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        depth.push_back(1.0f + static_cast<float>((x / 7 + y / 5) % 8) +
                        static_cast<float>(x + y) / 1024.0f);
        store_texel(picture, x, y, {random.unit(), random.unit(), random.unit(), depth.back()}, {});
      }
    }
  }
};

/// Files of a scene in every form that is read by rows.
struct SceneFiles {
  TemporaryDirectory directory;
  Scene scene;

  SceneFiles(int width, int height) : scene(width, height) {
    put("rgba.npy", encode_npy(scene.picture));
    put("c.pfm", encode_pfm(scene.picture));
    put("d.pfm", encode_grey_pfm(scene.depth, width, height));
    put("d.npy", encode_grey_npy(scene.depth, width, height));
    put("c8.npy", bytes_npy());
    if (!missing_exr().empty()) return;
    put("cz.exr", encode_exr(scene.picture, ExrNumbers::half, ""));
    put("d.exr", encode_depth_exr(scene.depth, width, height));
  }

  void put(const std::string& name, const Bytes& bytes) const {
    write_file(directory.file(name), bytes);
  }
  std::string file(const std::string& name) const { return directory.file(name); }

  std::vector<Words> pairs() const {
    std::vector<Words> all{
        {"rgba.npy"}, {"c.pfm", "d.npy"}, {"rgba.npy", "d.pfm"}, {"c8.npy", "d.npy"}};
    if (missing_exr().empty()) {
      all.insert(all.end(), {{"cz.exr"}, {"cz.exr", "d.pfm"}, {"c.pfm", "d.exr"}});
    }
    return all;
  }

  /// These colours in 8 bits.
  Bytes bytes_npy() const {
    Image eight = make_image(Format::rgba8, scene.width, scene.height);
    for (int y = 0; y < scene.height; ++y) {
      for (int x = 0; x < scene.width; ++x) {
        glm::vec4 texel = load_texel(scene.picture, x, y);
        texel.a = 1.0f;
        store_texel(eight, x, y, texel, {});
      }
    }
    return encode_npy(eight);
  }

  Words command(const Words& inputs, const Words& more) const {
    Words words{"refocus"};
    for (const std::string& name : inputs) words.push_back(file(name));
    const bool names_method = std::find(more.begin(), more.end(), "--method") != more.end();
    return joined(words, names_method ? more : joined({"--method", "two-pass"}, more));
  }

  /// --json's report of a run, by rows or not. Its picture is in `out`.
  json run(const Words& inputs, const std::string& out, const Words& more) const {
    const ProgramRun run = run_program(command(inputs, joined(more, {"-o", file(out), "--json"})));
    CAPTURE(run.err);
    REQUIRE(run.status == 0);
    return json::parse(run.out);
  }

  /// That rows give the file which the whole form, at work for standard output, gives.
  void check_same(const Words& inputs, const std::string& out, const std::string& format,
                  const Words& more) const {
    CAPTURE(inputs.front());
    CAPTURE(inputs.back());
    CAPTURE(out);
    const Words options = joined(more, {"--format", format});
    CHECK(run(inputs, out, options)["by_rows"] == true);
    const ProgramRun whole = run_program(command(inputs, joined(options, {"-o", "-"})));
    CHECK(whole.status == 0);
    CHECK(!whole.out.empty());
    // Not CHECK of both: doctest would print them.
    const bool same = whole.out == read_file(file(out));
    CHECK(same);
  }
};

const Words kBlur{"--focus", "3m", "--blur-at-infinity", "9", "--depth-encoding", "metres"};

struct NamedFormat {
  std::string file, format;
};
std::vector<NamedFormat> formats() {
  std::vector<NamedFormat> all{{"o.npy", "npy"}, {"o.pfm", "pfm"}, {"o.hdr", "hdr"}};
  if (missing_exr().empty()) all.insert(all.end(), {{"o.exr", "exr"}, {"p.exr", "exr-float"}});
  return all;
}

}  // namespace

TEST_CASE("by rows: every kind of file in and out has the whole form's bytes") {
  // More rows than two bands, and more columns than a strip.
  const SceneFiles files{133, 131};
  for (const Words& inputs : files.pairs()) {
    for (const NamedFormat& out : formats()) {
      files.check_same(inputs, out.file, out.format, kBlur);
    }
  }
}

TEST_CASE("by rows: any size has the whole form's bytes, circles larger than the picture too") {
  struct Size {
    int width, height;
  };
  for (const Size size : {Size{1, 1}, Size{1, 90}, Size{71, 1}, Size{17, 64}, Size{5, 65}}) {
    const SceneFiles files{size.width, size.height};
    CAPTURE(size.width);
    CAPTURE(size.height);
    for (const std::string radius : {"0", "3", "200"}) {
      const Words blur{"--focus", "3m", "--blur-at-infinity", radius, "--depth-encoding", "metres"};
      files.check_same({"rgba.npy"}, "o.npy", "npy", blur);
      files.check_same({"c.pfm", "d.npy"}, "o.pfm", "pfm", blur);
      if (missing_exr().empty()) files.check_same({"cz.exr"}, "o.exr", "exr", blur);
    }
  }
}

TEST_CASE("by rows: what the whole picture decides is decided alike") {
  SceneFiles files{61, 83};
  const std::vector<Words> all{
      {"--focus-nearest"},
      {"--focus-at", "60,82"},
      {"--f-number", "0.7", "--coc-scale", "3"},
      {"--focus-range", "2m..5m", "--f-number", "0.5"},
      {"--focus", "2m", "--f-number", "0.5", "--highlights", "8,0.5"},
      {"--focus", "4m", "--blur-at-infinity", "500", "--max-coc", "12"},
      {"--focus", "4m", "--blur-at-infinity", "9", "--profile", "d3d11"},
      {"--depth-encoding", "midas", "--near", "1", "--far", "30"},
      {"--depth-encoding", "inverse", "--scale", "0.1"},
      {"--depth-encoding", "metres", "--depth-along", "ray", "--fov", "70"},
      {"--depth-encoding", "white-far", "--near", "1", "--far", "9", "--leak", "0.3"}};
  for (const Words& options : all) {
    CAPTURE(options[0]);
    CAPTURE(options[1 % options.size()]);
    files.check_same({"c.pfm", "d.npy"}, "o.npy", "npy", options);
    if (missing_exr().empty()) files.check_same({"cz.exr", "d.pfm"}, "o.exr", "exr", options);
  }
  // A close-up: other depths with the same circles go through the filter.
  std::vector<float> close = files.scene.depth;
  for (float& metres : close) metres = 2.0f + metres / 1000.0f;
  files.put("d.npy", encode_grey_npy(close, 61, 83));
  files.check_same({"c.pfm", "d.npy"}, "o.npy", "npy",
                   {"--focus", "2m", "--blur-at-infinity", "500"});
  // The sky.
  for (std::size_t i = 0; i < 2000; ++i) close[i] = std::numeric_limits<float>::infinity();
  files.put("d.npy", encode_grey_npy(close, 61, 83));
  files.check_same({"c.pfm", "d.npy"}, "o.pfm", "pfm", kBlur);
}

TEST_CASE("by rows: an EXR keeps its layers, attributes and an opaque alpha") {
  if (!missing_exr().empty()) return;
  const SceneFiles files{45, 70};
  const std::vector<float> ones(45 * 70, 1.0f);
  files.put("a.exr", encode_exr(files.scene.picture, ExrNumbers::single, "",
                                {.alpha = ones, .radii_px = files.scene.depth}));
  files.check_same({"a.exr"}, "o.exr", "exr", kBlur);
  files.check_same({"a.exr"}, "o.exr", "exr", joined(kBlur, {"--no-layers"}));
  files.put("lens.exr", encode_exr(files.scene.picture, ExrNumbers::half, "",
                                   {.lens = ThinLens{85.0, 0.7, 2.5}}));
  files.check_same({"lens.exr"}, "o.exr", "exr", {"--coc-scale", "3"});
  CHECK(files.run({"lens.exr"}, "o.exr", {})["focus_from"] == "the file's focus");
  files.check_same({"a.exr", "d.pfm"}, "o.npy", "npy", kBlur);
  const std::string blender = SOFTFOCUS_TEST_DATA "/blender-cubes/cubes.exr";
  const Words lens{"--method",       "two-pass", "--focus",    "1.6m",
                   "--focal-length", "85mm",     "--f-number", "1.8"};
  const ProgramRun rows =
      run_program(joined({"refocus", blender, "-o", files.file("o.exr"), "--json"}, lens));
  REQUIRE(rows.status == 0);
  CHECK(json::parse(rows.out)["by_rows"] == true);
  const ProgramRun whole =
      run_program(joined({"refocus", blender, "-o", "-", "--format", "exr"}, lens));
  const bool same = whole.out == read_file(files.file("o.exr"));
  CHECK(same);
}

TEST_CASE(
    "by rows: what is transparent is filtered with its alpha, or becomes black with a warning") {
  const SceneFiles files{50, 140};
  test::Random random{5};
  std::vector<float> opacity;
  Image picture = files.scene.picture;
  for (int i = 0; i < 50 * 140; ++i) {
    opacity.push_back(i % 50 < 20 ? random.unit() : static_cast<float>(i / 50 % 2));
    glm::vec4 texel = load_texel(picture, i % 50, i / 50);
    texel.a = opacity.back();
    store_texel(picture, i % 50, i / 50, texel, {});
  }
  files.put("t.npy", encode_npy(picture));
  const Words highlights = joined(kBlur, {"--highlights", "5,0.6"});
  for (const NamedFormat& out : formats()) {
    files.check_same({"t.npy", "d.npy"}, out.file, out.format, kBlur);
    files.check_same({"t.npy", "d.npy"}, out.file, out.format, highlights);
  }
  const ProgramRun run =
      run_program(files.command({"t.npy", "d.npy"}, joined(kBlur, {"-o", files.file("o.npy")})));
  CHECK(contains(run.err, "transparent in places"));
  if (!missing_exr().empty()) return;
  files.put("t.exr", encode_exr(files.scene.picture, ExrNumbers::half, "", {.alpha = opacity}));
  files.check_same({"t.exr"}, "o.exr", "exr", kBlur);
  files.check_same({"t.exr"}, "o.exr", "exr", highlights);
  files.check_same({"t.exr"}, "o.pfm", "pfm", highlights);
}

TEST_CASE("by rows: the sidecar is the whole form's and is the picture's") {
  const SceneFiles files{40, 30};
  files.put("mask.npy", encode_grey_npy(std::vector<float>(1200, 1.0f), 40, 30));
  for (const std::string out : {"o.npy", "o.pfm", "o.hdr"}) {
    CAPTURE(out);
    const std::string sidecar = files.file(out + ".json");
    CHECK(files.run({"c.pfm", "d.npy"}, out, kBlur)["by_rows"] == true);
    const std::string by_rows = read_file(sidecar);
    CHECK(files.run({"c.pfm", "d.npy"}, out,
                    joined(kBlur, {"--mask", files.file("mask.npy")}))["by_rows"] == false);
    CHECK(read_file(sidecar) == by_rows);
    CHECK(contains(run_program({"inspect", files.file(out)}).out, "softfocus wrote it"));
  }
  // And back in: a file with notes is in metres, read by rows.
  files.check_same({"o.npy"}, "q.npy", "npy", {"--focus", "2m", "--f-number", "0.7"});
}

TEST_CASE("by rows: what needs the whole picture gets it, and --json and -v say why") {
  const SceneFiles files{24, 20};
  files.put("c.png", encode_png(files.scene.picture));
  files.put("small.npy", encode_grey_npy(std::vector<float>(120, 2.0f), 12, 10));
  std::vector<float> holed = files.scene.depth;
  holed[7] = std::numeric_limits<float>::quiet_NaN();
  files.put("holed.npy", encode_grey_npy(holed, 24, 20));
  struct Case {
    Words inputs;
    std::string out;
    Words more;
    std::string why;
  };
  const std::vector<Case> cases{{{"rgba.npy"}, "o.npy", {"--method", "disc-layers"}, "disc-layers"},
                                {{"rgba.npy"}, "o.npy", {"--method", "auto"}, "auto"},
                                {{"rgba.npy"}, "o.npy", {"--show", "coc"}, "--show"},
                                {{"rgba.npy"}, "o.npy", {"--border", "mirror"}, "--border"},
                                {{"rgba.npy"}, "o.npy", {"--mend-edges"}, "--mend-edges"},
                                {{"rgba.npy"}, "o.npy", {"--mend-bands"}, "--mend-bands"},
                                {{"rgba.npy"}, "o.npy", {"--arithmetic", "fixed"}, "--arithmetic"},
                                {{"rgba.npy"}, "o.png", {}, "PNG"},
                                {{"c.png", "d.npy"}, "o.npy", {}, "PNG"},
                                {{"c.pfm", "small.npy"}, "o.npy", {}, "another size"},
                                {{"c.pfm", "holed.npy"}, "o.npy", {}, "1 pixels have no depth"}};
  for (const Case& known : cases) {
    CAPTURE(known.why);
    const json said = files.run(known.inputs, known.out, joined(kBlur, known.more));
    CHECK(said["by_rows"] == false);
    CHECK(contains(said["why_whole"].get<std::string>(), known.why));
  }
  // Large circles in a low picture; small ones in it are filtered by rows.
  const SceneFiles low{2000, 8};
  const Words sharp{"--focus", "2m", "--blur-at-infinity", "0", "--max-coc"};
  const json large = low.run({"c.pfm", "d.npy"}, "o.npy", joined(sharp, {"1024"}));
  CHECK(contains(large["why_whole"].get<std::string>(), "1024 pixels"));
  CHECK(low.run({"c.pfm", "d.npy"}, "o.npy", joined(sharp, {"20"}))["by_rows"] == true);
  const ProgramRun run =
      run_program(files.command({"rgba.npy"}, joined(kBlur, {"-o", files.file("o.npy"), "-v"})));
  CHECK(contains(run.err, "a band of rows at a time"));
}

TEST_CASE("by rows: a picture higher than 16384 rows is refocused, or says why it is not") {
  const TemporaryDirectory directory;
  constexpr int kTall = 16384 + 100;
  const std::string colour = directory.file("c.pfm"), depth = directory.file("d.pfm");
  write_file(colour, "PF\n2 " + std::to_string(kTall) + "\n-1.0\n" +
                         std::string(std::size_t{24} * kTall, '\0'));
  const auto put_depth = [&](std::size_t missing) {
    std::vector<float> metres(std::size_t{2} * kTall, 2.0f);
    if (missing != 0) metres[missing] = 0.0f;
    write_file(depth, "Pf\n2 " + std::to_string(kTall) + "\n-1.0\n" +
                          std::string{reinterpret_cast<const char*>(metres.data()),
                                      metres.size() * sizeof(float)});
  };
  put_depth(0);
  const std::string out = directory.file("o.npy");
  const Words command{"refocus", colour, depth, "--depth-encoding", "metres", "-o", out};
  CHECK(run_program(command).status == 0);
  CHECK(std::filesystem::file_size(out) == 128 + std::size_t{16} * kTall);
  std::filesystem::remove(out);
  std::filesystem::remove(out + ".json");
  check_refused(directory, joined(command, {"--method", "disc-layers"}), 1, {"2x16484", "16384"});
  put_depth(100);
  check_refused(directory, command, 2, {"2x16484", "16384", "1 pixels have no depth"});
}

TEST_CASE("by rows: memory does not grow with the picture's height") {
  if (kHasSanitizers) return skip("", "sanitizers take memory of their own");
  // Files without blocks on the disk: black, 1 m away and out of focus by 2 pixels. 20 bytes a
  // pixel, as the whole form takes, would be 335 MB.
  const TemporaryDirectory directory;
  const auto sparse = [&](const std::string& name, const std::string& shape, std::size_t bytes) {
    std::string header = "{'descr': '|u1', 'fortran_order': False, 'shape': (" + shape + "), }";
    header.resize(117, ' ');
    write_file(directory.file(name), std::string{"\x93NUMPY\x01\0\x76\0", 10} + header + "\n");
    std::filesystem::resize_file(directory.file(name), 128 + bytes);
    return directory.file(name);
  };
  constexpr std::size_t kSide = 4096;
  const std::string colour = sparse("c.npy", "4096, 4096, 3", 3 * kSide * kSide);
  const std::string depth = sparse("d.npy", "4096, 4096", kSide * kSide);
  const std::string out = directory.file("o.npy");
  const Words command{
      "refocus", colour,  depth, "-o",      out, "--depth-encoding",   "white-far", "--near",
      "1",       "--far", "9",   "--focus", "2", "--blur-at-infinity", "2",         "--json"};
  const ProgramRun run = run_program(joined(command, {"--method", "two-pass"}));
  CHECK(run.status == 0);
  CHECK(std::filesystem::file_size(out) == 128 + 8 * kSide * kSide);
  CHECK(run.peak_kib < 100 * 1024);
  // Without --method so it is where the usual method finds no room.
  const ProgramRun low = run_program(command, {.memory_limit = 60 * kSide * kSide});
  REQUIRE(low.status == 0);
  CHECK(low.peak_kib < 100 * 1024);
  CHECK(json::parse(low.out)["by_rows"] == true);
  CHECK(json::parse(low.out)["method"] == "two-pass");
  const json high = json::parse(run_program(command).out);
  CHECK(high["by_rows"] == false);
  CHECK(high["method"] == "disc-layers");
}

TEST_CASE("bad input: by rows, a file cut short and a full disk leave nothing") {
  const SceneFiles files{64, 200};
  for (const NamedFormat& out : formats()) {
    CAPTURE(out.file);
    check_refused(files.directory,
                  files.command({"c.pfm", "d.npy"}, joined(kBlur, {"-o", files.file(out.file),
                                                                   "--format", out.format})),
                  1, {out.file, "larger files"}, {.file_size_limit = 8000});
  }
  check_refused(files.directory,
                files.command({"c.pfm", "d.npy"}, joined(kBlur, {"-o", files.file("c.pfm")})), 2,
                {"-o", "write over"});
  if (missing_exr().empty()) {
    // Its header is whole, and rows in the middle are not.
    const std::string whole = read_file(files.file("cz.exr"));
    for (const std::size_t length : {whole.size() / 2, whole.size() - 3}) {
      write_file(files.file("cut.exr"), whole.substr(0, length));
      check_refused(files.directory,
                    files.command({"cut.exr"}, joined(kBlur, {"-o", files.file("o.exr")})), 1,
                    {"cut.exr"});
      check_refused(files.directory,
                    files.command({"cut.exr", "d.npy"}, joined(kBlur, {"-o", files.file("o.exr")})),
                    1, {"cut.exr"});
    }
  }
}

TEST_CASE("by rows: an interrupt in the middle leaves nothing") {
  const SceneFiles files{400, 4000};
  const std::vector<std::string> before = files.directory.listing();
  Words words = files.command({"c.pfm", "d.npy"}, joined(kBlur, {"-o", files.file("o.pfm")}));
  words.insert(words.begin(), SOFTFOCUS_PROGRAM);
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execv(SOFTFOCUS_PROGRAM, argv.data());
    ::_exit(126);
  }
  // As soon as something was written.
  const auto is_writing = [&] {
    for (const std::string& name : files.directory.listing()) {
      std::error_code gone;
      if (name.starts_with(".softfocus-") &&
          std::filesystem::file_size(files.file(name), gone) > 100000 && !gone) {
        return true;
      }
    }
    return false;
  };
  for (int wait = 0; wait < 5000 && !is_writing(); ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
  ::kill(child, SIGTERM);
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK(WIFSIGNALED(status));
  CHECK(files.directory.listing() == before);
}
