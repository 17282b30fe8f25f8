// softfocus refocus: what `render` draws, refocused, is what `render` makes of it.

#include <algorithm>
#include <cmath>

#include "dof/dof.h"
#include "raster/images/texel.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tools/cli/option_values.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/picture_file.h"
#include "tools/refocus/depth/depth_map.h"

using namespace softfocus;
using nlohmann::json;

namespace {

const Words kLens{"--focus", "1.1",         "--f-number", "1",         "--focal-length",
                  "50",      "--coc-scale", "3",          "--max-coc", "12"};

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// The pinhole's picture, and its depth as `depth` names it.
void draw(const TemporaryDirectory& directory, const std::string& picture,
          const std::string& depth) {
  CHECK(run_program(render("figures", directory.file(picture),
                           {"--show", "pinhole", "--depth-output", directory.file(depth)}))
            .status == 0);
}

/// The result of refocusing files of the directory, without complaint.
Image refocus_of(const TemporaryDirectory& directory, const Words& files, const Words& more) {
  Words words{"refocus"};
  for (const std::string& file : files) words.push_back(directory.file(file));
  words = joined(words, {"-o", directory.file("result.npy")});
  const ProgramRun run = run_program(joined(words, more));
  CHECK(run.status == 0);
  CHECK(tells_depth_alone(run.err));
  return read_image_file(directory.file("result.npy")).image;
}

json refocus_json_of(const TemporaryDirectory& directory, const Words& files, const Words& more) {
  Words words{"refocus"};
  for (const std::string& file : files) words.push_back(directory.file(file));
  words = joined(words, {"-o", directory.file("result.npy"), "--json"});
  const ProgramRun run = run_program(joined(words, more));
  CHECK(tells_depth_alone(run.err));
  REQUIRE(run.status == 0);
  return json::parse(run.out);
}

/// PSNR of sRGB-like colours, cut to 0..1.
double psnr(const Image& a, const Image& b) {
  double sum = 0.0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const glm::vec4 p = load_texel(a, x, y), q = load_texel(b, x, y);
      for (int c = 0; c < 3; ++c) {
        const double d = std::sqrt(std::clamp(static_cast<double>(p[c]), 0.0, 1.0)) -
                         std::sqrt(std::clamp(static_cast<double>(q[c]), 0.0, 1.0));
        sum += d * d;
      }
    }
  }
  return -10.0 * std::log10(sum / (3.0 * a.width * a.height) + 1e-30);
}

}  // namespace

TEST_CASE("refocus: exact depth in any file gives the bits that render gives") {
  for (const std::string method : {"two-pass", "disc-layers", "pinhole", "scatter-sorted"}) {
    CAPTURE(method);
    const Words options = joined(kLens, {"--method", method});
    const Image truth = rendered_picture("figures", options).image;
    const TemporaryDirectory directory;
    draw(directory, "a.npy", "d.pfm");
    CHECK(equal(refocus_of(directory, {"a.npy"}, options), truth));
    CHECK(equal(refocus_of(directory, {"a.npy", "d.pfm"}, options), truth));
    if (!missing_exr().empty()) continue;
    draw(directory, "a.exr", "d.exr");
    CHECK(equal(refocus_of(directory, {"a.exr"}, options), truth));
    CHECK(equal(refocus_of(directory, {"a.npy", "d.exr"}, options), truth));
  }
}

TEST_CASE("render: an aperture's blades, turn and stretch give the bits that refocus gives") {
  const TemporaryDirectory directory;
  draw(directory, "a.npy", "d.pfm");
  const Words round = joined(kLens, {"--method", "scatter-aperture"});
  std::vector<std::uint64_t> seen{hash_image(rendered_picture("figures", round).image)};
  for (const Words& aperture :
       {Words{"--aperture-blades", "5"}, Words{"--aperture-blades", "5", "--aperture-turn", "30"},
        Words{"--anamorphic", "2"}}) {
    CAPTURE(aperture.back());
    const Words options = joined(round, aperture);
    const Image rendered = rendered_picture("figures", options).image;
    CHECK(equal(refocus_of(directory, {"a.npy"}, options), rendered));
    seen.push_back(hash_image(rendered));
    CHECK(std::count(seen.begin(), seen.end(), seen.back()) == 1);
  }
}

TEST_CASE("render: transparent surfaces are blurred by the aperture's shape, too") {
  const Words round{"--method", "scatter-aperture", "--coc-scale", "3"};
  const Image disc = rendered_picture("glass", round).image;
  const Image blades = rendered_picture("glass", joined(round, {"--aperture-blades", "3"})).image;
  CHECK_FALSE(equal(disc, blades));
}

