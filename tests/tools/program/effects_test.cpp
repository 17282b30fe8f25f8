// softfocus apply and effects, and render --effect.

#include "raster/effects/effect.h"

#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tools/files/image_file.h"
#include "tools/files/picture_notes.h"

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
  refused("name = \"blom\"\n", "is no effect; there are edge-detection");
  refused("sigma = 2\n", "is no effect");
  refused("name = \"gaussian\"\nsigma = -1\n", "sigma");
  refused("name = \"sharpen\"\nsigma = 1\n", "sigma");
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
  write_file(from, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
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
