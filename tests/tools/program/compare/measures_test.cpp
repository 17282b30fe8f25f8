#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "dof/measure/point_image.h"
#include "tests/support/cli_refused.h"
#include "tests/support/measure_pictures.h"
#include "tools/pictures/image_file.h"

using namespace softfocus;
using doctest::Approx;
using Words = std::vector<std::string>;

namespace {

struct PictureFiles {
  TemporaryDirectory directory;

  std::string write(const std::string& name, const Image& image) const {
    const Bytes bytes = encode(image, *format_by_extension(name));
    write_file(directory.file(name), bytes);
    return directory.file(name);
  }
};

nlohmann::json compare_json(Words arguments) {
  arguments.insert(arguments.begin(), "compare");
  arguments.emplace_back("--json");
  const ProgramRun run = run_program(arguments);
  CAPTURE(run.err);
  CHECK(run.err == "");
  return nlohmann::json::parse(run.out);
}

/// Grey; in focus at 2 m in the left half, at 4 m in the right.
Image two_depths(float grey) {
  Image image = plain_grey(200, 16, grey);
  set_depth(image, [](int x, int) { return x < 100 ? 2.0f : 4.0f; });
  return image;
}

const nlohmann::json& region_of(const nlohmann::json& json, const std::string& name) {
  for (const auto& region : json["regions"]) {
    if (region["region"] == name) return region;
  }
  throw std::runtime_error("no region " + name);
}

}  // namespace

TEST_CASE("compare: the text has every measure of the whole") {
  const PictureFiles files;
  const std::string a = files.write("a.npy", plain_grey(20, 20, 0.5f));
  const std::string b = files.write("b.npy", plain_grey(20, 20, 0.25f));
  const ProgramRun run = run_program({"compare", a, b});
  CHECK(run.status == 1);
  for (const std::string_view line :
       {"PSNR of colour      12.0412 dB\n", "PSNR, tone-mapped   ", "MSE of colour       0.0625\n",
        "MSE, tone-mapped    ", "SSIM                0.", "FLIP                0.45185\n"}) {
    CAPTURE(line);
    CHECK(contains(run.out, line));
  }
  CHECK(!contains(run.out, "HDR-FLIP"));
  CHECK(contains(run_program({"compare", a, b, "--hdr"}).out, "\nHDR-FLIP            0."));
}

TEST_CASE("compare: --json has every measure of the whole as a number") {
  const PictureFiles files;
  const std::string a = files.write("a.npy", plain_grey(20, 20, 0.0f));
  const std::string b = files.write("b.npy", plain_grey(20, 20, 1.0f));
  const auto json = compare_json({a, b, "--hdr"});
  CHECK(json["mse"] == 1.0);
  CHECK(json["psnr_db"] == Approx(0.0));
  CHECK(json["tone_mapped_mse"].is_number());
  CHECK(json["tone_mapped_psnr_db"].is_number());
  CHECK(json["ssim"].get<double>() == Approx(0.0001 / 1.0001).epsilon(1e-6));
  CHECK(json["flip"].get<double>() == Approx(0.9673797615193832).epsilon(1e-6));
  CHECK(json["hdr_flip"].get<double>() > 0.9);
  CHECK(!json.contains("regions"));
  CHECK(!compare_json({a, b}).contains("hdr_flip"));
}

TEST_CASE("compare: --json of equal pictures has measures without a fault") {
  const PictureFiles files;
  const std::string a = files.write("a.npy", random_scene_image(20, 20, 1));
  const auto json = compare_json({a, a});
  CHECK(json["mse"] == 0.0);
  CHECK(json["tone_mapped_psnr_db"].is_null());
  CHECK(json["ssim"] == 1.0);
  CHECK(json["flip"] == 0.0);
}

TEST_CASE("compare: nearer, fine differences show more") {
  const PictureFiles files;
  const auto stripes = [](int odd) {
    return grey_picture(40, 40, [=](int x, int) { return x % 2 == odd ? 0.2 : 0.6; });
  };
  const std::string a = files.write("a.npy", stripes(0)), b = files.write("b.npy", stripes(1));
  const auto flip = [&](const char* pixels_per_degree) {
    return compare_json({a, b, "--pixels-per-degree", pixels_per_degree})["flip"].get<double>();
  };
  CHECK(flip("20") > flip("120"));
}