TEST_CASE("render: apertures are refused with who has them") {
  const TemporaryDirectory directory;
  const auto check_refused_render = [&](const Words& options, const Words& named) {
    check_refused(directory, render("figures", directory.file("a.npy"), options), 2, named);
  };
  for (const std::string option : {"--aperture-blades", "--aperture-turn", "--anamorphic"}) {
    check_refused_render({option, "3"}, {option, "disc-layers has a round aperture alone",
                                         "--method scatter-aperture"});
  }
  check_refused_render({"--method", "accumulation", "--anamorphic", "2"},
                       {"--anamorphic", "accumulation", "--method scatter-aperture"});
  check_refused_render({"--method", "scatter-aperture", "--samples", "4"},
                       {"--samples", "scatter-aperture", "accumulation"});
  check_refused_render({"--method", "scatter-aperture", "--anamorphic", "99"},
                       {"--anamorphic", "0.0625 to 16"});
}

TEST_CASE(
    "refocus: a multi-layer EXR by Blender gives the picture of the same scene, within 50 dB") {
  if (!missing_exr().empty()) return;
  // Both have one sample in the middle of a pixel: tests/data/blender-cubes/cubes.py.
  const std::string folder = SOFTFOCUS_TEST_DATA "/blender-cubes/";
  const TemporaryDirectory directory;
  for (const std::string method : {"two-pass", "one-pass", "disc-layers", "mipmap", "scatter"}) {
    CAPTURE(method);
    const Words options{"--method", method, "--max-coc", "8", "-o", directory.file("result.npy")};
    CHECK(run_program(
              joined({"render", folder + "cubes.toml", "--size", "240x160", "--multisample", "1"},
                     options))
              .status == 0);
    const Image truth = read_image_file(directory.file("result.npy")).image;
    const ProgramRun run =
        run_program(joined({"refocus", folder + "cubes.exr", "--focus", "1.6m", "--focal-length",
                            "85mm", "--f-number", "1.8", "--fov", "35"},
                           options));
    CHECK(run.status == 0);
    CHECK(tells_depth_alone(run.err));
    CHECK(psnr(truth, read_image_file(directory.file("result.npy")).image) > 50.0);
  }
}

TEST_CASE("refocus: what is infinitely far has the horizon's circle, and stays infinitely far") {
  const TemporaryDirectory directory;
  draw(directory, "a.npy", "d.pfm");
  Image picture = read_image_file(directory.file("a.npy")).image;
  const auto set_sky = [&](float metres, const std::string& name) {
    for (int y = 0; y < picture.height / 3; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        glm::vec4 texel = load_texel(picture, x, y);
        texel.a = metres;
        store_texel(picture, x, y, texel, {});
      }
    }
    const Bytes bytes = encode_npy(picture);
    write_file(directory.file(name), bytes);
  };
  set_sky(60000.0f, "far.npy");
  set_sky(std::numeric_limits<float>::infinity(), "infinite.npy");
  for (const std::string method : {"two-pass", "disc-layers"}) {
    CAPTURE(method);
    const Words options = joined(kLens, {"--method", method});
    const Image far = refocus_of(directory, {"far.npy"}, options);
    const Image infinite = refocus_of(directory, {"infinite.npy"}, options);
    CHECK(psnr(far, infinite) > 70.0);
    CHECK(std::isinf(load_texel(infinite, 0, 0).a));
  }
}

TEST_CASE("refocus: millimetres of 16 bits and colours of 8 bits are off by 50 dB at most") {
  const Image truth = rendered_picture("figures", kLens).image;
  const TemporaryDirectory directory;
  draw(directory, "a.png", "d.png");
  CHECK(psnr(refocus_of(directory, {"a.png", "d.png"}, kLens), truth) > 50.0);
  draw(directory, "a.hdr", "d.png");
  CHECK(psnr(refocus_of(directory, {"a.hdr", "d.png"}, kLens), truth) > 50.0);
}

