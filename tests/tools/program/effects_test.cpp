// softfocus apply and effects, and render --effect.

#include "raster/effects/effect.h"

#include <algorithm>

#include "raster/effects/motion/motion_blur.h"
#include "raster/images/texel.h"
#include "scenes/draw/velocity.h"
#include "scenes/load/load_scene.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tools/pictures/image_file.h"
#include "tools/pictures/picture_notes.h"

using namespace softfocus;
using nlohmann::json;

namespace {

Words applied(const std::string& from, const std::string& to, Words more) {
  more.insert(more.begin(), {"apply", from, "-o", to});
  return more;
}

}  // namespace

TEST_CASE("apply: effects in their order are those of the library") {
  const TemporaryDirectory directory;
  const std::string sharp = directory.file("a.npy"), filtered = directory.file("b.npy");
  REQUIRE(run_program(render("figures", sharp, {"--show", "pinhole"})).status == 0);
  const ProgramRun run = run_program(
      applied(sharp, filtered, {"--effect", "gaussian:sigma=1.5", "--effect", "sharpen"}));
  CHECK(run.status == 0);
  CHECK(run.err == "");
  ThreadPool pool{1};
  const std::array sigma{1.5};
  const Image blurred =
      apply(*find_effect("gaussian"), {read_image_file(sharp).image, sigma, {}}, pool);
  CHECK(equal(read_image_file(filtered).image,
              apply(*find_effect("sharpen"), {blurred, {}, {}}, pool)));
  const auto notes = find_notes(filtered, read_picture_bytes(filtered)).notes;
  REQUIRE(notes);
  CHECK(notes->effects == std::vector<std::string>{"gaussian:sigma=1.5", "sharpen"});
  CHECK(notes->scene == "figures");
}

TEST_CASE("render --effect: what apply gives") {
  const TemporaryDirectory directory;
  const std::string plain = directory.file("a.npy"), applied_file = directory.file("b.npy"),
                    rendered = directory.file("c.npy");
  REQUIRE(run_program(render("figures", plain)).status == 0);
  REQUIRE(run_program(applied(plain, applied_file, {"--effect", "edge-detection"})).status == 0);
  const ProgramRun run = run_program(render("figures", rendered, {"--effect", "edge-detection"}));
  CHECK(run.status == 0);
  CHECK(equal(read_image_file(rendered).image, read_image_file(applied_file).image));
  CHECK_FALSE(equal(read_image_file(rendered).image, read_image_file(plain).image));
}

TEST_CASE("render warns of an order of effects that no camera has, and draws it") {
  const TemporaryDirectory directory;
  const std::string wrong = directory.file("a.npy"), right = directory.file("b.npy");
  const ProgramRun run =
      run_program(render("figures", wrong, {"--effect", "reinhard", "--effect", "bloom"}));
  CHECK(run.status == 0);
  CHECK(contains(run.err,
                 "softfocus: warning: the effect reinhard comes before bloom: a camera has bloom "
                 "first, then reinhard (docs/effects/order.md)\n"));
  const ProgramRun quiet =
      run_program(render("figures", right, {"--effect", "bloom", "--tone-map", "reinhard"}));
  CHECK(quiet.status == 0);
  CHECK_FALSE(contains(quiet.err, "comes before"));
}

TEST_CASE("render and apply --tone-map: the curve comes last") {
  const TemporaryDirectory directory;
  const std::string plain = directory.file("a.npy"), first = directory.file("b.npy"),
                    last = directory.file("c.npy"), rendered = directory.file("d.npy");
  REQUIRE(run_program(render("figures", plain)).status == 0);
  REQUIRE(
      run_program(applied(plain, first, {"--tone-map", "aces", "--effect", "sharpen"})).status ==
      0);
  REQUIRE(run_program(applied(plain, last, {"--effect", "sharpen", "--effect", "aces"})).status ==
          0);
  REQUIRE(run_program(render("figures", rendered, {"--tone-map", "aces", "--effect", "sharpen"}))
              .status == 0);
  CHECK(equal(read_image_file(first).image, read_image_file(last).image));
  CHECK(equal(read_image_file(rendered).image, read_image_file(last).image));
  const ProgramRun wrong = run_program(applied(plain, last, {"--tone-map", "filmic"}));
  CHECK(wrong.status == 2);
  CHECK(contains(wrong.err, "there are none, reinhard, aces, hable"));
}

