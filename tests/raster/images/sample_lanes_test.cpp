// The vector sampler against the scalar one, to the bit.

#ifndef SOFTFOCUS_ISA

#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "raster/images/decoded_texture.h"
#include "raster/images/integer_bilinear.h"
#include "raster/images/integer_filter.h"
#include "tests/support/raster_helpers.h"

namespace softfocus {
namespace {

struct SamplePoint {
  float u, v, lod;
};
struct SampledColour {
  float r, g, b;
};
struct Footprint {
  glm::vec2 uv_per_x, uv_per_y;
};

}  // namespace
}  // namespace softfocus

#define SOFTFOCUS_KERNELS "tests/raster/images/sample_lanes_test.cpp"
#include "raster/lanes/for_each_isa.inl"

using namespace softfocus;
using test::profile_named;
using test::Random;
using test::random_texture;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::array kWraps{Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};
constexpr std::array kFilters{Filter::nearest, Filter::bilinear, Filter::trilinear};
constexpr std::array kFormats{Format::srgb8,   Format::rgba8, Format::r8,
                              Format::rgba16f, Format::r32f,  Format::rgba32f};

struct Size {
  int width, height;
};
constexpr std::array kSizes{Size{1, 1}, Size{1, 7},  Size{6, 1},    Size{3, 5},
                            Size{8, 4}, Size{17, 9}, Size{64, 128}, Size{128, 67}};

// A multiple of every unit's lanes.
constexpr std::size_t kPoints = 192;

// The known ones, and d3d11's texture unit filtering the other way and without its weights.
std::vector<NamedProfile> tested_profiles() {
  std::vector<NamedProfile> list(profiles().begin(), profiles().end());
  Profile profile = profile_named("d3d11");
  profile.bilinear_filter = BilinearFilter::floats;
  list.push_back({"d3d11 in floats", {}, profile});
  profile.bilinear_filter = BilinearFilter::integers;
  profile.bilinear_weights = BilinearWeights::binary32;
  list.push_back({"in integers by float weights", {}, profile});
  return list;
}

std::span<const Isa> vector_isas() { return available_isas().subspan(1); }

// Any NaN is as good as another: what is stored of them is one.
bool same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (a != a && b != b);
}

Texture mipmapped(Format format, Size size, std::uint64_t seed) {
  Texture texture = random_texture(format, size.width, size.height, seed);
  generate_mipmaps(texture, {});
  return texture;
}

std::vector<SamplePoint> random_points(Random& random, int level_count) {
  std::vector<SamplePoint> points(kPoints);
  for (SamplePoint& point : points) {
    point = {random.between(-3.0f, 3.0f), random.between(-3.0f, 3.0f),
             random.between(-1.5f, static_cast<float>(level_count) + 0.5f)};
    // Texels' centres and edges, and lods at which levels change.
    if (random.whole(0, 3) == 0) point.u = static_cast<float>(random.whole(-64, 64)) / 16.0f;
    if (random.whole(0, 3) == 0) point.v = static_cast<float>(random.whole(-64, 64)) / 32.0f;
    if (random.whole(0, 2) == 0) point.lod = std::floor(2.0f * point.lod) / 2.0f;
  }
  return points;
}

// As a draw makes them: 4x4 pixels, about a texel of their level apart.
std::vector<SamplePoint> drawn_points(Random& random, const Image& base) {
  std::vector<SamplePoint> points;
  while (points.size() < kPoints) {
    const float lod = random.between(-0.5f, 2.5f);
    const float du = std::exp2(lod) / static_cast<float>(base.width);
    const float dv = std::exp2(lod) / static_cast<float>(base.height);
    const glm::vec2 start{random.between(-2.0f, 2.0f), random.between(-2.0f, 2.0f)};
    for (int i = 0; i < 16; ++i) {
      const int column = i % 4, row = i / 4;
      points.push_back({start.x + du * static_cast<float>(column),
                        start.y + dv * static_cast<float>(row), lod + random.between(0.0f, 0.1f)});
    }
  }
  return points;
}

