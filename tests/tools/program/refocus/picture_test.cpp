// softfocus refocus: alpha, highlights, borders, apertures, and what an EXR keeps.

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/vec3.hpp>

#include "dof/dof.h"
#include "dof/measure/difference.h"
#include "raster/images/texel.h"
#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"
#include "tests/support/random.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/picture_file.h"

using namespace softfocus;

namespace {

constexpr int kSide = 40;

// Focus at 2 m, circles up to 12 px behind it: no lens, no default that looks at the picture.
const Words kBlur{"--focus", "2m", "--blur-at-infinity", "12"};

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

void put(const TemporaryDirectory& directory, const std::string& name, const Bytes& bytes) {
  write_file(directory.file(name), bytes);
}

Image picture_of(const std::function<glm::vec3(int, int)>& colour_at) {
  Image picture = make_image(Format::rgba16f, kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) store_texel(picture, x, y, {colour_at(x, y), 1.0f}, {});
  }
  return picture;
}

glm::vec3 random_colour(int x, int y) {
  test::Random random{static_cast<std::uint64_t>(y * 1000 + x)};
  return {random.unit(), random.unit(), random.unit()};
}

/// Opaque, half there and not there at all, with hard edges and a soft one.
float opacity_at(int x, int y) {
  if (y < 10) return static_cast<float>(x) / kSide;
  return (x / 8 + y / 8) % 3 == 0 ? 0.0f : (x / 8 + y / 8) % 3 == 1 ? 0.5f : 1.0f;
}

std::vector<float> plane_of(const std::function<float(int, int)>& value_at) {
  std::vector<float> values;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) values.push_back(value_at(x, y));
  }
  return values;
}

float depth_at(int x, int) { return x < kSide / 2 ? 1.0f : 16.0f; }

/// A depth beside the picture, d.pfm.
void put_depth(const TemporaryDirectory& directory,
               const std::function<float(int, int)>& metres = depth_at) {
  put(directory, "d.pfm", encode_grey_pfm(plane_of(metres), kSide, kSide));
}

/// Refocuses a file of the directory with d.pfm, without complaint.
void refocus(const TemporaryDirectory& directory, const std::string& from, const std::string& to,
             const Words& more) {
  const ProgramRun run =
      run_program(with(with({"refocus", directory.file(from), directory.file("d.pfm"), "-o",
                             directory.file(to), "--depth-encoding", "metres"},
                            kBlur),
                       more));
  CHECK(tells_depth_alone(run.err));
  CHECK(run.status == 0);
}

Image read(const TemporaryDirectory& directory, const std::string& name) {
  return read_image_file(directory.file(name)).image;
}

PlaneValues read_plane(const TemporaryDirectory& directory, const std::string& file_name,
                       const std::string& name) {
  const PictureFile file = open_picture_file(directory.file(file_name));
  for (std::size_t i = 0; i < file.planes.size(); ++i) {
    if (file.planes[i].name == name) return read_planes(file, {&i, 1}, 0.0f)[0];
  }
  FAIL("no plane ", name, " but ", plane_names(file));
  return {};
}

/// A picture of one straight colour that is transparent in places, as PNG of 16 bits.
void put_transparent(const TemporaryDirectory& directory, const std::string& name,
                     const glm::vec3& colour) {
  const Image picture = picture_of([&](int x, int y) { return colour * opacity_at(x, y); });
  put(directory, name, encode_png_16(picture, plane_of(opacity_at)));
}

}  // namespace

