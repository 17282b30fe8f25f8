// Arrays, volumes and cubes: which texel is whose neighbour, filters against the oracle, mip
// levels, pictures that are cut into slices.

#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"
#include "tests/support/random.h"
#include "tests/support/sliced_oracle.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

Texture random_slices(TextureShape shape, Format format, int width, int height, int count,
                      Random& random) {
  std::vector<Image> slices;
  for (int i = 0; i < count; ++i) {
    Image image = make_image(format, width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        store_texel(image, x, y, {random.unit(), random.unit(), random.unit(), random.unit()}, {});
      }
    }
    slices.push_back(std::move(image));
  }
  return make_sliced_texture(shape, std::move(slices));
}

/// A picture whose texels tell their column and row.
Image numbered(int width, int height) {
  Image image = make_image(Format::rgba32f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      store_texel(image, x, y, {static_cast<float>(x), static_cast<float>(y), 0.0f, 1.0f}, {});
    }
  }
  return image;
}

constexpr std::array kFilters{Filter::nearest, Filter::bilinear, Filter::trilinear};
constexpr std::array kWraps{Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};

}  // namespace

TEST_CASE("beyond an edge of a cube lies the texel that the direction through its centre meets") {
  for (const int size : {1, 2, 3, 4, 7, 16}) {
    for (int face = 0; face < 6; ++face) {
      for (int i = 0; i < size; ++i) {
        for (const CubeTexel at :
             {CubeTexel{face, -1, i}, CubeTexel{face, size, i}, CubeTexel{face, i, -1},
              CubeTexel{face, i, size}, CubeTexel{face, i, size / 2}}) {
          CAPTURE(size);
          CAPTURE(face);
          CAPTURE(at.x);
          CAPTURE(at.y);
          const CubeTexel found = cube_texel(at, size), expected = oracle_cube_texel(at, size);
          CHECK(found.face == expected.face);
          CHECK(found.x == expected.x);
          CHECK(found.y == expected.y);
        }
      }
    }
  }
}

TEST_CASE("a direction meets the face of OpenGL's table; of equal axes z goes first, then y") {
  const auto face = [](float x, float y, float z) { return cube_place({x, y, z}).face; };
  CHECK(face(2, 1, 1) == 0);
  CHECK(face(-2, 1, 1) == 1);
  CHECK(face(1, 2, 1) == 2);
  CHECK(face(1, -2, 1) == 3);
  CHECK(face(1, 1, 2) == 4);
  CHECK(face(1, 1, -2) == 5);
  CHECK(face(1, 1, 1) == 4);
  CHECK(face(1, -1, -1) == 5);
  CHECK(face(1, -1, 0) == 3);
  const CubePlace place = cube_place({4.0f, 1.0f, -2.0f});
  CHECK(place.at == glm::vec2{0.75f, 0.375f});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(cube_place({nan, nan, nan}).at == glm::vec2{0.0f, 0.0f});
  CHECK(cube_place({0.0f, 0.0f, 0.0f}).at == glm::vec2{0.0f, 0.0f});
}

TEST_CASE("volumes and cubes are filtered as the equations say, to the bit") {
  Random random{5};
  for (const TextureShape shape : {TextureShape::volume, TextureShape::cube}) {
    const bool is_cube = shape == TextureShape::cube;
    for (const Format format : {Format::rgba8, Format::rgba16f, Format::rgba32f}) {
      Texture texture =
          random_slices(shape, format, is_cube ? 5 : 6, is_cube ? 5 : 3, is_cube ? 6 : 5, random);
      generate_mipmaps(texture, {});
      for (const Filter filter : kFilters) {
        for (const bool has_fixed_weights : {false, true}) {
          Profile profile;
          if (has_fixed_weights) profile.bilinear_weights = BilinearWeights::fixed_8;
          for (int i = 0; i < 200; ++i) {
            const auto wrap = [&] { return kWraps[static_cast<std::size_t>(random.whole(0, 2))]; };
            const Sampler sampler{filter, wrap(), wrap(), wrap()};
            const auto part = [&] {
              return random.whole(0, 5) == 0 ? static_cast<float>(random.whole(-2, 2)) / 2.0f
                                             : random.between(-1.5f, 1.5f);
            };
            glm::vec3 at{part(), part(), part()};
            if (is_cube && at == glm::vec3{0.0f}) at.x = 1.0f;
            const float lod = random.between(-1.0f, 4.0f);
            const SlicedOracle oracle{texture, sampler, has_fixed_weights};
            CAPTURE(at.x);
            CAPTURE(at.y);
            CAPTURE(at.z);
            CAPTURE(lod);
            CHECK(sample_sliced(texture, sampler, at, lod, profile) == oracle.sampled(at, lod));
          }
        }
      }
    }
  }
}

TEST_CASE("a cube of one colour a face is seamless: a corner has the mean of its faces") {
  std::vector<Image> faces;
  for (int i = 0; i < 6; ++i) {
    faces.push_back(make_image(Format::rgba32f, 4, 4));
    clear_image(faces.back(), glm::vec4{i == 0 ? 3.0f : 0.0f, i == 2 ? 3.0f : 0.0f, 0.0f, 1.0f},
                {});
  }
  const Texture cube = make_sliced_texture(TextureShape::cube, std::move(faces));
  const auto at = [&](float x, float y, float z) {
    return sample_sliced(cube, {}, {x, y, z}, 0, {});
  };
  CHECK(at(1, 0, 0) == glm::vec4{3, 0, 0, 1});
  CHECK(at(1, 1, 0).x == doctest::Approx(1.5));
  CHECK(at(1, 1, 0).y == doctest::Approx(1.5));
  for (const float z : {0.9999999f, 1.0f}) {
    CHECK(at(1, 1, z).x == doctest::Approx(1.0));
    CHECK(at(1, 1, z).y == doctest::Approx(1.0));
  }
}