float extreme_value(Random& random) {
  constexpr std::array kOdd{0.0f,  -0.0f,  kInfinity, -kInfinity, kNan,   1.0f,    -1.0f,  0.5f,
                            1e10f, -1e10f, 3e38f,     -3e38f,     1e-45f, -1e-45f, 1e-38f, -1e-38f};
  const int kind = random.whole(0, 2);
  if (kind == 0) return kOdd[static_cast<std::size_t>(random.whole(0, kOdd.size() - 1))];
  if (kind == 1) return std::ldexp(random.between(-1.0f, 1.0f), random.whole(-149, 128));
  return std::nextafter(static_cast<float>(random.whole(-3, 3)) / 2.0f,
                        random.between(-1.0f, 1.0f) > 0.0f ? kInfinity : -kInfinity);
}

std::vector<SamplePoint> extreme_points(Random& random, int level_count) {
  std::vector<SamplePoint> points = random_points(random, level_count);
  for (SamplePoint& point : points) {
    if (random.whole(0, 1) == 0) point.u = extreme_value(random);
    if (random.whole(0, 1) == 0) point.v = extreme_value(random);
    if (random.whole(0, 1) == 0) point.lod = extreme_value(random);
  }
  return points;
}

// How many points get another colour in lanes than by themselves.
int count_wrong(Isa isa, const Texture& texture, const DecodedTexture& decoded,
                const Sampler& sampler, const Profile& profile,
                const std::vector<SamplePoint>& points) {
  std::vector<SampledColour> colours(points.size());
  SOFTFOCUS_KERNEL(isa, sample_all)(decoded, sampler, profile, points, colours);
  int wrong = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::vec4 expected =
        sample(texture, sampler, {points[i].u, points[i].v}, points[i].lod, profile);
    wrong += !same(colours[i].r, expected.x) || !same(colours[i].g, expected.y) ||
             !same(colours[i].b, expected.z);
  }
  return wrong;
}

// Counts wrong samples over all samplers and kinds of points.
int count_wrong(Isa isa, const Texture& texture, const Profile& profile, Random& random) {
  const DecodedTexture decoded = decode_texture(texture, profile);
  int wrong = 0;
  for (const Filter filter : kFilters) {
    for (const Wrap wrap_u : kWraps) {
      for (const Wrap wrap_v : kWraps) {
        const Sampler sampler{filter, wrap_u, wrap_v};
        const auto count = [&](const std::vector<SamplePoint>& points) {
          return count_wrong(isa, texture, decoded, sampler, profile, points);
        };
        const int levels = decoded.level_count;
        wrong += count(random_points(random, levels));
        wrong += count(extreme_points(random, levels));
        wrong += count(drawn_points(random, texture.levels.front()));
      }
    }
  }
  return wrong;
}

}  // namespace

TEST_CASE("pixels sampled in lanes have the bits of pixels sampled one by one") {
  for (const Isa isa : vector_isas()) {
    for (const NamedProfile& known : tested_profiles()) {
      const Profile& profile = known.profile;
      Random random{41};
      for (const Format format : kFormats) {
        int wrong = 0;
        for (const Size size : kSizes) {
          wrong += count_wrong(isa, mipmapped(format, size, 42), profile, random);
        }
        CHECK_MESSAGE(wrong == 0, isa_name(isa), ", ", known.name, ", format ",
                      static_cast<int>(format));
      }
    }
  }
}

