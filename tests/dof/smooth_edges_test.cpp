// Smooth edges of filtered pictures.

#include "dof/smooth_edges.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string_view>
#include <vector>

#include "dof/measure/flip.h"
#include "dof/unmix_edges.h"
#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/frame/frame.h"
#include "scenes/load/load_scene.h"
#include "tests/support/random.h"

using namespace softfocus;

namespace {

constexpr int kEdgeWidth = 24, kEdgeHeight = 18;

// A near surface to the left of a slanted line, and a far one: as one sample a pixel has them, with
// the part that the other has of each pixel.
struct EdgePicture {
  Image scene = make_image(Format::rgba16f, kEdgeWidth, kEdgeHeight);
  Image other = make_image(Format::rgba16f, kEdgeWidth, kEdgeHeight);
  Image coverage = make_image(Format::r8, kEdgeWidth, kEdgeHeight);

  DofInput input(const PixelCoc& coc) const {
    return {.scene = scene,
            .settings = {.coc = coc, .max_coc_px = 8.0f},
            .profile = {},
            .edges = {coverage, other}};
  }
};

constexpr glm::vec4 kNear{0.75f, 0.25f, 0.125f, 2.0f}, kFar{0.125f, 0.5f, 1.0f, 8.0f};

// Where the line is in a row, in pixels from the left.
float line_at(int y) { return 8.0f + 0.3f * static_cast<float>(y); }

EdgePicture edge_picture() {
  EdgePicture picture;
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      const float near_part = std::clamp(line_at(y) - static_cast<float>(x), 0.0f, 1.0f);
      const bool shows_near = near_part >= 0.5f;
      store_texel(picture.scene, x, y, shows_near ? kNear : kFar, {});
      store_texel(picture.other, x, y, shows_near ? kFar : kNear, {});
      const float other_part = shows_near ? 1.0f - near_part : near_part;
      row<std::uint8_t>(picture.coverage, y)[static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(other_part * 255.0f + 0.5f);
    }
  }
  return picture;
}

}  // namespace

TEST_CASE("smooth edges: what nothing blurs has each pixel's mean of its surfaces") {
  const EdgePicture picture = edge_picture();
  ThreadPool pool{2};
  for (const std::string_view method : {"pinhole", "two-pass", "disc-layers", "scatter"}) {
    const Image smooth = apply(*find_method(method), picture.input({0.0f, 4.0f}), pool);
    INFO(std::string{method});
    float worst = 0.0f;
    for (int y = 0; y < kEdgeHeight; ++y) {
      for (int x = 0; x < kEdgeWidth; ++x) {
        const float near_part = std::clamp(line_at(y) - static_cast<float>(x), 0.0f, 1.0f);
        const glm::vec4 mean = kNear * near_part + kFar * (1.0f - near_part);
        const glm::vec4 texel = load_texel(smooth, x, y);
        for (int k = 0; k < 3; ++k) worst = std::max(worst, std::abs(texel[k] - mean[k]));
        CHECK(texel.w == load_texel(picture.scene, x, y).w);
      }
    }
    CHECK(worst < 0.003f);
  }
}

TEST_CASE("smooth edges: a sharp surface before a blurred one has a smooth edge") {
  const EdgePicture picture = edge_picture();
  ThreadPool pool{2};
  const PixelCoc coc{6.0f, 2.0f};  // the near one is in focus
  const Image smooth = apply(*find_method("disc-layers"), picture.input(coc), pool);
  DofInput without = picture.input(coc);
  without.edges = {};
  const Image stairs = apply(*find_method("disc-layers"), without, pool);
  for (int y = 1; y + 1 < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      const float near_part = std::clamp(line_at(y) - static_cast<float>(x), 0.0f, 1.0f);
      const float texel = load_texel(smooth, x, y).x, before = load_texel(stairs, x, y).x;
      if (near_part == 0.0f || near_part == 1.0f) {
        CHECK(texel == before);
        continue;
      }
      // The blurred background beside the edge, as the filter has it.
      const float beside = load_texel(stairs, x + (near_part >= 0.5f ? 1 : 0), y).x;
      CHECK(texel ==
            doctest::Approx(kNear.x * near_part + beside * (1.0f - near_part)).epsilon(0.03));
    }
  }
}