TEST_CASE("refocus: every encoding of an exact depth gives the picture, within 50 dB") {
  const Image truth = rendered_picture("figures", kLens).image;
  const TemporaryDirectory directory;
  draw(directory, "a.npy", "d.pfm");
  const PictureFile file = open_picture_file(directory.file("d.pfm"));
  const std::size_t first = 0;
  const DepthMap depth{file.width, file.height, read_planes(file, {&first, 1}, 0.0f)[0]};
  const auto ends = std::minmax_element(depth.metres.begin(), depth.metres.end());
  const std::string near = exact_number(static_cast<double>(*ends.first));
  const std::string far = exact_number(static_cast<double>(*ends.second));
  for (const DepthEncoding& encoding : depth_encodings()) {
    CAPTURE(encoding.name);
    DepthReading reading{.encoding = &encoding, .along = encoding.along};
    reading.pixels_per_tangent = 16.0 / std::tan(14.0 * 3.14159265358979 / 180.0);
    DepthNumbers& numbers = reading.numbers;
    Words options = joined(kLens, {"--depth-encoding", std::string{encoding.name}});
    const auto needs = [&](const char* name) { return contains(encoding.needs, name); };
    if (needs("near")) {
      numbers.near_m = static_cast<double>(*ends.first);
      options = joined(options, {"--near", near});
    }
    if (needs("far")) {
      numbers.far_m = static_cast<double>(*ends.second);
      options = joined(options, {"--far", far});
    }
    if (needs("baseline")) {
      numbers.baseline_m = 0.1;
      numbers.focal_px = 600.0;
      options = joined(options, {"--baseline", "10cm", "--focal-px", "600", "--fov", "28"});
    }
    const PlaneValues codes = codes_of_depth(depth, NumberType::single, reading);
    const Bytes bytes = encode_grey_pfm(codes, depth.width, depth.height);
    write_file(directory.file("e.pfm"),
               {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    CHECK(psnr(refocus_of(directory, {"a.npy", "e.pfm"}, options), truth) > 50.0);
  }
}

TEST_CASE("refocus: 8 bits of GDepth, 16 of disparity, are near the picture") {
  const Image truth = rendered_picture("figures", kLens).image;
  const TemporaryDirectory directory;
  draw(directory, "a.npy", "d.pfm");
  const PictureFile file = open_picture_file(directory.file("d.pfm"));
  const std::size_t first = 0;
  const DepthMap depth{file.width, file.height, read_planes(file, {&first, 1}, 0.0f)[0]};
  const auto refocused_with = [&](const char* name, const DepthNumbers& numbers, double steps,
                                  const Words& options) {
    const DepthReading reading{.encoding = find_depth_encoding(name), .numbers = numbers};
    PlaneValues codes = codes_of_depth(depth, NumberType::unsigned16, reading);
    std::vector<std::uint16_t> whole;
    for (const float code : codes) {
      const double share = reading.encoding->by_full_scale ? 65535.0 / steps : 1.0;
      whole.push_back(
          static_cast<std::uint16_t>(std::round(static_cast<double>(code) / share) * share + 0.5));
    }
    const Bytes bytes = encode_grey_png_16(whole, depth.width, depth.height);
    write_file(directory.file("e.png"),
               {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return psnr(refocus_of(directory, {"a.npy", "e.png"}, joined(kLens, options)), truth);
  };
  CHECK(refocused_with("gdepth-inverse", {.near_m = 0.7, .far_m = 21.0}, 255.0,
                       {"--depth-encoding", "gdepth-inverse", "--near", "0.7", "--far", "21"}) >
        35.0);
  CHECK(refocused_with("cityscapes", {.baseline_m = 0.1, .focal_px = 600.0}, 1.0,
                       {"--depth-encoding", "cityscapes", "--baseline", "0.1", "--focal-px", "600",
                        "--fov", "28"}) > 50.0);
}

TEST_CASE("refocus: auto takes a filter and says which") {
  const TemporaryDirectory directory;
  draw(directory, "a.npy", "d.pfm");
  const json said = refocus_json_of(directory, {"a.npy"}, {"--method", "auto", "--focus", "1.1"});
  CHECK(find_method(said["method"].get<std::string>()) != nullptr);
}

TEST_CASE("refocus: the lens of a picture that carries one is taken, and options overrule it") {
  const TemporaryDirectory directory;
  CHECK(run_program(render("figures", directory.file("a.npy"), {"--f-number", "1.7"})).status == 0);
  const json own = refocus_json_of(directory, {"a.npy"}, {});
  CHECK(own["lens"]["f_number"] == 1.7);
  CHECK(own["lens"]["fov_y_degrees"] == 28);
  const json given =
      refocus_json_of(directory, {"a.npy"}, {"--f-number", "f/4", "--focal-length", "8.5cm"});
  CHECK(given["lens"]["f_number"] == 4);
  CHECK(given["lens"]["focal_length_mm"] == 85);
}

TEST_CASE("refocus: --focus-range is sharp in the range and keeps the depth") {
  const TemporaryDirectory directory;
  draw(directory, "a.npy", "d.pfm");
  const Image sharp = read_image_file(directory.file("a.npy")).image;
  const Image result =
      refocus_of(directory, {"a.npy"}, {"--focus-range", "50cm..100m", "--f-number", "0.5"});
  CHECK(equal(result, sharp));
}

TEST_CASE("refocus: what is transparent becomes black, with a warning") {
  const TemporaryDirectory directory;
  Image half_there = make_image(Format::rgba16f, 8, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x)
      store_texel(half_there, x, y, {1.0f, 1.0f, 1.0f, x < 4 ? 1.0f : 0.0f}, {});
  }
  const auto write = [&](const char* name, const Bytes& bytes) {
    write_file(directory.file(name), bytes);
  };
  write("a.npy", encode_npy(half_there));
  write("d.pfm", encode_grey_pfm(std::vector<float>(64, 2.0f), 8, 8));
  const ProgramRun run = run_program(
      {"refocus", directory.file("a.npy"), directory.file("d.pfm"), "-o", directory.file("b.npy")});
  CHECK(run.status == 0);
  CHECK(contains(run.err, "transparent"));
  const Image result = read_image_file(directory.file("b.npy")).image;
  CHECK(load_texel(result, 2, 2).x == 1.0f);
  CHECK(load_texel(result, 6, 2).x == 0.0f);
}

TEST_CASE("bad input: refocus without a depth, of no depth, with a method of scenes") {
  const TemporaryDirectory directory;
  draw(directory, "a.png", "d.png");
  const std::string a = directory.file("a.png"), d = directory.file("d.png");
  const std::string out = directory.file("out.png");
  check_refused(directory, {"refocus", a, "-o", out}, 2, {"a.png", "no depth", "--depth-layer"});
  check_refused(directory, {"refocus", a, a, "-o", out}, 2, {"three channels"});
  check_refused(directory, {"refocus", a, d, "-o", a}, 2, {"-o", "write over"});
  check_refused(directory, {"refocus", a, d, "-o", d}, 2, {"-o", "write over"});
  check_refused(directory, {"refocus", a, d}, 2, {"-o is missing"});
  check_refused(directory, {"refocus", a, d, "-o", directory.file("out.gif")}, 2, {".png, .exr"});
  for (const std::string method : {"accumulation", "filtered-views", "surface-splatting"}) {
    check_refused(directory, {"refocus", a, d, "-o", out, "--method", method}, 2,
                  {"--method " + method, "scene"});
  }
  check_refused(directory, {"refocus", a, d, "-o", out, "--layer", "beauty"}, 2,
                {"--layer 'beauty'", "R, G, B"});
  check_refused(directory, {"refocus", a, d, "-o", out, "--focus", "1", "--focus-nearest"}, 2,
                {"--focus", "--focus-nearest", "exclude"});
  check_refused(directory, {"refocus", a, d, "-o", out, "--depth-encoding", "foot"}, 2,
                {"'foot'", "millimetres"});
  check_refused(directory, {"refocus", a, d, "-o", out, "--depth-encoding", "device"}, 2,
                {"--near"});
  check_refused(directory, {"refocus", a, directory.file("none.png"), "-o", out}, 1,
                {"none.png", "cannot read"});
  check_refused(directory, {"refocus", a, d, "-o", out, "--focus-at", "48,0"}, 2,
                {"--focus-at", "47,31"});
  check_refused(directory, {"refocus", a, d, "-o", out, "--sensor", "huge"}, 2,
                {"--sensor", "full-frame"});
  check_refused(directory, {"refocus", a, d, "-o", out, "--focus-range", "3..1"}, 2,
                {"--focus-range", "NEAR..FAR"});
  check_refused(directory,
                {"refocus", a, d, "-o", out, "--blur-at-infinity", "9", "--f-number", "2"}, 2,
                {"--blur-at-infinity", "--f-number", "exclude"});
}

TEST_CASE("bad input: a file without an end is refused by its beginning") {
  const TemporaryDirectory directory;
  check_refused(directory, {"refocus", "/dev/zero", "-o", directory.file("out.png")}, 1,
                {"/dev/zero", "none of PNG"});
  check_refused(directory, {"inspect", "/dev/zero"}, 1, {"/dev/zero", "none of PNG"});
}

TEST_CASE("bad input: a depth of another shape, all missing, or with holes that are refused") {
  const TemporaryDirectory directory;
  draw(directory, "a.png", "d.png");
  const std::string a = directory.file("a.png"), out = directory.file("out.png");
  const auto depth_file = [&](const std::vector<float>& metres, int width, int height) {
    const Bytes bytes = encode_grey_pfm(metres, width, height);
    write_file(directory.file("e.pfm"),
               {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    return directory.file("e.pfm");
  };
  std::vector<float> metres(48 * 32, 2.0f);
  check_refused(directory,
                {"refocus", a, depth_file(std::vector<float>(64, 2.0f), 8, 8), "-o", out}, 2,
                {"8x8", "48x32", "shape"});
  check_refused(directory,
                {"refocus", a, depth_file(std::vector<float>(48 * 32, 0.0f), 48, 32), "-o", out,
                 "--depth-encoding", "metres"},
                2, {"no depth that is known"});
  metres[7] = 0.0f;
  const std::string holed = depth_file(metres, 48, 32);
  check_refused(directory, {"refocus", a, holed, "-o", out, "--holes", "refuse"}, 2,
                {"--holes refuse", "1 of 1536"});
  CHECK(refocus_json_of(directory, {"a.png", "e.pfm"}, {})["filled_pixels"] == 1);
}

TEST_CASE("render: --depth-output writes metres beside the picture") {
  const TemporaryDirectory directory;
  draw(directory, "a.npy", "d.npy");
  const PictureFile file = open_picture_file(directory.file("d.npy"));
  CHECK(plane_names(file) == "Y");
  const std::size_t first = 0;
  const PlaneValues depth = read_planes(file, {&first, 1}, 0.0f)[0];
  const Image picture = read_image_file(directory.file("a.npy")).image;
  CHECK(depth[100] == load_texel(picture, 100 % kWidth, 100 / kWidth).w);
  check_refused(
      directory,
      render("figures", directory.file("b.npy"), {"--depth-output", directory.file("b.npy")}), 2,
      {"--depth-output"});
  check_refused(
      directory,
      render("figures", directory.file("b.npy"), {"--depth-output", directory.file("b.hdr")}), 2,
      {"--depth-output"});
}

TEST_CASE(
    "refocus: --unmix-edges takes apart what a renderer mixed, and leaves one sample a pixel") {
  const TemporaryDirectory directory;
  const std::string large = directory.file("large.npy"), small = directory.file("small.npy");
  REQUIRE(run_program({"render", "figures", "--size", "384x256", "--show", "pinhole", "-o", large})
              .status == 0);
  const Image fine = read_image_file(large).image;
  Image mixed = make_image(Format::rgba16f, 96, 64), aliased = mixed;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      glm::vec4 sum{};
      for (int i = 0; i < 16; ++i) sum += load_texel(fine, 4 * x + i % 4, 4 * y + i / 4) / 16.0f;
      const glm::vec4 centre = load_texel(fine, 4 * x + 2, 4 * y + 2);
      sum.w = centre.w;
      store_texel(mixed, x, y, sum, {});
      store_texel(aliased, x, y, centre, {});
    }
  }
  const auto unmixed = [&](const Image& picture, const Words& more) {
    const Bytes bytes = encode_npy(picture);
    write_file(small, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const Words options = joined(kLens, joined({"--unmix-edges"}, more));
    const json report = refocus_json_of(directory, {"small.npy"}, options);
    CHECK(report["by_rows"] == false);
    return report["unmixed_pixels"].get<int>();
  };
  CHECK(unmixed(mixed, {}) > 100);
  CHECK(unmixed(mixed, {"--border", "mirror"}) > 100);
  CHECK(unmixed(mixed, {"--method", "two-pass"}) > 100);
  CHECK(unmixed(aliased, {}) == 0);
  const Image as_it_is = refocus_of(directory, {"small.npy"}, kLens);
  CHECK(equal(refocus_of(directory, {"small.npy"}, joined(kLens, {"--unmix-edges"})), as_it_is));
  const std::string output = directory.file("refused.npy");
  check_refused(directory,
                {"refocus", small, "-o", output, "--unmix-edges", "--arithmetic", "fixed"}, 2,
                {"--unmix-edges", "--arithmetic"});
  check_refused(directory, {"refocus", small, "-o", output, "--unmix-edges", "--show", "coc"}, 2,
                {"--unmix-edges", "--show"});
}