TEST_CASE("a layer is the nearest, ties to even, and its sampling that of a flat texture") {
  Random random{9};
  Texture array = random_slices(TextureShape::array, Format::rgba8, 5, 3, 4, random);
  generate_mipmaps(array, {});
  CHECK(array.behind[2].levels.size() == 3);
  const auto layer = [&](float at) { return nearest_layer(array, at, {}); };
  CHECK(layer(0.5f) == 0);
  CHECK(layer(0.51f) == 1);
  CHECK(layer(1.5f) == 2);
  CHECK(layer(2.5f) == 2);
  CHECK(layer(-7.0f) == 0);
  CHECK(layer(9e9f) == 3);
  CHECK(layer(std::numeric_limits<float>::quiet_NaN()) == 0);
  const Sampler sampler{Filter::trilinear};
  for (const char* name : {"ieee", "d3d11", "llvmpipe", "softpipe", "swiftshader"}) {
    const Profile profile = *find_profile(name);
    for (int i = 0; i < 50; ++i) {
      const glm::vec2 uv{random.between(-1.0f, 2.0f), random.between(-1.0f, 2.0f)};
      const float lod = random.between(0.0f, 2.0f);
      CHECK(sample_sliced(array, sampler, {uv, 2.2f}, lod, profile) ==
            sample(array.behind[1], sampler, uv, lod, profile));
    }
  }
}

TEST_CASE("a level of a volume is the mean of two slices' four texels") {
  std::vector<Image> slices;
  for (int i = 0; i < 5; ++i) {
    slices.push_back(make_image(Format::rgba32f, 2, 3));
    clear_image(slices.back(), glm::vec4{static_cast<float>(i)}, {});
  }
  store_texel(slices[1], 1, 1, glm::vec4{9.0f}, {});
  Texture volume = make_sliced_texture(TextureShape::volume, std::move(slices));
  generate_mipmaps(volume, {});
  REQUIRE(volume.levels.size() == 3);
  CHECK(slice_count(volume, 1) == 2);
  CHECK(slice_count(volume, 2) == 1);
  CHECK(volume.behind[0].levels.size() == 2);
  CHECK(volume.behind[1].levels.size() == 1);
  CHECK(load_texel(volume.levels[1], 0, 0).x == (4 * 0 + 3 * 1 + 9) / 8.0f);
  CHECK(load_texel(volume.behind[0].levels[1], 0, 0).x == 2.5f);
  CHECK(load_texel(volume.levels[2], 0, 0).x == 2.0f);
}

TEST_CASE("a volume's level of detail counts texels along w, too; a cube's those on the face") {
  Random random{2};
  const Texture volume = random_slices(TextureShape::volume, Format::rgba8, 8, 8, 32, random);
  const auto lod = [&](glm::vec3 x, glm::vec3 y) {
    return sliced_level_of_detail(volume, glm::vec3{0.0f}, x, y, {});
  };
  CHECK(lod({0.125f, 0, 0}, {0, 0, 0}) == 0.0f);
  CHECK(lod({0.125f, 0, 0}, {0, 0, 0.125f}) == 2.0f);
  const Texture cube = random_slices(TextureShape::cube, Format::rgba8, 64, 64, 6, random);
  // At the middle of +x a step of 1/8 along z is 1/16 of the face: 4 texels.
  CHECK(sliced_level_of_detail(cube, {1, 0, 0}, {0, 0, 0.125f}, {0, 0, 0}, {}) == 2.0f);
  // Along the direction itself nothing changes.
  CHECK(sliced_level_of_detail(cube, {2, 1, -1}, {0.5f, 0.25f, -0.25f}, {0, 0, 0.25f}, {}) ==
        sliced_level_of_detail(cube, {2, 1, -1}, {0, 0, 0}, {0, 0, 0.25f}, {}));
}

TEST_CASE("a picture is cut into slices from the left or the top, a cross into its faces") {
  const auto origin = [](const Texture& texture, int slice) {
    const glm::vec4 texel = load_texel(slice_level(texture, slice, 0), 0, 0);
    return glm::vec2{texel.x, texel.y};
  };
  const Texture row = cut_texture(numbered(8, 2), TextureShape::volume);
  CHECK(slice_count(row) == 4);
  CHECK(origin(row, 3) == glm::vec2{6, 0});
  const Texture column = cut_texture(numbered(2, 12), TextureShape::cube);
  CHECK(origin(column, 5) == glm::vec2{0, 10});
  const Texture cross = cut_texture(numbered(8, 6), TextureShape::cube);
  CHECK(origin(cross, 0) == glm::vec2{4, 2});
  CHECK(origin(cross, 1) == glm::vec2{0, 2});
  CHECK(origin(cross, 2) == glm::vec2{2, 0});
  CHECK(origin(cross, 3) == glm::vec2{2, 4});
  CHECK(origin(cross, 4) == glm::vec2{2, 2});
  CHECK(origin(cross, 5) == glm::vec2{6, 2});
  CHECK(why_not_cut(12, 2, TextureShape::cube).empty());
  CHECK(why_not_cut(10, 2, TextureShape::cube).find("six squares") != std::string::npos);
  CHECK(why_not_cut(512, 512, TextureShape::volume).find("square slices") != std::string::npos);
  CHECK(why_not_cut(9, 2, TextureShape::array).find("9 x 2") != std::string::npos);
}