TEST_CASE("smooth edges: a thing thinner than a pixel shows as far as it is in focus") {
  EdgePicture picture;
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      store_texel(picture.scene, x, y, kFar, {});
      store_texel(picture.other, x, y, kNear, {});
      row<std::uint8_t>(picture.coverage, y)[static_cast<std::size_t>(x)] = x == 9 ? 51 : 0;
    }
  }
  ThreadPool pool{1};
  const auto at_wire = [&](float radius, float focus) {
    const PixelCoc coc{radius, focus};
    return load_texel(apply(*find_method("pinhole"), picture.input(coc), pool), 9, 4).x;
  };
  CHECK(at_wire(0.0f, 4.0f) == doctest::Approx(kFar.x + 0.2f * (kNear.x - kFar.x)).epsilon(0.001));
}

TEST_CASE("smooth edges: a strand thinner than a pixel keeps its light in the blur, evenly") {
  constexpr int kColumns = 120, kRows = 400;
  constexpr double kStrand = 0.3;  // of a pixel
  ThreadPool pool{2};
  // Upright, where no centre shows it, and leaning to either side.
  for (const double lean : {0.0, 0.05, 0.2, -0.05, -0.2}) {
    CAPTURE(lean);
    EdgePicture picture;
    for (Image* image : {&picture.scene, &picture.other}) {
      *image = make_image(Format::rgba16f, kColumns, kRows);
    }
    picture.coverage = make_image(Format::r8, kColumns, kRows);
    double light = 0.0;
    for (int y = 0; y < kRows; ++y) {
      const double left = (lean < 0.0 ? 99.6 : 20.6) + lean * y;
      for (int x = 0; x < kColumns; ++x) {
        const double part =
            std::clamp(std::min(left + kStrand, x + 1.0) - std::max(left, x + 0.0), 0.0, 1.0);
        const bool shows = left <= x + 0.5 && x + 0.5 < left + kStrand;
        store_texel(picture.scene, x, y, shows ? kNear : kFar, {});
        store_texel(picture.other, x, y, shows ? kFar : kNear, {});
        row<std::uint8_t>(picture.coverage, y)[static_cast<std::size_t>(x)] =
            static_cast<std::uint8_t>(255.0 * (shows ? 1.0 - part : part) + 0.5);
        if (y >= 20 && y < kRows - 20) light += part;
      }
    }
    for (const char* method : {"disc-layers", "ray-distribution-buffer"}) {
      CAPTURE(method);
      // A near circle of 5 pixels.
      const Image blurred = apply(*find_method(method), picture.input({5.0f / 3.0f, 8.0f}), pool);
      double sum = 0.0, most = 0.0, least = 1.0;
      for (int y = 20; y < kRows - 20; ++y) {
        double of_row = 0.0;
        for (int x = 0; x < kColumns; ++x) {
          of_row +=
              static_cast<double>((load_texel(blurred, x, y).x - kFar.x) / (kNear.x - kFar.x));
          CHECK(load_texel(blurred, x, y).w == load_texel(picture.scene, x, y).w);
        }
        sum += of_row;
        most = std::max(most, of_row);
        least = std::min(least, of_row);
      }
      CHECK(sum == doctest::Approx(light).epsilon(0.03));
      CHECK(most < 1.5 * kStrand);
      CHECK(least > 0.5 * kStrand);
    }
  }
}

TEST_CASE("smooth edges: surfaces of one depth keep the filter's colour, and mix their own") {
  EdgePicture picture;
  const glm::vec4 a{0.5f, 0.5f, 0.5f, 3.0f}, b{1.0f, 0.25f, 0.0f, 3.02f};
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      store_texel(picture.scene, x, y, x < 12 ? a : b, {});
      store_texel(picture.other, x, y, x < 12 ? b : a, {});
      row<std::uint8_t>(picture.coverage, y)[static_cast<std::size_t>(x)] = x == 11 ? 102 : 0;
    }
  }
  ThreadPool pool{1};
  const glm::vec4 texel =
      load_texel(apply(*find_method("two-pass"), picture.input({0.0f, 1.0f}), pool), 11, 5);
  for (int k = 0; k < 3; ++k) {
    CHECK(texel[k] == doctest::Approx(a[k] + 0.4f * (b[k] - a[k])).epsilon(0.002));
  }
}

