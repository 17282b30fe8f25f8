// render --sharp-depths: several depths sharp at once.

#include <cmath>

#include "raster/images/texel.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"

using namespace softfocus;
using nlohmann::json;

namespace {

const Words kMethod{"--method", "generalised-diffusion", "--f-number", "0.5", "--coc-scale", "4"};

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace

TEST_CASE("render: --sharp-depths keeps two ranges sharp at once and blurs the rest") {
  const Picture pinhole = rendered_picture("figures", {"--method", "pinhole"});
  const Picture result =
      rendered_picture("figures", with(kMethod, {"--sharp-depths", "0.7:0.95,1.2:1.8"}));
  int first = 0, second = 0, between = 0, changed = 0, wrong = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const glm::vec4 sharp = load_texel(pinhole.image, x, y);
      const bool same = load_texel(result.image, x, y) == sharp;
      const bool in_first = sharp.w >= 0.7f && sharp.w <= 0.95f;
      const bool in_second = sharp.w >= 1.2f && sharp.w <= 1.8f;
      first += in_first;
      second += in_second;
      wrong += (in_first || in_second) && !same;
      if (sharp.w > 0.96f && sharp.w < 1.19f) {
        ++between;
        changed += !same;
      }
    }
  }
  CHECK(first > 20);
  CHECK(second > 20);
  CHECK(wrong == 0);
  CHECK(between > 20);
  CHECK(changed > 10);  // of the others all neighbours have one colour
}

TEST_CASE("render: notes and reports have --sharp-depths") {
  const TemporaryDirectory directory;
  const Words ranges{"--sharp-depths", "0.5:0.75,2:4"};
  const std::string file = directory.file("a.npy");
  CHECK(run_program(render("figures", file, with(kMethod, ranges))).status == 0);
  const json expected{{0.5, 0.75}, {2.0, 4.0}};
  CHECK(json::parse(read_file(file + ".json"))["method"]["sharp_depths_m"] == expected);
  CHECK(rendered_json("figures", with(kMethod, ranges))["sharp_depths_m"] == expected);
  const ProgramRun run = run_program(render("figures", file, with(kMethod, with(ranges, {"-v"}))));
  CHECK(contains(run.err, "0.5:0.75,2:4 m"));
  CHECK_FALSE(rendered_json("figures", kMethod).contains("sharp_depths_m"));
}

TEST_CASE("render: without --sharp-depths generalised-diffusion is sharp where the lens is") {
  CHECK(rendered("figures", kMethod) != rendered("figures", with(kMethod, {"--focus", "1.5"})));
}

TEST_CASE("render: --sharp-depths takes all circles if no --max-coc is given") {
  const Words words = with(kMethod, {"--sharp-depths", "0.7:0.95"});
  CHECK(rendered("figures", words) == rendered("figures", with(words, {"--max-coc", "1024"})));
  CHECK(rendered("figures", words) != rendered("figures", with(words, {"--max-coc", "1"})));
}

TEST_CASE("bad input: --sharp-depths of no sense") {
  const TemporaryDirectory directory;
  for (const std::string text :
       {"1", "1:", ":1", "1:1", "2:1", "0:1", "-1:2", "1:2,", ",1:2", "1:2,3", "1:2,4:3", "1:2:3",
        "1:inf", "nan:1", "1:1e10", "a:b", "1-2", "1:2;3:4", " 1:2"}) {
    check_refused(
        directory,
        render("figures", directory.file("a.png"), with(kMethod, {"--sharp-depths=" + text})), 2,
        {"--sharp-depths", "'" + text + "'", "NEAR:FAR"});
  }
  check_refused(
      directory,
      render("figures", directory.file("a.png"), with(kMethod, {"--sharp-depths", "0.01:1"})), 2,
      {"--sharp-depths", "0.01 m", "focal length"});
}

TEST_CASE("bad input: --sharp-depths with what does not go with it") {
  const TemporaryDirectory directory;
  const auto refused = [&](const Words& options, const Words& named) {
    check_refused(
        directory,
        render("figures", directory.file("a.png"), with({"--sharp-depths", "1:2"}, options)), 2,
        named);
  };
  for (const std::string method : {"two-pass", "diffusion", "pinhole", "auto", "accumulation"}) {
    refused({"--method", method}, {"--sharp-depths", method, "--method generalised-diffusion"});
  }
  refused(with(kMethod, {"--focus", "1"}), {"--sharp-depths", "--focus", "exclude"});
  refused(with(kMethod, {"--autofocus"}), {"--sharp-depths", "--autofocus", "exclude"});
  refused(with(kMethod, {"--show", "coc"}), {"--sharp-depths", "--show"});
}