TEST_CASE("so have infinities, NaN, both zeros and subnormals among the texels") {
  for (const Isa isa : vector_isas()) {
    for (const NamedProfile& known : tested_profiles()) {
      const Profile& profile = known.profile;
      Random random{43};
      for (const Format format : {Format::rgba16f, Format::rgba32f}) {
        Image image = make_image(format, 8, 8);
        for (int i = 0; i < 64; ++i) {
          glm::vec4 texel{};
          for (int channel = 0; channel < 4; ++channel) texel[channel] = extreme_value(random);
          store_texel(image, i % 8, i / 8, texel, {});
        }
        Texture texture = make_texture(std::move(image));
        generate_mipmaps(texture, {});
        CHECK_MESSAGE(count_wrong(isa, texture, profile, random) == 0, isa_name(isa), ", ",
                      known.name, ", format ", static_cast<int>(format));
      }
    }
  }
}

TEST_CASE("levels that halve no size are sampled in lanes all the same") {
  Texture texture;
  for (const Size size : {Size{8, 8}, Size{5, 7}, Size{16, 3}}) {
    texture.levels.push_back(
        random_texture(Format::srgb8, size.width, size.height, 44).levels.front());
  }
  for (const Isa isa : vector_isas()) {
    Random random{45};
    for (const NamedProfile& known : tested_profiles()) {
      const Profile& profile = known.profile;
      CHECK_MESSAGE(count_wrong(isa, texture, profile, random) == 0, isa_name(isa), ", ",
                    known.name);
    }
  }
}

TEST_CASE("so are profiles that have no arithmetic in lanes") {
  const Texture texture = mipmapped(Format::srgb8, {16, 16}, 46);
  const Texture bytes = mipmapped(Format::rgba8, {16, 16}, 46);
  Profile fused_floats = profile_named("ieee");
  fused_floats.lerp = Contraction::fused;
  Profile fused_integers = fused_floats;
  fused_integers.bilinear_filter = BilinearFilter::integers;
  Profile keeping = profile_named("llvmpipe");
  keeping.denormals = Denormals::keep;
  for (const Isa isa : vector_isas()) {
    Random random{47};
    CHECK(count_wrong(isa, texture, fused_floats, random) == 0);
    CHECK(count_wrong(isa, bytes, fused_integers, random) == 0);
    CHECK(count_wrong(isa, texture, keeping, random) == 0);
  }
}

TEST_CASE("the least weights of a next level underflow in lanes as in one pixel") {
  // Grey over black: what is mixed in is a part of the weight.
  Texture texture = make_texture(make_image(Format::srgb8, 2, 2));
  texture.levels.push_back(make_image(Format::srgb8, 1, 1));
  clear_image(texture.levels[1], glm::vec4{0.1f}, {});
  const Sampler sampler{Filter::trilinear, Wrap::repeat, Wrap::repeat};
  std::vector<SamplePoint> points;
  for (int exponent = -149; exponent < 0; ++exponent) {
    points.insert(points.end(), 16, {0.3f, 0.3f, std::ldexp(1.0f, exponent)});
  }
  for (const Isa isa : vector_isas()) {
    for (const NamedProfile& known : tested_profiles()) {
      const Profile& profile = known.profile;
      const DecodedTexture decoded = decode_texture(texture, profile);
      CHECK(count_wrong(isa, texture, decoded, sampler, profile, points) == 0);
    }
  }
}

