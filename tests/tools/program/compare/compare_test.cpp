#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "raster/images/texel.h"
#include "tests/support/run_program.h"
#include "tools/pictures/image_file.h"

using namespace softfocus;

namespace {

/// 4 x 3, all 0.5, with depth 2 in alpha.
Image grey() {
  Image image = make_image(Format::rgba16f, 4, 3);
  clear_image(image, {0.5f, 0.5f, 0.5f, 2.0f}, {});
  return image;
}

std::uint16_t& value_at(Image& image, int x, int y, int channel) {
  return row<std::uint16_t>(image, y)[static_cast<std::size_t>(4 * x + channel)];
}

void write_picture(const std::string& name, const Image& image) {
  const Bytes bytes = encode(image, *format_by_extension(name));
  write_file(name, bytes);
}

/// `grey()` and the same with two values changed: by 1 half-ULP in (2, 1) green, by 5 in
/// (3, 2) blue.
struct TwoPictures {
  TemporaryDirectory directory;
  std::string a = directory.file("a.npy"), b = directory.file("b.npy");
  TwoPictures() {
    Image image = grey();
    write_picture(a, image);
    value_at(image, 2, 1, 1) += 1;
    value_at(image, 3, 2, 2) -= 5;
    write_picture(b, image);
  }
};

}  // namespace

TEST_CASE("compare: equal pictures are status 0") {
  const TwoPictures files;
  const ProgramRun run = run_program({"compare", files.a, files.a});
  CHECK(run.status == 0);
  CHECK(run.out == "differing values    0 of 48\n");
}

TEST_CASE("compare: different pictures are status 1, and the text says how they differ") {
  const TwoPictures files;
  const ProgramRun run = run_program({"compare", files.a, files.b});
  CHECK(run.status == 1);
  CHECK(run.err == "");
  for (const std::string_view line :
       {"differing values    2 of 48\n", "largest difference  5 half-ULPs\n",
        "first difference    pixel 2,1 channel G: 0.5 and 0.500488\n", "PSNR of colour      ",
        "  0                 46\n", "  1                 1\n", "  4 to 7            1\n"}) {
    CAPTURE(line);
    CHECK(contains(run.out, line));
  }
}

TEST_CASE("compare: --json says the same as values") {
  const TwoPictures files;
  const ProgramRun run = run_program({"compare", files.a, files.b, "--json"});
  CHECK(run.status == 1);
  const auto json = nlohmann::json::parse(run.out);
  CHECK(json["equal"] == false);
  CHECK(json["values"] == 48);
  CHECK(json["differing"] == 2);
  CHECK(json["max_half_ulps"] == 5);
  CHECK(json["first"]["x"] == 2);
  CHECK(json["first"]["y"] == 1);
  CHECK(json["first"]["channel"] == "G");
  CHECK(json["first"]["a"] == 0.5);
  CHECK(json["psnr_db"].is_number());
  CHECK(json["histogram"].size() == 3);
}

TEST_CASE("compare: --json of equal pictures has no first difference and no PSNR") {
  const TwoPictures files;
  const auto json = nlohmann::json::parse(run_program({"compare", files.a, files.a, "--json"}).out);
  CHECK(json["equal"] == true);
  CHECK(json["first"].is_null());
  CHECK(json["psnr_db"].is_null());
}

TEST_CASE("compare: --diff-ulps writes a map that is black but where the pictures differ") {
  const TwoPictures files;
  const std::string map_file = files.directory.file("map.npy");
  CHECK(run_program({"compare", files.a, files.b, "--diff-ulps", map_file}).status == 1);
  const std::string bytes = read_file(map_file);
  const Image map = decode_npy(std::as_bytes(std::span{bytes})).image;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) {
      const glm::vec4 texel = load_texel(map, x, y);
      const bool differs = (x == 2 && y == 1) || (x == 3 && y == 2);
      CHECK((texel.x + texel.y + texel.z > 0.0f) == differs);
    }
  }
}

TEST_CASE("compare: --diff and --diff-ulps can be a PNG or a PFM") {
  const TwoPictures files;
  for (const std::string option : {"--diff", "--diff-ulps"}) {
    for (const std::string name : {"map.png", "map.pfm"}) {
      const std::string map = files.directory.file(option + name);
      run_program({"compare", files.a, files.b, option, map});
      CHECK_NOTHROW(read_image_file(map));
    }
  }
}