TEST_CASE("refocus: a colour with transparent edges stays that colour, by every filter") {
  const TemporaryDirectory directory;
  const glm::vec3 colour{0.7f, 0.25f, 0.05f};
  put_transparent(directory, "a.png", colour);
  put_depth(directory);
  for (const Method& method : methods()) {
    CAPTURE(std::string{method.name});
    refocus(directory, "a.png", "b.png",
            {"--format", "png-16", "--method", std::string{method.name}});
    const PlaneValues alpha = read_plane(directory, "b.png", "A");
    const Image result = read(directory, "b.png");
    double largest = 0.0;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        if (alpha[static_cast<std::size_t>(y * kSide + x)] < 0.02f * 65535.0f) continue;
        const glm::vec4 texel = load_texel(result, x, y);
        for (int c = 0; c < 3; ++c) {
          largest = std::max(largest, static_cast<double>(std::fabs(texel[c] - colour[c])) /
                                          static_cast<double>(colour[c]));
        }
      }
    }
    CHECK(largest < 0.004);
  }
}

TEST_CASE("refocus: alpha is filtered as a grey picture of it is") {
  const TemporaryDirectory directory;
  put_transparent(directory, "a.png", {1.0f, 1.0f, 1.0f});
  put_depth(directory);
  const Image grey = picture_of([](int x, int y) { return glm::vec3{opacity_at(x, y)}; });
  put(directory, "grey.npy", encode_npy(grey));
  for (const std::string method : {"two-pass", "disc-layers", "scatter-aperture"}) {
    refocus(directory, "a.png", "b.png", {"--method", method, "--format", "png-16"});
    refocus(directory, "grey.npy", "c.npy", {"--method", method});
    const PlaneValues alpha = read_plane(directory, "b.png", "A");
    const Image expected = read(directory, "c.npy");
    double largest = 0.0;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        largest = std::max(
            largest, std::fabs(static_cast<double>(alpha[static_cast<std::size_t>(y * kSide + x)]) /
                                   65535.0 -
                               static_cast<double>(load_texel(expected, x, y).x)));
      }
    }
    CHECK(largest < 0.001);  // the file's 16 bits, and the 11 of the grey one
  }
}

TEST_CASE("refocus: an EXR's alpha a little beyond 0 and 1, and NaN, is kept, cut to 0 and 1") {
  if (!missing_exr().empty()) return;
  const TemporaryDirectory directory;
  put_depth(directory);
  const Image picture = picture_of(random_colour);
  const auto put_exr = [&](const std::string& name, float least, float largest, float unknown) {
    put(directory, name,
        encode_exr(picture, ExrNumbers::half, "", {.alpha = plane_of([&](int x, int y) {
                                                     if (x == 3) return unknown;
                                                     return opacity_at(x, y) == 0.0f ? least
                                                            : opacity_at(x, y) == 1.0f
                                                                ? largest
                                                                : opacity_at(x, y);
                                                   })}));
  };
  put_exr("a.exr", -0.002f, 1.001f, NAN);
  put_exr("b.exr", 0.0f, 1.0f, 0.0f);
  for (const Words& way : {Words{}, Words{"--method", "scatter"}}) {  // by rows, and whole
    refocus(directory, "a.exr", "oa.exr", way);
    refocus(directory, "b.exr", "ob.exr", way);
    for (const std::string plane : {"R", "A"}) {
      const bool same =
          read_plane(directory, "oa.exr", plane) == read_plane(directory, "ob.exr", plane);
      CHECK(same);
    }
  }
}

TEST_CASE("refocus: an EXR's red is the mask, not its alpha, which is 1 everywhere") {
  if (!missing_exr().empty()) return;
  const TemporaryDirectory directory;
  put_depth(directory);
  put(directory, "a.npy", encode_npy(picture_of(random_colour)));
  const Image mask = picture_of([](int x, int) { return glm::vec3{x < 3 ? 0.0f : 1.0f}; });
  put(directory, "mask.exr",
      encode_exr(mask, ExrNumbers::half, "", {.alpha = plane_of([](int, int) { return 1.0f; })}));
  const ProgramRun run =
      run_program({"refocus", directory.file("a.npy"), directory.file("d.pfm"), "--mask",
                   directory.file("mask.exr"), "-o", directory.file("o.png"), "--json"});
  REQUIRE(run.status == 0);
  CHECK(nlohmann::json::parse(run.out)["filled_pixels"] == 3 * kSide);
}