TEST_CASE("in lanes bytes in integers are the sums of the header that stands alone, over 255") {
  const Texture texture = random_texture(Format::rgba8, 32, 16, 51);
  const auto bytes = [&](int y) { return row<std::uint8_t>(texture.levels[0], y); };
  const Profile profile = tested_profiles().back().profile;
  const DecodedTexture decoded = decode_texture(texture, profile);
  const Sampler sampler{Filter::bilinear, Wrap::clamp_to_edge, Wrap::repeat};
  Random random{52};
  std::vector<SamplePoint> points;
  std::vector<std::array<float, 3>> expected;
  for (std::size_t i = 0; i < kPoints * 8; ++i) {
    const int u_256 = random.whole(-256 * 8, 256 * 40);
    const int v_256 = random.whole(-256 * 40, 256 * 40);
    points.push_back({static_cast<float>(u_256) / (256.0f * 32.0f),
                      static_cast<float>(v_256) / (256.0f * 16.0f), 0.0f});
    const IntegerTaps u = clamped_taps(from_centre(u_256), 32);
    const IntegerTaps v = repeated_taps(from_centre(v_256), 16);
    std::array<float, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto at = [&](int x, int y) { return bytes(y)[4 * static_cast<std::size_t>(x) + c]; };
      const int sum =
          bilinear_sum_unorm8(at(u.first, v.first), at(u.second, v.first), at(u.first, v.second),
                              at(u.second, v.second), u.weight, v.weight);
      colour[c] = static_cast<float>(sum) / (65536.0f * 255.0f);
    }
    expected.push_back(colour);
  }
  for (const Isa isa : vector_isas()) {
    std::vector<SampledColour> colours(points.size());
    SOFTFOCUS_KERNEL(isa, sample_all)(decoded, sampler, profile, points, colours);
    int wrong = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto [r, g, b] = expected[i];
      wrong += !same(colours[i].r, r) || !same(colours[i].g, g) || !same(colours[i].b, b);
    }
    CHECK_MESSAGE(wrong == 0, isa_name(isa));
  }
}

namespace {

// A channel of a decoded texel as a fetch gives it.
float linear(const DecodedTexture& decoded, const Profile& profile, float value) {
  if (!decoded.are_whole) return value;
  if (profile.texture_unit == TextureUnit::swiftshader) return value * (1.0f / 65280.0f);
  return profile.texture_unit == TextureUnit::standard ? value / 255.0f : value * (1.0f / 255.0f);
}

}  // namespace

TEST_CASE("a decoded texture holds each texel as the profile's texture unit fetches it") {
  for (const NamedProfile& known : tested_profiles()) {
    const Profile& profile = known.profile;
    if (profile.texture_unit == TextureUnit::softpipe) continue;
    for (const Format format : kFormats) {
      const Texture texture = mipmapped(format, {5, 3}, 48);
      const DecodedTexture decoded = decode_texture(texture, profile);
      int wrong = 0;
      for (std::size_t level = 0; level < texture.levels.size(); ++level) {
        const Image& image = texture.levels[level];
        const float* texel = &decoded.texels[static_cast<std::size_t>(decoded.starts[level])];
        for (int i = 0; i < image.width * image.height; ++i, texel += 4) {
          const glm::vec4 expected = fetch_texel(image, i % image.width, i / image.width, profile);
          for (int c = 0; c < 4; ++c)
            wrong += !same(linear(decoded, profile, texel[c]), expected[c]);
        }
      }
      CHECK_MESSAGE(wrong == 0, known.name, ", format ", static_cast<int>(format));
    }
  }
}

TEST_CASE("levels of detail found in lanes have the bits of those found one by one") {
  Random random{49};
  for (const Size size : kSizes) {
    const Texture texture = mipmapped(Format::r8, size, 50);
    const DecodedTexture decoded = decode_texture(texture, {});
    std::vector<Footprint> footprints(kPoints * 4);
    for (Footprint& f : footprints) {
      for (float* value : {&f.uv_per_x.x, &f.uv_per_x.y, &f.uv_per_y.x, &f.uv_per_y.y}) {
        *value = random.whole(0, 1) == 0 ? random.between(-0.2f, 0.2f) : extreme_value(random);
      }
    }
    for (const Isa isa : vector_isas()) {
      std::vector<float> lods(footprints.size());
      SOFTFOCUS_KERNEL(isa, find_levels)(decoded, footprints, lods);
      int wrong = 0;
      for (std::size_t i = 0; i < lods.size(); ++i) {
        const float expected =
            level_of_detail(texture, footprints[i].uv_per_x, footprints[i].uv_per_y);
        wrong += !same(lods[i], expected);
      }
      CHECK_MESSAGE(wrong == 0, isa_name(isa));
    }
  }
}