TEST_CASE("compare: --diff writes FLIP as a heat map, black where nothing is seen") {
  const PictureFiles files;
  Image image = plain_grey(60, 20, 0.25f);
  const std::string a = files.write("a.npy", image);
  for (int y = 5; y < 15; ++y) store_texel(image, 10, y, {1.0f, 0.0f, 0.0f, 2.0f}, {});
  const std::string b = files.write("b.npy", image);
  const std::string map_file = files.directory.file("map.npy");
  run_program({"compare", a, b, "--diff", map_file});
  const Image map = read_image_file(map_file).image;
  const auto light = [&](int x, int y) {
    const glm::vec4 t = load_texel(map, x, y);
    return t.x + t.y + t.z;
  };
  CHECK(light(10, 10) > 0.3f);
  CHECK(light(12, 10) > 0.0f);  // the eye blurs
  CHECK(light(10, 10) > light(14, 10));
  CHECK(light(40, 10) == 0.0f);
}

TEST_CASE("compare: --diff of equal pictures is written, and black") {
  const PictureFiles files;
  const std::string a = files.write("a.npy", random_scene_image(20, 10, 1));
  const std::string map_file = files.directory.file("map.npy");
  const ProgramRun run = run_program({"compare", a, a, "--diff", map_file});
  CHECK(run.status == 0);
  CHECK(run.out == "differing values    0 of 800\n");
  const Image map = read_image_file(map_file).image;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) CHECK(load_texel(map, x, y).z == 0.0f);
  }
}

TEST_CASE("compare: --regions finds a fault in the region where it is") {
  const PictureFiles files;
  Image image = two_depths(0.5f);
  const std::string b = files.write("b.npy", image);
  for (int y = 0; y < 16; ++y) store_texel(image, 190, y, {1.0f, 1.0f, 1.0f, 4.0f}, {});
  const std::string a = files.write("a.npy", image);
  const Words lens{a, b, "--regions", "--focus", "2", "--coc-scale", "20"};
  const auto json = compare_json(lens);
  CHECK(json["regions"].size() == 5);
  CHECK(region_of(json, "far")["flip"].get<double>() > 0.0);
  CHECK(region_of(json, "far")["mse"].get<double>() > 0.0);
  CHECK(region_of(json, "far")["psnr_db"].is_number());
  CHECK(region_of(json, "focus")["flip"] == 0.0);
  CHECK(region_of(json, "focus")["psnr_db"].is_null());  // infinite
  CHECK(region_of(json, "silhouette")["ssim"] == 1.0);
  CHECK(region_of(json, "near")["pixels"] == 0);
  CHECK(region_of(json, "near")["flip"].is_null());
  std::uint64_t pixels = 0;
  for (const auto& region : json["regions"]) pixels += region["pixels"].get<std::uint64_t>();
  CHECK(pixels == 200 * 16);
}

TEST_CASE("compare: --regions follows the lens") {
  const PictureFiles files;
  const std::string a = files.write("a.npy", two_depths(0.5f));
  const auto pixels = [&](const Words& lens, const char* region) {
    Words words{a, a, "--regions"};
    words.insert(words.end(), lens.begin(), lens.end());
    return region_of(compare_json(words), region)["pixels"].get<int>();
  };
  CHECK(pixels({"--coc-scale", "0"}, "focus") == 3200 - 2 * 16);
  CHECK(pixels({"--coc-scale", "0"}, "edge") == 2 * 16);
  CHECK(pixels({"--focus", "4", "--coc-scale", "20"}, "near") > 1000);
  CHECK(pixels({"--focus", "4", "--coc-scale", "20"}, "focus") > 1000);
  CHECK(pixels({"--focus", "2", "--coc-scale", "20"}, "far") > 1000);
  // Each makes the circles smaller.
  const auto band = [&](const Words& more) {
    Words words{"--focus", "2", "--coc-scale", "100"};
    words.insert(words.end(), more.begin(), more.end());
    return pixels(words, "silhouette");
  };
  const int widest = band({});
  CHECK(widest > 0);
  CHECK(band({"--f-number", "4"}) < widest);
  CHECK(band({"--focal-length", "25"}) < widest);
  CHECK(band({"--fov", "80"}) < widest);
}