TEST_CASE(
    "smooth edges: what shadows change, the other surface takes from the pixel that shows it") {
  EdgePicture picture = edge_picture();
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      const glm::vec4 lit = load_texel(picture.other, x, y);
      store_texel(picture.other, x, y, glm::vec4{glm::vec3{lit} * 2.0f, lit.w}, {});
    }
  }
  ThreadPool pool{2};
  const Image other = picture.other;
  take_shown_colours(picture.scene, picture.coverage, picture.other, pool);
  int taken = 0;
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      const glm::vec4 texel = load_texel(picture.other, x, y);
      if (row<std::uint8_t>(picture.coverage, y)[static_cast<std::size_t>(x)] == 0) {
        CHECK(texel == load_texel(other, x, y));
        continue;
      }
      ++taken;
      CHECK(texel == (load_texel(picture.scene, x, y) == kNear ? kFar : kNear));
    }
  }
  CHECK(taken > 10);
}

TEST_CASE("smooth edges: the input is checked") {
  const EdgePicture picture = edge_picture();
  DofInput input = picture.input({1.0f, 2.0f});
  const Image result = make_image(Format::rgba16f, kEdgeWidth, kEdgeHeight);
  CHECK(input_error(input, result) == nullptr);
  input.edges.coverage = picture.other;
  CHECK(input_error(input, result) != nullptr);
  input = picture.input({1.0f, 2.0f});
  input.edges.other = picture.coverage;
  CHECK(input_error(input, result) != nullptr);
  input = picture.input({1.0f, 2.0f});
  const std::vector<float> radii(std::size_t{kEdgeWidth} * kEdgeHeight);
  input.radii_px = radii;
  CHECK(input_error(input, result) != nullptr);
}

TEST_CASE("smooth edges: what is blurred over a sharp edge hides what the edge's own colours are") {
  EdgePicture picture = edge_picture();
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      const glm::vec4 other = load_texel(picture.other, x, y);
      store_texel(picture.other, x, y, {glm::vec3{other} * 1.5f, other.w}, {});
    }
  }
  // As under a near thing, out of focus, of one colour.
  Image hidden = make_image(Format::rgba16f, kEdgeWidth, kEdgeHeight);
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) store_texel(hidden, x, y, {4.0f, 4.0f, 4.0f, 1.0f}, {});
  }
  Image smooth = hidden;
  ThreadPool pool{1};
  smooth_edges(picture.input({0.0f, 2.0f}), picture.scene, smooth, pool);
  CHECK(equal(smooth, hidden));
}

TEST_CASE("smooth edges: what a filter sees is the centres' where it could not be told of others") {
  ThreadPool pool{1};
  // A near circle of 5 pixels, and the same surfaces nearly of one depth.
  const PixelCoc coc{5.0f / 3.0f, 8.0f};
  EdgePicture picture = edge_picture();
  const DofInput input = picture.input(coc);
  CHECK(diffused_scene(input, pool).scene.texels != input.scene.texels);
  const std::vector<ConstImageView> behind{picture.other};
  DofInput with_layers = input;
  with_layers.behind = behind;
  CHECK(diffused_scene(with_layers, pool).scene.texels == input.scene.texels);
  const std::vector<std::uint16_t> objects(std::size_t{kEdgeWidth} * kEdgeHeight);
  DofInput with_objects = input;
  with_objects.objects = objects;
  CHECK(diffused_scene(with_objects, pool).scene.texels == input.scene.texels);
  CHECK(diffused_scene(picture.input({0.0f, 8.0f}), pool).scene.texels == input.scene.texels);
  for (Image* image : {&picture.scene, &picture.other}) {
    for (int y = 0; y < kEdgeHeight; ++y) {
      for (int x = 0; x < kEdgeWidth; ++x) {
        const glm::vec4 texel = load_texel(*image, x, y);
        store_texel(*image, x, y, {glm::vec3{texel}, texel.w == kFar.w ? 2.05f : 2.0f}, {});
      }
    }
  }
  CHECK(diffused_scene(picture.input(coc), pool).scene.texels == picture.scene.bytes.data());
}