TEST_CASE("a quad's level of detail is that of its upper row and left column") {
  Random random{51};
  for (const Size size : kSizes) {
    const Texture texture = mipmapped(Format::r8, size, 52);
    std::vector<glm::vec2> places(kPoints);
    for (glm::vec2& place : places) {
      for (float* value : {&place.x, &place.y}) {
        *value = random.whole(0, 5) > 0 ? random.between(-0.2f, 0.2f) : extreme_value(random);
      }
    }
    for (const NamedProfile& known : tested_profiles()) {
      const DecodedTexture decoded = decode_texture(texture, known.profile);
      for (const Isa isa : vector_isas()) {
        std::vector<float> lods(places.size());
        SOFTFOCUS_KERNEL(isa, find_levels_of_quads)(decoded, known.profile, places, lods);
        int wrong = 0;
        for (std::size_t i = 0; i < lods.size(); ++i) {
          const glm::vec2* quad = &places[i / 4 * 4];
          const float expected =
              level_of_detail(texture, quad[1] - quad[0], quad[2] - quad[0], known.profile);
          wrong += !same(lods[i], expected);
        }
        CHECK_MESSAGE(wrong == 0, known.name, " ", isa_name(isa));
      }
    }
  }
}

#else  // once a vector unit

#include "raster/images/sample_lanes.inl"

inline void sample_all(const DecodedTexture& texture, const Sampler& sampler,
                       const Profile& profile, std::span<const SamplePoint> points,
                       std::span<SampledColour> colours) {
  constexpr auto kStep = static_cast<std::size_t>(kLanes);
  std::vector<float> u, v, lod;
  for (const SamplePoint& point : points) {
    u.push_back(point.u);
    v.push_back(point.v);
    lod.push_back(point.lod);
  }
  std::array<RgbaLanes, kMostSampled> texels;
  // Batches of 1, 2, ... vectors by turns.
  std::size_t most = 0;
  for (std::size_t done = 0; done < points.size();) {
    most = most % kMostSampled + 1;
    const std::size_t count = std::min(most, (points.size() - done) / kStep);
    sample_lanes(texture, sampler, profile, {&u[done], &v[done], &lod[done]},
                 static_cast<int>(count), texels.data());
    for (std::size_t i = 0; i < count * kStep; ++i) {
      const RgbaLanes& rgb = texels[i / kStep];
      const int lane = static_cast<int>(i % kStep);
      colours[done + i] = {rgb.r[lane], rgb.g[lane], rgb.b[lane]};
    }
    done += count * kStep;
  }
}

inline void find_levels(const DecodedTexture& texture, std::span<const Footprint> footprints,
                        std::span<float> lods) {
  for (std::size_t start = 0; start < footprints.size(); start += kLanes) {
    Floats du_dx, dv_dx, du_dy, dv_dy;
    for (int i = 0; i < kLanes; ++i) {
      const Footprint& footprint = footprints[start + static_cast<std::size_t>(i)];
      du_dx[i] = footprint.uv_per_x.x;
      dv_dx[i] = footprint.uv_per_x.y;
      du_dy[i] = footprint.uv_per_y.x;
      dv_dy[i] = footprint.uv_per_y.y;
    }
    store(&lods[start], level_of_detail_lanes(texture, du_dx, dv_dx, du_dy, dv_dy));
  }
}

inline void find_levels_of_quads(const DecodedTexture& texture, const Profile& profile,
                                 std::span<const glm::vec2> places, std::span<float> lods) {
  for (std::size_t start = 0; start < places.size(); start += kLanes) {
    Floats u, v;
    for (int i = 0; i < kLanes; ++i) {
      u[i] = places[start + static_cast<std::size_t>(i)].x;
      v[i] = places[start + static_cast<std::size_t>(i)].y;
    }
    store(&lods[start], level_of_detail_of_quads(texture, profile, u, v));
  }
}

#endif