TEST_CASE("refocus: an alpha that is opaque everywhere changes no colour") {
  const TemporaryDirectory directory;
  const Image picture = picture_of(random_colour);
  put(directory, "a.png", encode_png(picture));
  put(directory, "opaque.png", encode_png(picture, plane_of([](int, int) { return 1.0f; })));
  put_depth(directory);
  refocus(directory, "a.png", "b.png", {});
  refocus(directory, "opaque.png", "c.png", {});
  const Image without = read(directory, "b.png"), with_alpha = read(directory, "c.png");
  int different = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      different += glm::vec3{load_texel(without, x, y)} != glm::vec3{load_texel(with_alpha, x, y)};
      CHECK(load_texel(with_alpha, x, y).w == 1.0f);
    }
  }
  CHECK(different == 0);
  CHECK(plane_names(open_picture_file(directory.file("b.png"))) == "R, G, B");
}

TEST_CASE("refocus: --highlights makes a clipped lamp's disc brighter, and nothing that is sharp") {
  const TemporaryDirectory directory;
  const Image lamp =
      picture_of([](int x, int y) { return glm::vec3{x == 30 && y == 20 ? 1.0f : 0.01f}; });
  put(directory, "lamp.npy", encode_npy(lamp));
  put_depth(directory, [](int, int) { return 16.0f; });
  for (const std::string method : {"scatter-sorted", "disc-layers"}) {
    refocus(directory, "lamp.npy", "plain.npy", {"--method", method});
    refocus(directory, "lamp.npy", "bright.npy", {"--method", method, "--highlights", "50,0.5"});
    // 1 becomes .5 + 50 / 2: 25 times as much.
    const double plain = static_cast<double>(load_texel(read(directory, "plain.npy"), 30, 14).x);
    const double bright = static_cast<double>(load_texel(read(directory, "bright.npy"), 30, 14).x);
    CHECK((bright - 0.01) / (plain - 0.01) == doctest::Approx(25.0).epsilon(0.06));
  }
  put(directory, "a.npy", encode_npy(picture_of(random_colour)));
  put_depth(directory, [](int, int) { return 2.0f; });
  refocus(directory, "a.npy", "sharp.npy", {"--highlights", "50,0.5"});
  CHECK(compare_images(read(directory, "sharp.npy"),
                       [&] {
                         Image expected = picture_of(random_colour);
                         for (int y = 0; y < kSide; ++y) {
                           for (int x = 0; x < kSide; ++x) {
                             const glm::vec4 texel = load_texel(expected, x, y);
                             store_texel(expected, x, y, {texel.x, texel.y, texel.z, 2.0f}, {});
                           }
                         }
                         return expected;
                       }())
            .max_ulp <= 1);
}

TEST_CASE("refocus: --border is what the same filter makes of a larger picture") {
  const TemporaryDirectory directory;
  constexpr int kMargin = 12, kWide = kSide + 2 * kMargin;
  put(directory, "a.npy", encode_npy(picture_of(random_colour)));
  put_depth(directory);
  for (const std::string border : {"clamp", "mirror", "black"}) {
    CAPTURE(border);
    const auto inside = [&](int at) {
      if (border != "mirror") return std::clamp(at, 0, kSide - 1);
      return at < 0 ? -1 - at : at >= kSide ? 2 * kSide - 1 - at : at;
    };
    Image wide = make_image(Format::rgba16f, kWide, kWide);
    std::vector<float> depths;
    for (int y = 0; y < kWide; ++y) {
      for (int x = 0; x < kWide; ++x) {
        const int from_x = inside(x - kMargin), from_y = inside(y - kMargin);
        const bool is_out =
            x < kMargin || y < kMargin || x >= kWide - kMargin || y >= kWide - kMargin;
        const glm::vec3 colour =
            border == "black" && is_out ? glm::vec3{0.0f} : random_colour(from_x, from_y);
        store_texel(wide, x, y, {colour, 1.0f}, {});
        depths.push_back(depth_at(from_x, from_y));
      }
    }
    for (const std::string method :
         {"two-pass", "scatter-aperture", "disc-layers", "one-pass", "scatter-sorted", "layers"}) {
      CAPTURE(method);
      put_depth(directory);
      refocus(directory, "a.npy", "b.npy", {"--method", method, "--border", border});
      put(directory, "wide.npy", encode_npy(wide));
      put(directory, "d.pfm", encode_grey_pfm(depths, kWide, kWide));
      refocus(directory, "wide.npy", "c.npy", {"--method", method});
      const Image result = read(directory, "b.npy"), expected = read(directory, "c.npy");
      int different = 0;
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          different += load_texel(result, x, y) != load_texel(expected, x + kMargin, y + kMargin);
        }
      }
      CHECK(different == 0);
    }
  }
}