TEST_CASE("smooth edges: a kept part is that of the whole, to its borders") {
  // A strand that no centre shows: a filter sees it in some rows.
  EdgePicture picture;
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      store_texel(picture.scene, x, y, kFar, {});
      store_texel(picture.other, x, y, kNear, {});
      row<std::uint8_t>(picture.coverage, y)[static_cast<std::size_t>(x)] = x == 9 ? 77 : 0;
    }
  }
  ThreadPool pool{1};
  const DofInput input = picture.input({5.0f / 3.0f, 8.0f});
  for (const char* name : {"scatter", "scatter-sorted", "layers", "disc-layers", "two-pass"}) {
    CAPTURE(name);
    const Method& method = *find_method(name);
    const Image whole = apply(method, input, pool);
    for (int top = 3; top < 9; ++top) {
      DofInput part = input;
      part.kept = {4, top, 12, 6};
      Image result = make_image(Format::rgba16f, kEdgeWidth, kEdgeHeight);
      apply(method, part, result, pool);
      bool equal_there = true;
      for (int y = top; y < top + 6; ++y) {
        for (int x = 4; x < 16; ++x) {
          equal_there = equal_there && load_texel(result, x, y) == load_texel(whole, x, y);
        }
      }
      CHECK(equal_there);
    }
  }
}

// A lens with circles of 12 pixels between the two surfaces above.
constexpr DofSettings kStrong{.coc = {16.0f, 2.0f}, .max_coc_px = 32.0f};

TEST_CASE("unmixed edges: two surfaces of one colour each are found again, with their parts") {
  const EdgePicture right = edge_picture();
  Image mixed = make_image(Format::rgba16f, kEdgeWidth, kEdgeHeight);
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      const float part = std::clamp(line_at(y) - static_cast<float>(x), 0.0f, 1.0f);
      glm::vec4 texel = kNear * part + kFar * (1.0f - part);
      texel.w = load_texel(right.scene, x, y).w;
      store_texel(mixed, x, y, texel, {});
    }
  }
  ThreadPool pool{1};
  const UnmixedEdges edges = unmix_edges(mixed, kStrong, {}, pool);
  CHECK(edges.pixels >= 12);  // not those that are a thousandth off
  for (int y = 0; y < kEdgeHeight; ++y) {
    for (int x = 0; x < kEdgeWidth; ++x) {
      CAPTURE(x);
      CAPTURE(y);
      CHECK(glm::length(load_texel(mixed, x, y) - load_texel(right.scene, x, y)) < 0.02f);
      const auto at = static_cast<std::size_t>(x);
      const int part = row<std::uint8_t>(edges.coverage, y)[at];
      CHECK(std::abs(part - row<std::uint8_t>(right.coverage, y)[at]) < 5);
      if (part == 0) continue;
      const glm::vec4 other = load_texel(edges.other, x, y);
      CHECK(glm::length(other - load_texel(right.other, x, y)) < 0.05f);
    }
  }
}

namespace {

// Of a scene, drawn at eight times the size: the mean of each pixel's colours, or the one next to
// its centre, with that one's depth.
Image reduced(const Image& large, bool mixes) {
  constexpr int kTimes = 8;
  Image small = make_image(Format::rgba16f, large.width / kTimes, large.height / kTimes);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      const glm::vec4 centre = load_texel(large, kTimes * x + kTimes / 2, kTimes * y + kTimes / 2);
      glm::vec4 sum{};
      for (int j = 0; j < kTimes; ++j) {
        for (int i = 0; i < kTimes; ++i) sum += load_texel(large, kTimes * x + i, kTimes * y + j);
      }
      sum *= 1.0f / (kTimes * kTimes);
      store_texel(small, x, y, mixes ? glm::vec4{glm::vec3{sum}, centre.w} : centre, {});
    }
  }
  return small;
}