TEST_CASE("effects in a scene file are those of --effect, which overrules them") {
  const TemporaryDirectory directory;
  const std::string scene = directory.file("a.toml"), plain_scene = directory.file("b.toml");
  const std::string text = R"(
[[light]]
kind = "directional"
direction = [0, 1, 1]
[material.white]
diffuse = [1, 1, 1]
[[object]]
shape = "sphere"
material = "white"
radius = 0.5
)";
  write_file(plain_scene, text);
  write_file(scene,
             text + "[[effect]]\nname = \"gaussian\"\nsigma = 3\n[[effect]]\nname = \"sharpen\"\n");
  const auto picture = [&](const std::string& of, Words more) {
    const std::string file = directory.file("c.npy");
    more.insert(more.begin(), {"render", of, "--size", "40x30", "-o", file});
    const ProgramRun run = run_program(more);
    CAPTURE(run.err);
    REQUIRE(run.status == 0);
    return read_image_file(file).image;
  };
  const Image plain = picture(plain_scene, {});
  CHECK(equal(picture(scene, {}),
              picture(plain_scene, {"--effect", "gaussian:sigma=3", "--effect", "sharpen"})));
  CHECK_FALSE(equal(picture(scene, {}), plain));
  CHECK(equal(picture(scene, {"--effect", "none"}), plain));
  CHECK(equal(picture(scene, {"--effect", "sharpen"}),
              picture(plain_scene, {"--effect", "sharpen"})));
  CHECK(equal(picture(scene, {"--show", "pinhole"}), picture(plain_scene, {"--show", "pinhole"})));

  const auto refused = [&](const std::string& effect, const std::string& what) {
    write_file(scene, text + "[[effect]]\n" + effect);
    const ProgramRun run = run_program({"render", scene, "-o", directory.file("d.png")});
    CHECK(run.status != 0);
    CAPTURE(run.err);
    CHECK(contains(run.err, what));
    CHECK(contains(run.err, "a.toml:"));
  };
  refused("name = \"blom\"\n", "is no effect; there are temporal-aa");
  refused("sigma = 2\n", "is no effect");
  refused("name = \"gaussian\"\nsigma = -1\n", "sigma");
  refused("name = \"sharpen\"\nsigma = 1\n", "sigma");
}