TEST_CASE("refocus: --highlights goes by a transparent picture's own colour, not by what is left") {
  const TemporaryDirectory directory;
  put_depth(directory, [](int, int) { return 16.0f; });
  for (const float alpha : {1.0f, 0.5f}) {
    const Image lamp = picture_of(
        [&](int x, int y) { return glm::vec3{(x == 30 && y == 20 ? 1.0f : 0.01f) * alpha}; });
    put(directory, "lamp.png", encode_png_16(lamp, plane_of([&](int, int) { return alpha; })));
    refocus(directory, "lamp.png", alpha == 1.0f ? "opaque.npy" : "half.exr",
            {"--method", "disc-layers", "--highlights", "50,0.5"});
  }
  const double opaque = static_cast<double>(load_texel(read(directory, "opaque.npy"), 30, 14).x);
  const double half = static_cast<double>(load_texel(read(directory, "half.exr"), 30, 14).x);
  CHECK(opaque > 0.03);
  CHECK(half == doctest::Approx(0.5 * opaque).epsilon(0.01));
}

TEST_CASE("refocus: beyond a black border a transparent picture has nothing, alpha neither") {
  const TemporaryDirectory directory;
  constexpr int kMargin = 12, kWide = kSide + 2 * kMargin;
  put_transparent(directory, "a.png", {1.0f, 1.0f, 1.0f});
  put_depth(directory);
  refocus(directory, "a.png", "b.png", {"--border", "black", "--format", "png-16"});
  Image wide = make_image(Format::rgba16f, kWide, kWide);
  std::vector<float> alpha, depths;
  for (int y = -kMargin; y < kSide + kMargin; ++y) {
    for (int x = -kMargin; x < kSide + kMargin; ++x) {
      const int from_x = std::clamp(x, 0, kSide - 1), from_y = std::clamp(y, 0, kSide - 1);
      alpha.push_back(from_x == x && from_y == y ? opacity_at(x, y) : 0.0f);
      depths.push_back(depth_at(from_x, from_y));
      store_texel(wide, x + kMargin, y + kMargin, {glm::vec3{alpha.back()}, 1.0f}, {});
    }
  }
  put(directory, "wide.png", encode_png_16(wide, alpha));
  put(directory, "d.pfm", encode_grey_pfm(depths, kWide, kWide));
  refocus(directory, "wide.png", "c.png", {"--format", "png-16"});
  const PlaneValues result = read_plane(directory, "b.png", "A");
  const PlaneValues expected = read_plane(directory, "c.png", "A");
  int different = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      different += result[static_cast<std::size_t>(y * kSide + x)] !=
                   expected[static_cast<std::size_t>((y + kMargin) * kWide + x + kMargin)];
    }
  }
  CHECK(different == 0);
}