Image large_scene(const char* name, int size, ThreadPool& pool) {
  const Scene scene = load_scene(name, scene_search_path({}));
  const int large = 8 * size;
  return draw_scene(scene, camera_matrices(scene.camera, 0.0, large, large), 0.0, large, large, {},
                    pool);
}

}  // namespace

TEST_CASE("unmixed edges: put together again they are the picture, and one sample a pixel stays") {
  ThreadPool pool{2}, one{1};
  const DofSettings strong{.coc = {1000.0f, 1.0f}, .max_coc_px = 1000.0f};
  for (const char* name : {"figures", "foliage", "sphere-world", "near-fence"}) {
    CAPTURE(name);
    const Image large = large_scene(name, 96, pool);
    const Image mixed = reduced(large, true);
    Image taken_apart = mixed;
    const UnmixedEdges edges = unmix_edges(taken_apart, strong, {}, pool);
    CHECK(edges.pixels > 50);
    const Image together = apply(*find_method("pinhole"),
                                 {.scene = taken_apart,
                                  .settings = {},
                                  .profile = {},
                                  .edges = {edges.coverage, edges.other}},
                                 pool);
    float most = 0.0f;
    for (int y = 0; y < mixed.height; ++y) {
      for (int x = 0; x < mixed.width; ++x) {
        const glm::vec4 apart = load_texel(together, x, y) - load_texel(mixed, x, y);
        for (int c = 0; c < 4; ++c) most = std::max(most, std::fabs(apart[c]));
      }
    }
    CHECK(most < 0.05f);
    Image again = mixed;
    CHECK(equal(unmix_edges(again, strong, {}, one).other, edges.other));
    CHECK(equal(again, taken_apart));
    const Image aliased = reduced(large, false);
    Image left = aliased;
    CHECK(unmix_edges(left, strong, {}, pool).pixels == 0);
    CHECK(equal(left, aliased));
  }
}

TEST_CASE("unmixed edges: black, bright and infinitely far things stay numbers, none negative") {
  ThreadPool pool{1};
  std::size_t taken = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    test::Random random{static_cast<std::uint64_t>(seed)};
    const auto channel = [&] {
      constexpr std::array kChannels{0.0f, 0.5f, 1.0f, 64000.0f};
      return kChannels[static_cast<std::size_t>(random.whole(0, 3))];
    };
    const glm::vec3 near{channel(), channel(), channel()}, far{channel(), channel(), channel()};
    const float far_m = seed % 2 == 0 ? 60000.0f : INFINITY;
    Image picture = make_image(Format::rgba16f, 64, 64);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        // Leaning stripes, every edge pixel a mixture of both, a tenth of all pixels black.
        const float place = std::fmod(static_cast<float>(x) + 0.3f * static_cast<float>(y), 16.0f);
        const float part = std::clamp(std::min(place, 16.0f - place) - 3.5f, 0.0f, 1.0f);
        const float light = random.whole(0, 9) == 0 ? 0.0f : random.between(0.8f, 1.02f);
        const glm::vec3 colour = (near * part + far * (1.0f - part)) * light;
        store_texel(picture, x, y, {colour, part >= 0.5f ? 2.0f : far_m}, {});
      }
    }
    Image again = picture;
    const UnmixedEdges edges = unmix_edges(again, kStrong, {}, pool);
    taken += edges.pixels;
    if (edges.pixels == 0) continue;  // of colours that are nearly one
    const auto is_light = [](const glm::vec4& texel) {
      return std::isfinite(texel.x + texel.y + texel.z) &&
             std::min({texel.x, texel.y, texel.z}) >= 0.0f;
    };
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        REQUIRE(is_light(load_texel(again, x, y)));
        if (row<std::uint8_t>(edges.coverage, y)[static_cast<std::size_t>(x)] == 0) continue;
        REQUIRE(is_light(load_texel(edges.other, x, y)));
      }
    }
  }
  CHECK(taken > 5000);
}