TEST_CASE("compare: where a file has no alpha, alpha is not compared") {
  const TemporaryDirectory directory;
  write_picture(directory.file("a.npy"), grey());
  write_picture(directory.file("a.pfm"), grey());
  const ProgramRun run = run_program({"compare", directory.file("a.npy"), directory.file("a.pfm")});
  CHECK(run.status == 0);
  CHECK(run.out == "differing values    0 of 36\n");
}

TEST_CASE("compare: alpha that is not compared is in no count of the histogram") {
  const TwoPictures files;
  write_picture(files.directory.file("a.pfm"), grey());
  const ProgramRun run = run_program({"compare", files.directory.file("a.pfm"), files.b});
  CHECK(run.status == 1);
  CHECK(contains(run.out, "differing values    2 of 36\n"));
  CHECK(contains(run.out, "  0                 34\n"));
}

TEST_CASE("compare: a depth that differs makes two NPY files different") {
  const TemporaryDirectory directory;
  Image image = grey();
  write_picture(directory.file("a.npy"), image);
  value_at(image, 0, 0, 3) += 1;
  write_picture(directory.file("b.npy"), image);
  const ProgramRun run = run_program({"compare", directory.file("a.npy"), directory.file("b.npy")});
  CHECK(run.status == 1);
  CHECK(contains(run.out, "channel A"));
}

TEST_CASE("compare: PNGs are different if one value of 8 bits is") {
  const TemporaryDirectory directory;
  Image image = make_image(Format::rgba16f, 2, 1);
  store_texel(image, 0, 0, {srgb8_to_linear(100), 0.0f, 0.0f, 0.0f}, {});
  write_picture(directory.file("a.png"), image);
  store_texel(image, 0, 0, {srgb8_to_linear(101), 0.0f, 0.0f, 0.0f}, {});
  write_picture(directory.file("b.png"), image);
  CHECK(run_program({"compare", directory.file("a.png"), directory.file("a.png")}).status == 0);
  CHECK(run_program({"compare", directory.file("a.png"), directory.file("b.png")}).status == 1);
}

TEST_CASE("compare: a NaN against a number is a difference, and JSON survives it") {
  const TemporaryDirectory directory;
  Image image = grey();
  write_picture(directory.file("a.npy"), image);
  value_at(image, 1, 1, 0) = 0x7E00;
  write_picture(directory.file("b.npy"), image);
  const ProgramRun run =
      run_program({"compare", directory.file("a.npy"), directory.file("b.npy"), "--json"});
  CHECK(run.status == 1);
  const auto json = nlohmann::json::parse(run.out);
  CHECK(json["first"]["b"].is_null());
  CHECK(json["max_half_ulps"] == 65535);
}

TEST_CASE("compare: two renders of one scene are equal, of two scenes different") {
  const TemporaryDirectory directory;
  const auto render = [&](const char* scene, const char* name) {
    run_program({"render", scene, "--size", "32x32", "-o", directory.file(name)});
    return directory.file(name);
  };
  const std::string one = render("figures", "1.npy"), two = render("figures", "2.npy");
  CHECK(run_program({"compare", one, two}).status == 0);
  CHECK(run_program({"compare", one, render("cube-room", "3.npy")}).status == 1);
}

TEST_CASE("compare: an error is status 2, one line that names the file") {
  const TemporaryDirectory directory;
  const std::string good = directory.file("good.npy");
  write_picture(good, grey());
  write_picture(directory.file("small.npy"), make_image(Format::rgba16f, 3, 3));
  write_file(directory.file("empty.npy"), "");
  write_file(directory.file("junk.png"), "this is no picture");
  write_file(directory.file("cut.npy"), read_file(good).substr(0, 150));
  for (const std::string name : {"small.npy", "empty.npy", "junk.png", "cut.npy", "missing.npy"}) {
    for (const bool first : {true, false}) {
      CAPTURE(name);
      const std::string bad = directory.file(name);
      const ProgramRun run =
          first ? run_program({"compare", bad, good}) : run_program({"compare", good, bad});
      CHECK(run.status == 2);
      CHECK(run.out == "");
      CHECK(is_one_line(run.err));
      CHECK(contains(run.err, name));
    }
  }
}

TEST_CASE("compare: a map that cannot be written is an error, not a difference") {
  const TwoPictures files;
  for (const std::string option : {"--diff", "--diff-ulps"}) {
    for (const std::string map : {"/nowhere/at/all.png", "map.gif"}) {
      const ProgramRun run = run_program({"compare", files.a, files.b, option, map});
      CHECK(run.status == 2);
      CHECK(is_one_line(run.err));
      CHECK(contains(run.err, map));
    }
  }
  CHECK(files.directory.listing() == std::vector<std::string>{"a.npy", "b.npy"});
}