TEST_CASE("compare: --regions in text is a row a region") {
  const PictureFiles files;
  const std::string a = files.write("a.npy", two_depths(0.5f));
  const ProgramRun run = run_program({"compare", a, a, "--regions"});
  CHECK(run.status == 0);
  for (const char* start : {"differing values    0 of", "\nregion ", "\nsilhouette ", "\nnear ",
                            "\nfocus ", "\nfar "}) {
    CAPTURE(start);
    CHECK(contains(run.out, start));
  }
}

TEST_CASE("compare: --regions takes depth from B, else from A, or from --depth") {
  const PictureFiles files;
  const std::string deep = files.write("deep.npy", two_depths(0.5f));
  const std::string flat = files.write("flat.png", two_depths(0.5f));
  const auto has_band = [&](const Words& words) {
    return region_of(compare_json(words), "silhouette")["pixels"].get<int>() > 0;
  };
  CHECK(has_band({flat, deep, "--regions", "--coc-scale", "20"}));
  CHECK(has_band({deep, flat, "--regions", "--coc-scale", "20"}));
  CHECK(has_band({flat, flat, "--regions", "--coc-scale", "20", "--depth", deep}));
}

TEST_CASE("compare: --point tells how much light is left and how round it is") {
  const PictureFiles files;
  const std::string b = files.write("b.npy", grey_picture(40, 40, [](int x, int y) {
                                      return disc_coverage(x, y, 20.0, 20.0, 8.0);
                                    }));
  const std::string a = files.write("a.npy", grey_picture(40, 40, [](int x, int y) {
                                      return x >= 10 && x < 30 && y >= 15 && y < 25 ? 0.5 : 0.0;
                                    }));
  const auto json = compare_json({a, b, "--point", "8"})["point"];
  CHECK(json["disc_radius_px"] == 8.0);
  CHECK(json["energy_ratio"].get<double>() == Approx(100.0 / (3.14159265 * 64.0)).epsilon(0.01));
  CHECK(json["b"]["eigenvalue_ratio"].get<double>() == Approx(1.0).epsilon(1e-6));
  CHECK(json["b"]["radius_px"].get<double>() == Approx(8.0).epsilon(0.01));
  CHECK(json["b"]["disc_deviation"].get<double>() < 1e-3);
  CHECK(json["a"]["eigenvalue_ratio"].get<double>() == Approx(99.0 / 399.0).epsilon(1e-6));
  CHECK(json["a"]["disc_deviation"].get<double>() > 0.3);
  const ProgramRun run = run_program({"compare", a, b, "--point", "8"});
  CHECK(contains(run.out, "\nenergy of A over B  0.49"));
  CHECK(contains(run.out, "\n  from the disc "));
}

TEST_CASE("compare: --point of black pictures has dashes and nulls") {
  const PictureFiles files;
  const std::string black = files.write("black.npy", plain_grey(8, 8, 0.0f));
  CHECK(compare_json({black, black, "--point", "2"})["point"]["energy_ratio"].is_null());
  CHECK(contains(run_program({"compare", black, black, "--point", "2"}).out,
                 "energy of A over B  -\n"));
}

TEST_CASE("compare: --flicker is 0 and status 0 for what moves as the truth does") {
  const PictureFiles files;
  Words words{"compare", "--flicker"};
  for (const float grey : {0.5f, 0.25f, 0.75f}) {
    words.push_back(
        files.write("i" + std::to_string(words.size()) + ".npy", plain_grey(6, 5, grey)));
  }
  words.emplace_back("--against");
  for (std::size_t i = 2; i < 5; ++i) words.push_back(words[i]);
  const ProgramRun run = run_program(words);
  CHECK(run.status == 0);
  CHECK(run.out == "flicker             0 a step, over 3 frames\n");
}