TEST_CASE("unmixed edges: on textures the depths around a pixel tell its parts, too") {
  ThreadPool pool{1};
  test::Random random{5};
  // The first rows are without texture, or the picture would not be known to be mixed.
  constexpr int kColumns = 64, kRows = 128, kPlainRows = 64;
  Image picture = make_image(Format::rgba16f, kColumns, kRows);
  std::vector<float> parts;
  for (int y = 0; y < kRows; ++y) {
    // To the left of the line, near. On the right a strand of less than a pixel, over the texture.
    const float line = 12.0f + 0.15f * static_cast<float>(y);
    const float texture = y < kPlainRows ? 0.0f : 1.0f;
    for (int x = 0; x < kColumns; ++x) {
      const float near_part = std::clamp(line - static_cast<float>(x), 0.0f, 1.0f);
      parts.push_back(near_part);
      const glm::vec3 near =
          glm::vec3{0.6f, 0.4f, 0.3f} * (1.0f + texture * random.between(-0.4f, 0.4f));
      const glm::vec3 far =
          glm::vec3{0.35f, 0.5f, 0.6f} * (1.0f + texture * random.between(-0.7f, 0.7f));
      const float strand = x == 50 ? 0.4f : 0.0f;
      const glm::vec3 colour = near * near_part + far * (1.0f - near_part - strand) +
                               glm::vec3{0.2f, 0.3f, 0.6f} * strand;
      const bool is_near = near_part >= 0.5f || (strand > 0.0f && y % 5 < 2);
      store_texel(picture, x, y, {colour, is_near ? 2.0f : 8.0f}, {});
    }
  }
  Image again = picture;
  const UnmixedEdges edges = unmix_edges(again, kStrong, {}, pool);
  REQUIRE(edges.pixels > 50);
  double squares = 0.0;
  int count = 0, strands = 0;
  for (int y = kPlainRows + 2; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const std::uint8_t byte = row<std::uint8_t>(edges.coverage, y)[static_cast<std::size_t>(x)];
      if (x > 45) strands += byte != 0 ? 1 : 0;
      const float near = parts[static_cast<std::size_t>(y * kColumns + x)];
      if (x > 45 || byte == 0) continue;
      const float apart = static_cast<float>(byte) / 255.0f - (near >= 0.5f ? 1.0f - near : near);
      squares += static_cast<double>(apart * apart);
      ++count;
    }
  }
  MESSAGE(std::sqrt(squares / count) << " of " << count << ", strands " << strands);
  CHECK(std::sqrt(squares / count) < 0.2);
  // The strand's light could be the texture's.
  CHECK(strands < 20);
}

TEST_CASE("unmixed edges: a renderer's picture comes nearer to its own lens's") {
  ThreadPool pool{2};
  for (const char* name : {"figures", "foliage"}) {
    CAPTURE(name);
    const Scene scene = load_scene(name, scene_search_path({}));
    Shot views = shot_of(scene, 0.0, 192, 192, find_method_choice("accumulation"));
    views.sampling.samples = 128;
    views.sampling.jitter = true;
    const Image truth = make_frame(views, pool).picture;
    const Shot filtered = shot_of(scene, 0.0, 192, 192, find_method_choice("disc-layers"));
    const DofSettings settings = make_frame(filtered, pool).lens->settings;
    Image picture = reduced(large_scene(name, 192, pool), true);
    const auto error = [&](const EdgeSurfaces& edges) {
      const Image made =
          apply(*filtered.method.filter,
                {.scene = picture, .settings = settings, .profile = {}, .edges = edges}, pool);
      return mean(flip_map(truth, made, clamped_tone(), pool));
    };
    const double mixed = error({});
    const UnmixedEdges edges = unmix_edges(picture, settings, {}, pool);
    const double unmixed = error({edges.coverage, edges.other});
    MESSAGE(mixed << ", " << unmixed);
    CHECK(unmixed < (scene.name == "figures" ? 0.95 : 1.0) * mixed);
  }
}