TEST_CASE("refocus: an aperture's blades, turn and stretch are drawn, or refused with who can") {
  const TemporaryDirectory directory;
  put(directory, "a.npy", encode_npy(picture_of([](int x, int y) {
        return glm::vec3{x == 20 && y == 20 ? 1.0f : 0.0f};
      })));
  put_depth(directory, [](int, int) { return 16.0f; });
  const auto lit = [&](const Words& more, int x, int y) {
    refocus(directory, "a.npy", "b.npy", with({"--method", "scatter-aperture"}, more));
    return load_texel(read(directory, "b.npy"), x, y).x > 0.0f;
  };
  // A circle of 12 * 14 / 16 = 10.5 pixels.
  CHECK(lit({}, 12, 16));
  CHECK(lit({"--aperture-blades", "4"}, 20, 11));
  CHECK_FALSE(lit({"--aperture-blades", "4"}, 13, 13));
  CHECK(lit({"--aperture-blades", "4", "--aperture-turn", "45"}, 13, 13));
  CHECK_FALSE(lit({"--anamorphic", "2"}, 12, 20));
  CHECK(lit({"--anamorphic", "2"}, 20, 11));
  const std::string a = directory.file("a.npy"), d = directory.file("d.pfm");
  const std::string out = directory.file("out.npy");
  for (const std::string option : {"--aperture-blades", "--aperture-turn", "--anamorphic"}) {
    check_refused(directory, {"refocus", a, d, "-o", out, option, "3"}, 2,
                  {option, "disc-layers", "round", "--method scatter-aperture"});
  }
  check_refused(directory, {"refocus", a, d, "-o", out, "--aperture-blades", "2"}, 2,
                {"--aperture-blades", "3 to 64"});
  check_refused(directory, {"refocus", a, d, "-o", out, "--anamorphic", "0"}, 2,
                {"--anamorphic", "0.0625 to 16"});
  check_refused(directory, {"refocus", a, d, "-o", out, "--border", "wrap"}, 2,
                {"--border", "clamp, mirror, black"});
  for (const std::string value : {"8", "0.5,1", "8,-1", "8,x", ","}) {
    check_refused(directory, {"refocus", a, d, "-o", out, "--highlights", value}, 2,
                  {"--highlights '" + value + "'", "GAIN,THRESHOLD"});
  }
}

TEST_CASE("refocus: an EXR has alpha, depth in floats, circles, and the layers that came in") {
  if (!missing_exr().empty()) return;
  const TemporaryDirectory directory;
  put_transparent(directory, "a.png", {0.5f, 0.25f, 1.0f});
  const auto metres = [](int x, int y) { return 1.0f + 0.001f * static_cast<float>(x + 40 * y); };
  put_depth(directory, metres);
  refocus(directory, "a.png", "b.exr", {});
  CHECK(plane_names(open_picture_file(directory.file("b.exr"))) == "A, B, G, R, Z, coc");
  const PlaneValues depth = read_plane(directory, "b.exr", "Z");
  const PlaneValues radii = read_plane(directory, "b.exr", "coc");
  const PlaneValues alpha = read_plane(directory, "b.exr", "A");
  const PlaneValues red = read_plane(directory, "b.exr", "R");
  const PlaneValues expected = plane_of(metres);
  double largest = 0.0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    CHECK(depth[i] == expected[i]);
    CHECK(radii[i] == doctest::Approx(12.0f * (expected[i] - 2.0f) / expected[i]));
    largest = std::max(largest, static_cast<double>(std::fabs(red[i] - 0.5f * alpha[i])));
  }
  CHECK(largest < 0.0005);  // multiplied, and both halves

  // From EXR to EXR: multiplied colours stay multiplied.
  const ProgramRun run = run_program(with({"refocus", directory.file("b.exr"), "-o",
                                           directory.file("c.exr"), "--depth-encoding", "metres"},
                                          kBlur));
  CHECK(tells_depth_alone(run.err));
  CHECK(plane_names(open_picture_file(directory.file("c.exr"))) == "A, B, G, R, Z, coc");
  const PlaneValues red_again = read_plane(directory, "c.exr", "R");
  const PlaneValues alpha_again = read_plane(directory, "c.exr", "A");
  largest = 0.0;
  for (std::size_t i = 0; i < red_again.size(); ++i) {
    largest =
        std::max(largest, static_cast<double>(std::fabs(red_again[i] - 0.5f * alpha_again[i])));
  }
  CHECK(largest < 0.001);
}