TEST_CASE("compare: --flicker is the mean change that the truth does not have") {
  const PictureFiles files;
  // The sRGB curve leaves 0 and 1 where they are.
  const std::string dark = files.write("dark.npy", plain_grey(6, 5, 0.0f));
  const std::string white = files.write("white.npy", plain_grey(6, 5, 1.0f));
  const ProgramRun run = run_program(
      {"compare", "--flicker", dark, white, white, "--against", dark, dark, dark, "--json"});
  CHECK(run.status == 1);
  const auto json = nlohmann::json::parse(run.out);
  CHECK(json["frames"] == 3);
  CHECK(json["flicker"].get<double>() == Approx(0.5).epsilon(1e-9));
  CHECK(json["steps"][0].get<double>() == Approx(1.0).epsilon(1e-9));
  CHECK(json["steps"][1] == 0.0);
}

TEST_CASE("bad input: compare's options that need or exclude each other") {
  const PictureFiles files;
  const std::string a = files.write("a.npy", two_depths(0.5f));
  const std::string small = files.write("small.npy", plain_grey(8, 8, 0.5f));
  const auto refuse = [&](Words words, const Words& named) {
    words.insert(words.begin(), "compare");
    check_refused(files.directory, words, 2, named);
  };
  for (const char* option : {"--focus", "--focal-length", "--f-number", "--coc-scale", "--fov"}) {
    refuse({a, a, option, "2"}, {option, "--regions"});
  }
  refuse({a, a, "--depth", a}, {"--depth", "--regions"});
  refuse({"--flicker", a, a}, {"--flicker", "--against"});
  refuse({"--against", a, a}, {"--against", "--flicker"});
  refuse({"--flicker", a, a, "--against", a}, {"2 frames", "1"});
  refuse({"--flicker", a, "--against", a}, {"two frames"});
  refuse({"--flicker", a, a, "--against", a, small}, {"small.npy", "8x8", "200x16"});
  refuse({"--flicker", a, a, "--against", small, a}, {"small.npy", "8x8", "200x16"});
  refuse({"--flicker", a, "missing.npy", "--against", a, a}, {"missing.npy"});
  refuse({a, a, "--flicker", a, a, "--against", a, a}, {"--flicker", "leave out A, B"});
  refuse({"--flicker", a, a, "--against", a, a, "--regions"}, {"--flicker", "--regions"});
  refuse({"--flicker"}, {"--flicker", "needs a value"});
  refuse({a}, {"B is missing"});
}

TEST_CASE("bad input: compare's numbers") {
  const PictureFiles files;
  const std::string a = files.write("a.npy", two_depths(0.5f));
  for (const auto& [option, value] : {std::pair{"--pixels-per-degree", "0"},
                                      {"--pixels-per-degree", "501"},
                                      {"--pixels-per-degree", "nan"},
                                      {"--point", "0"},
                                      {"--point", "-3"},
                                      {"--point", "disc"},
                                      {"--fov", "180"},
                                      {"--focus", "0"},
                                      {"--f-number", "inf"},
                                      {"--coc-scale", "-1"}}) {
    check_refused(files.directory, {"compare", a, a, "--regions", option, value}, 2,
                  {option, value});
  }
  check_refused(files.directory, {"compare", a, a, "--regions", "--focal-length", "3000"}, 2,
                {"--focal-length 3000 mm", "shorter"});
}

TEST_CASE("bad input: compare --regions without depths, or with what is none") {
  const PictureFiles files;
  Image image = two_depths(0.5f);
  const std::string deep = files.write("deep.npy", image);
  const std::string flat = files.write("flat.png", image);
  set_depth(image, [](int x, int y) { return x == 7 && y == 3 ? 0.0f : 2.0f; });
  const std::string hole = files.write("hole.npy", image);
  const std::string small = files.write("small.npy", plain_grey(8, 8, 0.5f));
  const auto refuse = [&](Words words, const Words& named) {
    words.insert(words.begin(), "compare");
    words.emplace_back("--regions");
    check_refused(files.directory, words, 2, named);
  };
  refuse({flat, flat}, {"--regions", "flat.png", "--depth"});
  refuse({deep, hole}, {"--regions", "hole.npy", "pixel 7,3"});
  refuse({deep, deep, "--depth", hole}, {"hole.npy", "pixel 7,3"});
  refuse({deep, deep, "--depth", flat}, {"flat.png", "no depth"});
  refuse({deep, deep, "--depth", small}, {"small.npy", "8x8", "200x16"});
  refuse({deep, deep, "--depth", "missing.npy"}, {"missing.npy"});
}
