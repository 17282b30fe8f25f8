#include "scenes/make/procedural_texture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <string>

#include "raster/images/texel.h"
#include "raster/numbers/hash.h"
#include "raster/numbers/random_bits.h"

using namespace softfocus;

namespace {

TextureRecipe recipe_for(const TexturePattern& pattern) {
  TextureRecipe recipe;
  recipe.size = 64;
  recipe.cells = 4;
  recipe.colours = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
  recipe.colours.resize(pattern.colour_count);
  return recipe;
}

Texture make(std::string_view name) {
  const TexturePattern& pattern = *find_texture_pattern(name);
  return make_procedural_texture(pattern, recipe_for(pattern));
}

// How much two neighbouring columns (or rows) of texels differ on average.
double column_difference(const Image& image, int x0, int x1) {
  double sum = 0.0;
  for (int y = 0; y < image.height; ++y) {
    const glm::vec4 d = load_texel(image, x0, y) - load_texel(image, x1, y);
    sum += d.x * d.x + d.y * d.y + d.z * d.z;
  }
  return sum / image.height;
}

double row_difference(const Image& image, int y0, int y1) {
  double sum = 0.0;
  for (int x = 0; x < image.width; ++x) {
    const glm::vec4 d = load_texel(image, x, y0) - load_texel(image, x, y1);
    sum += d.x * d.x + d.y * d.y + d.z * d.z;
  }
  return sum / image.width;
}

}  // namespace

TEST_CASE("every pattern makes a linear 8-bit texture with all its mipmaps") {
  for (const TexturePattern& pattern : texture_patterns()) {
    CAPTURE(pattern.name);
    const Texture texture = make(pattern.name);
    REQUIRE(texture.levels.size() == 7);  // 64 to 1
    CHECK(texture.levels[0].format == Format::rgba8);
    CHECK(texture.levels[0].width == 64);
    CHECK(texture.levels[6].width == 1);
    CHECK(load_texel(texture.levels[0], 5, 9).w == 1.0f);
  }
}

TEST_CASE("every pattern shows each of its colours") {
  for (const TexturePattern& pattern : texture_patterns()) {
    const Texture texture = make(pattern.name);
    for (std::size_t c = 0; c < pattern.colour_count; ++c) {
      CAPTURE(pattern.name);
      CAPTURE(c);
      float most = 0.0f;
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
          most = std::max(most, load_texel(texture.levels[0], x, y)[static_cast<int>(c)]);
        }
      }
      CHECK(most > 0.4f);
    }
  }
}

TEST_CASE("a pattern repeats without a seam") {
  for (const TexturePattern& pattern : texture_patterns()) {
    CAPTURE(pattern.name);
    const Texture texture = make(pattern.name);
    const Image& image = texture.levels[0];
    // Across the seam, neighbours differ no more than at the worst place inside.
    double worst_columns = 0.0;
    double worst_rows = 0.0;
    for (int i = 0; i + 1 < 64; ++i) {
      worst_columns = std::max(worst_columns, column_difference(image, i, i + 1));
      worst_rows = std::max(worst_rows, row_difference(image, i, i + 1));
    }
    CHECK(column_difference(image, 63, 0) <= worst_columns * 1.3 + 0.001);
    CHECK(row_difference(image, 63, 0) <= worst_rows * 1.3 + 0.001);
  }
}

TEST_CASE("a checker has its first colour in the upper left field") {
  const Texture texture = make("checker");
  const glm::vec4 first = load_texel(texture.levels[0], 8, 8);
  const glm::vec4 right = load_texel(texture.levels[0], 24, 8);
  CHECK(first.x > 0.8f);
  CHECK(first.y == 0.0f);
  CHECK(right.x == 0.0f);
  CHECK(right.y > 0.8f);
}

TEST_CASE("stripes run along u") {
  const Texture texture = make("stripes");
  for (int x = 0; x < 64; ++x) {
    CHECK(load_texel(texture.levels[0], x, 8).y == 0.0f);
    CHECK(load_texel(texture.levels[0], x, 24).x == 0.0f);
  }
}

TEST_CASE("another seed gives another marble, the same seed the same") {
  const TexturePattern& pattern = *find_texture_pattern("marble");
  TextureRecipe recipe = recipe_for(pattern);
  const std::uint64_t once = hash_image(make_procedural_texture(pattern, recipe).levels[0]);
  CHECK(hash_image(make_procedural_texture(pattern, recipe).levels[0]) == once);
  recipe.seed = 2;
  CHECK(hash_image(make_procedural_texture(pattern, recipe).levels[0]) != once);
}

TEST_CASE("textures have the same bytes on every unit and any number of threads") {
  RandomSequence random{7};
  std::vector<ProceduralTexture> wanted;
  for (int i = 0; i < 48; ++i) {
    const TexturePattern& pattern =
        texture_patterns()[static_cast<std::size_t>(i) % texture_patterns().size()];
    TextureRecipe recipe;
    recipe.size = 1 << next_bits(random) % 8;
    recipe.cells = 1 << next_bits(random) % 9;
    if (i % 3 > 0) recipe.cells = 1 + static_cast<int>(next_bits(random) % 20);
    recipe.seed = next_bits(random) % 100;
    for (std::size_t c = 0; c < pattern.colour_count; ++c) {
      glm::vec3 colour;
      for (int k = 0; k < 3; ++k) {
        const double value = std::clamp(next_between(random, -0.2, 1.2), 0.0, 1.0);
        colour[k] = static_cast<float>(value);
      }
      recipe.colours.push_back(colour);
    }
    wanted.push_back({&pattern, recipe});
  }
  ThreadPool oracle{1, Isa::scalar};
  const std::vector<Texture> expected = make_procedural_textures(wanted, &oracle);
  for (const Isa isa : available_isas()) {
    CAPTURE(isa_name(isa));
    ThreadPool pool{3, isa};
    const std::vector<Texture> made = make_procedural_textures(wanted, &pool);
    REQUIRE(made.size() == expected.size());
    for (std::size_t i = 0; i < made.size(); ++i) {
      CAPTURE(wanted[i].pattern->name);
      CAPTURE(wanted[i].recipe.size);
      CAPTURE(wanted[i].recipe.cells);
      REQUIRE(made[i].levels.size() == expected[i].levels.size());
      for (std::size_t level = 0; level < made[i].levels.size(); ++level) {
        CHECK(equal(made[i].levels[level], expected[i].levels[level]));
      }
    }
  }
}

TEST_CASE("a texture of one texel has one level") {
  const TexturePattern& pattern = *find_texture_pattern("clouds");
  TextureRecipe recipe = recipe_for(pattern);
  recipe.size = 1;
  CHECK(make_procedural_texture(pattern, recipe).levels.size() == 1);
}

TEST_CASE("there is no pattern of an unknown name") {
  CHECK(find_texture_pattern("plaid") == nullptr);
}