namespace {

/// Turns before the camera, so that most of it moves.
std::string turning_scene(const TemporaryDirectory& directory, const std::string& effect = {}) {
  std::string scene = directory.file("turning.toml");
  write_file(scene, R"(
[camera]
position = [0, 0.3, 2]
near_m = 0.5
far_m = 20
orbit_degrees_per_frame = 3
[[light]]
kind = "directional"
direction = [0, 1, 1]
[material.white]
diffuse = [1, 1, 1]
[[object]]
shape = "cube"
material = "white"
size = 0.7
spin_degrees_per_frame = [0, 20, 0]
)" + effect);
  return scene;
}

Words turned(const std::string& scene, const std::string& file, Words more) {
  more.insert(more.begin(), {"render", scene, "--size", "64x48", "--frame", "3", "--show",
                             "pinhole", "-o", file});
  return more;
}

std::string npy_text(const Image& image) {
  const Bytes bytes = encode_npy(image);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

TEST_CASE("render --effect motion-blur: the library's, of the scene's own velocity") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.npy"), scene_file = turning_scene(directory);
  ThreadPool pool{1};
  const Scene scene = load_scene(scene_file, {});
  const Instant shown = instant_at(scene, 3.0, 64, 48);
  const Image sharp = draw_scene(scene, shown.camera, 3.0, 64, 48, {}, pool);
  for (const Effect& effect : effects()) {
    if (effect.velocity == VelocityOf::nothing) continue;
    CAPTURE(effect.name);
    const std::string text = std::string{effect.name} + ":shutter=1,samples=8";
    const ProgramRun run = run_program(turned(scene_file, file, {"--effect", text}));
    CAPTURE(run.err);
    REQUIRE(run.status == 0);
    const MotionSpan span{instant_at(scene, 2.5, 64, 48), instant_at(scene, 3.5, 64, 48)};
    Image velocity = make_image(Format::rg16f, 64, 48);
    if (effect.velocity == VelocityOf::camera) {
      camera_velocity(camera_motion(scene, shown.camera, span, 64, 48), sharp, velocity, {}, pool);
    } else {
      velocity = draw_velocity(scene, shown, span, 64, 48, {}, pool);
    }
    std::vector<double> numbers{1.0, 8.0, 32.0, 0.1};
    numbers.resize(effect.parameters.size());
    const Image expected = apply(effect, {sharp, numbers, {}, velocity}, pool);
    CHECK(equal(read_image_file(file).image, expected));
    CHECK_FALSE(equal(expected, sharp));
  }
}

TEST_CASE("motion blur in a scene file is that of --effect") {
  const TemporaryDirectory directory;
  const std::string a = directory.file("a.npy"), b = directory.file("b.npy");
  const auto rendered = [&](const std::string& scene, const std::string& file, Words more) {
    more.insert(more.begin(), {"render", scene, "--size", "40x30", "--frame", "2", "-o", file});
    REQUIRE(run_program(more).status == 0);
    return read_image_file(file).image;
  };
  const std::string effect = "[[effect]]\nname = \"motion-blur\"\nshutter = 0.9\n";
  const Image by_scene = rendered(turning_scene(directory, effect), a, {});
  CHECK(equal(by_scene,
              rendered(turning_scene(directory), b, {"--effect", "motion-blur:shutter=0.9"})));
  CHECK_FALSE(equal(by_scene, rendered(turning_scene(directory), b, {})));
}

TEST_CASE("apply --velocity: motion blur of a picture by the motions of a file") {
  const TemporaryDirectory directory;
  const std::string from = directory.file("a.npy"), to = directory.file("b.npy"),
                    motions = directory.file("v.npy");
  REQUIRE(run_program(render("figures", from, {"--show", "pinhole"})).status == 0);
  const Image picture = read_image_file(from).image;
  Image velocity = make_image(Format::rg16f, picture.width, picture.height);
  clear_image(velocity, {14.0f, -6.0f, 0.0f, 1.0f}, {});
  write_file(motions, npy_text(velocity));
  const ProgramRun run = run_program(
      applied(from, to, {"--velocity", motions, "--effect", "motion-blur:shutter=.8,samples=6"}));
  CAPTURE(run.err);
  REQUIRE(run.status == 0);
  ThreadPool pool{1};
  Image expected = make_image(Format::rgba16f, picture.width, picture.height);
  motion_blur({.shutter = 0.8f, .samples = 6}, picture, velocity, expected, {}, pool);
  CHECK(equal(read_image_file(to).image, expected));

  const auto refused = [&](Words words, const std::vector<std::string>& parts) {
    const ProgramRun wrong = run_program(applied(from, directory.file("c.npy"), std::move(words)));
    CHECK(wrong.status == 2);
    CAPTURE(wrong.err);
    for (const std::string& part : parts) CHECK(contains(wrong.err, part));
    CHECK(std::count(wrong.err.begin(), wrong.err.end(), '\n') == 1);
  };
  refused({"--effect", "motion-blur"}, {"motion-blur", "--velocity FILE", "(height, width, 2)"});
  refused({"--effect", "sharpen", "--velocity", motions}, {"--velocity", "motion-blur does"});
  refused({"--effect", "motion-blur:samples=0", "--velocity", motions}, {"samples", "1 to 64"});
  refused({"--effect", "motion-blur", "--velocity", from}, {"holds no motions"});
  const std::string small = directory.file("small.npy");
  write_file(small, npy_text(make_image(Format::rg16f, 4, 3)));
  refused({"--effect", "motion-blur", "--velocity", small}, {"is 4x3", "the picture's size"});
}

TEST_CASE("apply: opacity goes where light goes, and stays where it does not") {
  const TemporaryDirectory directory;
  Image picture = make_image(Format::rgba16f, 9, 1);
  std::vector<float> opacity(9);
  for (std::size_t x = 0; x < 9; ++x) {
    opacity[x] = x < 4 ? 1.0f : 0.0f;
    row<std::uint16_t>(picture, 0)[4 * x] = x < 4 ? 0x3C00 : 0;
  }
  const Bytes bytes = encode_png(picture, opacity);
  const std::string from = directory.file("a.png"), to = directory.file("b.png");
  write_file(from, bytes);
  const auto alphas = [&](const std::string& effect) {
    REQUIRE(run_program(applied(from, to, {"--effect", effect})).status == 0);
    const Image result = read_image_file(to).image;
    std::vector<float> values;
    values.reserve(9);
    for (int x = 0; x < 9; ++x) {
      values.push_back(
          half_to_float(row<std::uint16_t>(result, 0)[static_cast<std::size_t>(4 * x + 3)]));
    }
    return values;
  };
  const std::vector<float> spread = alphas("gaussian-3");
  CHECK(spread[3] == doctest::Approx(0.75).epsilon(0.01));
  CHECK(spread[4] == doctest::Approx(0.25).epsilon(0.02));
  CHECK(alphas("sharpen") == opacity);
}

TEST_CASE("effects: the list, as text and as JSON") {
  const ProgramRun run = run_program({"effects"});
  CHECK(run.status == 0);
  for (const Effect& effect : effects()) CHECK(contains(run.out, std::string{effect.name}));
  const json list = json::parse(run_program({"effects", "--json"}).out);
  CHECK(list.size() == effects().size());
  CHECK(list.back()["parameters"].back().contains("default"));
}

TEST_CASE("effects: what is no effect or no number of it is refused") {
  const TemporaryDirectory directory;
  const std::string from = directory.file("a.png"), to = directory.file("b.png");
  REQUIRE(run_program(render("figures", from)).status == 0);
  const auto refused = [&](Words words, const std::vector<std::string>& parts) {
    const ProgramRun run = run_program(applied(from, to, std::move(words)));
    CHECK(run.status == 2);
    CHECK(run.out == "");
    for (const std::string& part : parts) {
      CAPTURE(run.err);
      CHECK(contains(run.err, part));
    }
    CHECK_FALSE(std::filesystem::exists(to));
  };
  refused({}, {"nothing to apply", "softfocus effects"});
  refused({"--effect", "gausian"}, {"--effect 'gausian'", "did you mean", "gaussian"});
  refused({"--effect", "gaussian:width=3"}, {"width=3", "there are sigma"});
  refused({"--effect", "bloom:strenght=1"}, {"did you mean 'strength'?"});
  refused({"--effect", "gaussian:sigma"}, {"'sigma' is no key=value"});
  refused({"--effect", "gaussian:sigma=-1"}, {"sigma", "0 to 341"});
  refused({"--effect", "gaussian:sigma=nan"}, {"sigma", "0 to 341"});
  refused({"--effect", "gaussian:sigma=1,sigma=2"}, {"twice"});
  refused({"--effect", "sharpen:amount=2"}, {"amount=2", "it takes none"});
  refused({"--effect", "sharpen:"}, {"it takes none"});
  const ProgramRun map =
      run_program(render("figures", to, {"--show", "coc", "--effect", "sharpen"}));
  CHECK(map.status == 2);
  CHECK(contains(map.err, "--effect: a map"));
  const ProgramRun same = run_program(applied(from, from, {"--effect", "sharpen"}));
  CHECK(same.status == 2);
}
