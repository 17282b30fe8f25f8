#include "tools/goldens/manifest.h"

#include <doctest/doctest.h>

#include "scenes/files/scene_error.h"
#include "tools/cli/errors.h"

using namespace softfocus;

namespace {

constexpr const char* kText = R"(# ours
[[golden]]   # the first
name = "a"   # its name
scene = "figures"
hash = "0x00000000000000aa"

# about b
[[golden]]
name = "b.2"
command = "mine --out {out} \"x\\y\""
picture = "pictures/b.png"
max_flip = 0.25
search = 2

[[golden]]
name = "c"
pipeline = "p.toml"
input = "in.png"
options = "--set a=1"
)";

std::string why_not(const std::string& text) {
  try {
    parse_goldens(text, "f.toml");
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

std::string golden_with(const std::string& lines) {
  return "[[golden]]\nname = \"a\"\n" + lines + "\n";
}

}  // namespace

TEST_CASE("goldens: a manifest has names, makers, what is expected and how far off it may be") {
  const std::vector<Golden> goldens = parse_goldens(kText, "f.toml");
  REQUIRE(goldens.size() == 3);
  CHECK(goldens[0].name == "a");
  CHECK(goldens[0].scene == "figures");
  CHECK(goldens[0].hash == "0x00000000000000aa");
  CHECK(!has_limits(goldens[0].tolerance));
  CHECK(goldens[1].command == "mine --out {out} \"x\\y\"");
  CHECK(goldens[1].picture == "pictures/b.png");
  CHECK(goldens[1].tolerance.max_flip == 0.25);
  CHECK(goldens[1].tolerance.search_px == 2);
  CHECK(goldens[1].tolerance.max_pixels == 0.0);
  CHECK(goldens[2].pipeline == "p.toml");
  CHECK(goldens[2].input == "in.png");
  CHECK(maker_of(goldens[2]) == "pipeline p.toml");
}

TEST_CASE("goldens: what is wrong with a manifest is said with its line and what would be right") {
  const auto says = [](const std::string& lines, const char* part) {
    const std::string why = why_not(golden_with(lines));
    CAPTURE(why);
    CHECK(why.starts_with("f.toml:"));
    CHECK(why.find(part) != std::string::npos);
  };
  says("", "nothing that makes it");
  says("scene = \"x\"\ncommand = \"y {out}\"", "several makers");
  says("shader = \"x.frag\"", "golden.input");
  says("scene = \"x\"\ninput = \"y.png\"", "input");
  says("command = \"render\"", "{out}");
  says("command = \"softfocus render\"\noptions = \"-x\"", "options");
  says("scene = \"x\"\nhash = \"12\"", "16 digits");
  says("scene = \"x\"\nwas = [\"12\"]", "16 digits");
  says("scene = \"x\"\nmax_flip = 0.1", "picture");
  says("scene = \"x\"\nmax_flip = 2", "max_flip");
  says("scene = \"x\"\npicture = \"a\"", "ending");
  says("shader = \"x\"\ninput = \"y/../a.png\"\npicture = \"a.png\"", "input");
  for (const char* share : {"1", "nan%", "101%", "-1%", "%"}) {
    says(std::string{"scene = \"x\"\npicture = \"a.png\"\nmax_pixels = \""} + share + "\"",
         "max_pixels");
  }
  says(
      "scene = \"x\"\npicture = \"a.png\"\n[[golden]]\nname = \"b\"\nscene = \"y\"\n"
      "picture = \"./a.png\"",
      "another golden's");
  says("scene = \"x\"\nmax_flipp = 0.1", "max_flip");
  says("scene = \"x\"\n[[golden]]\nname = \"a\"\nscene = \"y\"", "another golden's");
  CHECK(why_not("[[golden]]\nname = \"../a\"\nscene = \"x\"\n").find("name for files") !=
        std::string::npos);
  CHECK(why_not("[[golden]]\nname = \".a\"\nscene = \"x\"\n") != "");
  CHECK(why_not("[[golden]]\nname = \"-a\"\nscene = \"x\"\n") != "");
  CHECK(why_not("[[golden]]\nscene = \"x\"\n") != "");
  CHECK(why_not("[golden\n").starts_with("f.toml:1"));
}

TEST_CASE("goldens: a new hash changes its line alone, and a new golden is added at the end") {
  std::vector<Golden> goldens = parse_goldens(kText, "f.toml");
  goldens[0].hash = "0x00000000000000bb";
  goldens[0].was = {"0x00000000000000aa"};
  const std::string text = with_golden(kText, goldens[0], "f.toml");
  std::string right = kText;
  const std::string before = "hash = \"0x00000000000000aa\"\n";
  right.replace(right.find(before), before.size(),
                "hash = \"0x00000000000000bb\"\nwas = [\"0x00000000000000aa\"]\n");
  CHECK(text == right);
  goldens[2].hash = "0x00000000000000cc";
  CHECK(with_golden(text, goldens[2], "f.toml") == right + "hash = \"0x00000000000000cc\"\n");

  Golden added;
  added.name = "d";
  added.command = "say \"a b\\c\" > {out}";
  added.picture = "d.png";
  const std::vector<Golden> again = parse_goldens(with_golden(text, added, "f.toml"), "f.toml");
  REQUIRE(again.size() == 4);
  CHECK(again[0].was == std::vector<std::string>{"0x00000000000000aa"});
  CHECK(again[3].command == added.command);
  CHECK(again[3].picture == "d.png");
  CHECK(parse_goldens(with_golden("", added, "f.toml"), "f.toml").size() == 1);
}

TEST_CASE("goldens: a share of the pixels is a text with a sign, as on the command line") {
  const std::vector<Golden> goldens = parse_goldens(
      golden_with("scene = \"x\"\npicture = \"a.png\"\nmax_pixels = \"0.5%\""), "f.toml");
  CHECK(goldens[0].tolerance.max_pixels == 0.5);
  CHECK(goldens[0].tolerance.is_percent);
}

TEST_CASE("goldens: a manifest is changed in the right place, or not at all") {
  const auto changed = [](const std::string& text, std::size_t which) {
    std::vector<Golden> goldens = parse_goldens(text, "f.toml");
    goldens[which].hash = "0x00000000000000bb";
    return with_golden(text, goldens[which], "f.toml");
  };
  // A name in a comment, blanks in the heading, quotes of the other kind, lines that end as on
  // Windows.
  CHECK(changed("[[golden]]\nname = \"a\" # like \"b\"\nscene = \"x\"\n"
                "[[ golden ]] # b\n  name = 'b'\nscene = \"x\"\n",
                1)
            .ends_with("name = 'b'\nscene = \"x\"\nhash = \"0x00000000000000bb\"\n"));
  CHECK(parse_goldens(changed("[[golden]]\r\nname = \"a\"\r\nscene = \"x\"\r\n", 0), "f.toml")[0]
            .hash == "0x00000000000000bb");
  // What would end up in a text, or where keys are written otherwise.
  const auto is_refused = [&](const std::string& text) {
    CHECK_THROWS_AS(changed(text, 0), UsageError);
  };
  is_refused("[[golden]]\nname = \"a\"\ncommand = \"\"\"\n[ -f x ] && cp y {out}\"\"\"\n");
  is_refused("golden = [{name = \"a\", scene = \"x\"}]\n");
  is_refused("[[golden]]\nname = \"a\"\nscene = \"x\"\n\"hash\" = \"0x00000000000000aa\"\n");
}
