#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "raster/images/sampler.h"
#include "raster/images/texel.h"
#include "raster/numbers/srgb.h"
#include "raster/passes/draw_mipmaps.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

Texture random_texture(Format format, int width, int height, std::uint64_t seed) {
  Image image = make_image(format, width, height);
  test::Random random{seed};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      glm::vec4 value{};
      for (int i = 0; i < 4; ++i) value[i] = random.between(0.0f, 1.0f);
      store_texel(image, x, y, value, {});
    }
  }
  return make_texture(std::move(image));
}

// The mean in binary64 of the texels under texel (x, y) of the level below; along a side
// of length 1 there is only one.
glm::dvec4 mean_below(const Image& fine, int x, int y) {
  glm::dvec4 sum{0.0};
  int count = 0;
  for (int j = 2 * y; j <= 2 * y + 1 && j < fine.height; ++j) {
    for (int i = 2 * x; i <= 2 * x + 1 && i < fine.width; ++i) {
      sum += glm::dvec4{load_texel(fine, i, j)};
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

// The largest difference of a texel from the mean of those under it.
double farthest_from_means(const Texture& texture) {
  double worst = 0.0;
  for (std::size_t level = 1; level < texture.levels.size(); ++level) {
    const Image& coarse = texture.levels[level];
    for (int y = 0; y < coarse.height; ++y) {
      for (int x = 0; x < coarse.width; ++x) {
        const glm::dvec4 exact = mean_below(texture.levels[level - 1], x, y);
        const glm::vec4 value = load_texel(coarse, x, y);
        for (int i = 0; i < 4; ++i) worst = std::max(worst, std::fabs(value[i] - exact[i]));
      }
    }
  }
  return worst;
}

// As the standard says: sums of two, their sum, a quarter of it.
Image halved(const Image& fine, const Profile& profile) {
  Image coarse = make_image(fine.format, std::max(1, fine.width / 2), std::max(1, fine.height / 2));
  for (int y = 0; y < coarse.height; ++y) {
    for (int x = 0; x < coarse.width; ++x) {
      const int x1 = std::min(2 * x + 1, fine.width - 1);
      const int y1 = std::min(2 * y + 1, fine.height - 1);
      const glm::vec4 sum = (load_texel(fine, 2 * x, 2 * y) + load_texel(fine, x1, 2 * y)) +
                            (load_texel(fine, 2 * x, y1) + load_texel(fine, x1, y1));
      store_texel(coarse, x, y, sum * 0.25f, profile);
    }
  }
  return coarse;
}

}  // namespace

TEST_CASE("each level has the rounded means of the one before, in every format and profile") {
  for (const Format format :
       {Format::r8, Format::rgba8, Format::srgb8, Format::rgba16f, Format::rgba32f}) {
    for (const auto& size : {std::pair{16, 16}, {13, 7}, {1, 6}, {5, 1}}) {
      for (const NamedProfile& known : profiles()) {
        CAPTURE(known.name);
        CAPTURE(size.first);
        Texture texture = random_texture(format, size.first, size.second, 3);
        generate_mipmaps(texture, known.profile);
        for (std::size_t level = 1; level < texture.levels.size(); ++level) {
          CHECK(equal(texture.levels[level], halved(texture.levels[level - 1], known.profile)));
        }
      }
    }
  }
}

TEST_CASE("mip levels halve each side, rounded down, until both are 1") {
  struct Chain {
    int width, height;
    std::vector<std::pair<int, int>> levels;
  };
  for (const Chain& chain : std::vector<Chain>{{1, 1, {{1, 1}}},
                                               {8, 2, {{8, 2}, {4, 1}, {2, 1}, {1, 1}}},
                                               {5, 3, {{5, 3}, {2, 1}, {1, 1}}},
                                               {1, 7, {{1, 7}, {1, 3}, {1, 1}}},
                                               {6, 1, {{6, 1}, {3, 1}, {1, 1}}}}) {
    Texture texture = make_texture(make_image(Format::rgba8, chain.width, chain.height));
    generate_mipmaps(texture, {});
    REQUIRE(texture.levels.size() == chain.levels.size());
    for (std::size_t i = 0; i < chain.levels.size(); ++i) {
      CHECK(texture.levels[i].width == chain.levels[i].first);
      CHECK(texture.levels[i].height == chain.levels[i].second);
      CHECK(texture.levels[i].format == Format::rgba8);
    }
  }
}

TEST_CASE("every mip texel is the mean of those under it, odd and thin textures too") {
  double worst = 0.0;
  for (const auto& [width, height] :
       {std::pair{16, 16}, {5, 3}, {1, 13}, {11, 1}, {7, 8}, {32, 2}}) {
    Texture texture = random_texture(Format::rgba32f, width, height, 41);
    generate_mipmaps(texture, {});
    worst = std::max(worst, farthest_from_means(texture));
  }
  CHECK(worst < 2 * 0x1p-24);
}

TEST_CASE("the sum is taken as (a + b) + (c + d)") {
  Image image = make_image(Format::r32f, 2, 2);
  // ((1 + 2^-24) + (2^-24 + 2^-24)): in any other order the three small ones would be
  // lost one by one, or all kept.
  row<float>(image, 0)[0] = 1.0f;
  row<float>(image, 0)[1] = 0x1p-24f;
  row<float>(image, 1)[0] = 0x1p-24f;
  row<float>(image, 1)[1] = 0x1p-24f;
  Texture texture = make_texture(std::move(image));
  generate_mipmaps(texture, {});
  CHECK(load_texel(texture.levels[1], 0, 0).x == (1.0f + 0x1p-23f) * 0.25f);
}

TEST_CASE("mip levels of half textures are stored with the profile's rounding") {
  Image image = make_image(Format::rgba16f, 2, 1);
  store_texel(image, 0, 0, glm::vec4{1.0f}, {});
  store_texel(image, 1, 0, glm::vec4{1.0f + 3.0f / 1024.0f}, {});
  Texture texture = make_texture(std::move(image));  // mean 1 + 1.5/1024, a tie
  generate_mipmaps(texture, profile_named("ieee"));
  CHECK(load_texel(texture.levels[1], 0, 0).x == 1.0f + 2.0f / 1024.0f);
  generate_mipmaps(texture, profile_named("d3d11"));
  CHECK(load_texel(texture.levels[1], 0, 0).x == 1.0f + 1.0f / 1024.0f);
}

TEST_CASE("sRGB textures are averaged as light, their alpha as it is") {
  Image image = make_image(Format::srgb8, 2, 1);
  store_texel(image, 1, 0, glm::vec4{1.0f}, {});
  Texture texture = make_texture(std::move(image));
  generate_mipmaps(texture, {});
  const auto texel = row<std::uint8_t>(texture.levels[1], 0);
  CHECK(texel[0] == linear_to_srgb8(0.5f));
  CHECK(texel[3] == 128);
}

TEST_CASE("generating again replaces the levels and leaves level 0") {
  Texture texture = random_texture(Format::rgba8, 8, 8, 42);
  const Image original = texture.levels[0];
  generate_mipmaps(texture, {});
  const std::uint64_t once = hash_image(texture.levels[2]);
  generate_mipmaps(texture, {});
  CHECK(texture.levels.size() == 4);
  CHECK(equal(texture.levels[0], original));
  CHECK(hash_image(texture.levels[2]) == once);
}

// --- as drivers draw them ---

namespace {

// Texels (37 x + 91 y + 11) mod 256.
Texture hatched_texture(int width, int height) {
  Image image = make_image(Format::r8, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      row<std::uint8_t>(image, y)[static_cast<std::size_t>(x)] =
          static_cast<std::uint8_t>(37 * x + 91 * y + 11);
    }
  }
  return make_texture(std::move(image));
}

// All texels of levels 1 and on.
std::vector<int> coarse_texels(const Texture& texture) {
  std::vector<int> texels;
  for (std::size_t level = 1; level < texture.levels.size(); ++level) {
    for (int y = 0; y < texture.levels[level].height; ++y) {
      for (const int texel : row<std::uint8_t>(texture.levels[level], y)) texels.push_back(texel);
    }
  }
  return texels;
}

constexpr std::array kDrivers{"llvmpipe", "llvmpipe-sse41", "softpipe"};

}  // namespace

TEST_CASE("drawn levels are those that Mesa's drivers were seen to make of odd sizes") {
  for (const char* name : {"llvmpipe", "llvmpipe-sse41"}) {
    Texture small = hatched_texture(5, 3);
    draw_mipmaps(small, profile_named(name));
    CHECK(coarse_texels(small) == std::vector{130, 222, 176});
    Texture large = hatched_texture(7, 9);
    draw_mipmaps(large, profile_named(name));
    CHECK(coarse_texels(large) ==
          std::vector{93, 179, 105, 74, 128, 214, 214, 76, 152, 131, 185, 111, 154, 131, 143});
  }
  Texture small = hatched_texture(5, 3);
  draw_mipmaps(small, profile_named("softpipe"));
  CHECK(coarse_texels(small) == std::vector{130, 222, 176});
  Texture large = hatched_texture(7, 9);
  draw_mipmaps(large, profile_named("softpipe"));
  CHECK(coarse_texels(large) ==
        std::vector{93, 179, 105, 73, 128, 214, 214, 76, 152, 131, 185, 111, 154, 130, 142});
}

TEST_CASE("where sides are powers of two a drawn texel is the mean of those under it") {
  for (const char* name : kDrivers) {
    Texture texture = random_texture(Format::rgba32f, 32, 8, 43);
    draw_mipmaps(texture, profile_named(name));
    REQUIRE(texture.levels.size() == 6);
    CHECK_MESSAGE(farthest_from_means(texture) < 4 * 0x1p-24, name);
  }
}

TEST_CASE("the drawn levels of a constant texture are constant, in every format and size") {
  int wrong = 0;
  for (const char* name : kDrivers) {
    for (const Format format : {Format::r8, Format::rgba8, Format::rgba16f, Format::rgba32f}) {
      for (const auto& [width, height] : {std::pair{5, 3}, {1, 9}, {16, 16}, {100, 7}}) {
        Texture texture = make_texture(make_image(format, width, height));
        clear_image(texture.levels[0], glm::vec4{0.8f}, {});
        const glm::vec4 value = load_texel(texture.levels[0], 0, 0);
        draw_mipmaps(texture, profile_named(name));
        for (const Image& level : texture.levels) {
          wrong += load_texel(level, level.width - 1, level.height / 2) != value;
        }
      }
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("no drawn texel lies outside the smallest and the largest of an 8-bit texture") {
  for (const char* name : kDrivers) {
    Texture texture = make_texture(make_image(Format::rgba8, 37, 19));
    test::Random random{44};
    for (int y = 0; y < 19; ++y) {
      for (std::uint8_t& byte : row<std::uint8_t>(texture.levels[0], y)) {
        byte = static_cast<std::uint8_t>(random.whole(90, 130));
      }
    }
    draw_mipmaps(texture, profile_named(name));
    const std::vector<int> texels = coarse_texels(texture);
    CHECK(std::all_of(texels.begin(), texels.end(), [](int t) { return t >= 90 && t <= 130; }));
  }
}

TEST_CASE("drawing flushes the subnormals of float textures, in softpipe too") {
  for (const char* name : kDrivers) {
    Texture texture = make_texture(make_image(Format::r32f, 2, 2));
    clear_image(texture.levels[0], glm::vec4{1e-39f}, {});
    draw_mipmaps(texture, profile_named(name));
    CHECK(load_texel(texture.levels[0], 0, 0).x == 1e-39f);
    CHECK(load_texel(texture.levels[1], 0, 0).x == 0.0f);
  }
}

TEST_CASE("levels are drawn for the profiles of drivers and box-filtered for the others") {
  for (const NamedProfile& known : profiles()) {
    const Profile& profile = known.profile;
    Texture asked = random_texture(Format::rgba32f, 7, 5, 45);
    Texture drawn = asked;
    Texture boxed = asked;
    generate_mipmaps_as(asked, profile);
    draw_mipmaps(drawn, profile);
    generate_mipmaps(boxed, profile);
    const bool is_standard = profile.texture_unit == TextureUnit::standard;
    CHECK(equal(asked.levels[1], boxed.levels[1]) == is_standard);
    CHECK(equal(asked.levels[1], drawn.levels[1]) == !is_standard);
  }
}
