// Arrays, volumes and cubes sampled in lanes against sample_sliced(), to the bit.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "raster/images/decoded_texture.h"
#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

struct SlicedPoint {
  glm::vec3 at;
  float lod;
};

constexpr std::array kSlicedFormats{Format::r8,      Format::rgba8, Format::srgb8,  Format::rg16f,
                                    Format::rgba16f, Format::r32f,  Format::rgba32f};
constexpr std::array kSlicedWraps{Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};
constexpr std::size_t kSlicedPoints = 8 * 16;

int unit_lanes(Isa isa) {
#ifdef SOFTFOCUS_ONLY_LANES
  (void)isa;
  return SOFTFOCUS_ONLY_LANES;
#else
  return isa == Isa::avx512 ? 16 : isa == Isa::avx2 ? 8 : 4;
#endif
}

float odd_value(Random& random) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr std::array kOdd{0.0f,   -0.0f,   kInfinity, -kInfinity, kNan,   1.0f,
                            -1.0f,  0.5f,    -0.5f,     1e10f,      -1e10f, 3e38f,
                            1e-45f, -1e-45f, -1.5e-39f, 1e-38f};
  if (random.whole(0, 1) == 0)
    return std::ldexp(random.between(-1.0f, 1.0f), random.whole(-149, 128));
  return kOdd[static_cast<std::size_t>(random.whole(0, static_cast<int>(kOdd.size()) - 1))];
}

Texture sliced_noise(TextureShape shape, Format format, glm::ivec3 size, Random& random) {
  std::vector<Image> slices;
  for (int slice = 0; slice < size.z; ++slice) {
    Image image = make_image(format, size.x, size.y);
    for (int i = 0; i < size.x * size.y; ++i) {
      glm::vec4 texel{};
      for (int channel = 0; channel < 4; ++channel) {
        texel[channel] = random.whole(0, 30) == 0 ? odd_value(random) : random.between(-0.2f, 1.2f);
      }
      store_texel(image, i % size.x, i / size.x, texel, {});
    }
    slices.push_back(std::move(image));
  }
  Texture texture = make_sliced_texture(shape, std::move(slices));
  generate_mipmaps(texture, {});
  return texture;
}

/// Directions along edges and towards corners of cubes, texels' centres, levels' edges; and what no
/// one asks for.
std::vector<SlicedPoint> sliced_points(Random& random, std::size_t level_count) {
  std::vector<SlicedPoint> points(kSlicedPoints);
  for (SlicedPoint& point : points) {
    for (int i = 0; i < 3; ++i) {
      const int kind = random.whole(0, 9);
      point.at[i] = kind == 0   ? odd_value(random)
                    : kind <= 3 ? static_cast<float>(random.whole(-16, 16)) / 8.0f
                                : random.between(-2.5f, 2.5f);
    }
    if (random.whole(0, 3) == 0) {
      const int i = random.whole(0, 2);
      point.at[i] = std::nextafter(point.at[(i + 1) % 3], random.between(-9.0f, 9.0f));
    }
    const int kind = random.whole(0, 9);
    point.lod = random.between(-1.0f, static_cast<float>(level_count));
    if (kind < 3) point.lod = std::floor(2.0f * point.lod) / 2.0f;
    if (kind == 9) point.lod = odd_value(random);
  }
  return points;
}

bool is_same(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b) || (a != a && b != b);
}

/// How many points have another colour in lanes than by themselves.
int count_wrong_slices(Isa isa, const DecodedTexture& decoded, const Sampler& sampler,
                       const Profile& profile, const std::vector<SlicedPoint>& points) {
  const auto lanes = static_cast<std::size_t>(unit_lanes(isa));
  std::array<std::array<float, kSlicedPoints>, 4> of{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) of[axis][i] = points[i].at[static_cast<int>(axis)];
    of[3][i] = points[i].lod;
  }
  alignas(64) std::array<float, 4 * kSlicedPoints> colours{};
  int wrong = 0;
  const std::size_t batch = std::min(kSlicedPoints, 8 * lanes);
  for (std::size_t first = 0; first < kSlicedPoints; first += batch) {
    sample_vectors(isa, decoded, sampler, profile,
                   {&of[0][first], &of[1][first], &of[3][first], &of[2][first]},
                   static_cast<int>(batch / lanes), colours.data());
    for (std::size_t i = 0; i < batch; ++i) {
      const SlicedPoint& point = points[first + i];
      const glm::vec4 expected =
          sample_sliced(*decoded.source, sampler, point.at, point.lod, profile);
      bool is_right = true;
      for (std::size_t channel = 0; channel < 4; ++channel) {
        const float found = colours[(i / lanes * 4 + channel) * lanes + i % lanes];
        is_right = is_right && is_same(found, expected[static_cast<int>(channel)]);
      }
      wrong += is_right ? 0 : 1;
    }
  }
  return wrong;
}

int count_wrong_slices(Isa isa, const Texture& texture, const Profile& profile, Random& random) {
  const DecodedTexture decoded = decode_texture(texture, profile, isa);
  int wrong = 0;
  for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::trilinear}) {
    for (const Wrap wrap_u : kSlicedWraps) {
      for (const Wrap wrap_v : kSlicedWraps) {
        for (const Wrap wrap_w : kSlicedWraps) {
          if (texture.shape != TextureShape::volume && wrap_w != Wrap::repeat) continue;
          if (texture.shape == TextureShape::cube && wrap_u != wrap_v) continue;
          wrong += count_wrong_slices(isa, decoded, {filter, wrap_u, wrap_v, wrap_w}, profile,
                                      sliced_points(random, texture.levels.size()));
        }
      }
    }
  }
  return wrong;
}

std::vector<NamedProfile> sliced_profiles() {
  std::vector<NamedProfile> list(profiles().begin(), profiles().end());
  for (const char* name : {"ieee", "d3d11", "llvmpipe", "swiftshader"}) {
    Profile odd = profile_named(name);
    odd.lerp = odd.lerp == Contraction::fused ? Contraction::unfused : Contraction::fused;
    list.push_back({"fused otherwise", {}, odd});
    odd = profile_named(name);
    odd.denormals = odd.denormals == Denormals::keep ? Denormals::flush : Denormals::keep;
    list.push_back({"with other subnormals", {}, odd});
    odd = profile_named(name);
    odd.bilinear_weights = odd.bilinear_weights == BilinearWeights::fixed_8
                               ? BilinearWeights::binary32
                               : BilinearWeights::fixed_8;
    list.push_back({"with other weights", {}, odd});
  }
  return list;
}

void check_sliced_lanes(TextureShape shape, const std::vector<glm::ivec3>& sizes) {
  for (const Isa isa : available_isas().subspan(1)) {
    for (const NamedProfile& known : sliced_profiles()) {
      Random random{61};
      for (const Format format : kSlicedFormats) {
        int wrong = 0;
        for (const glm::ivec3 size : sizes) {
          wrong += count_wrong_slices(isa, sliced_noise(shape, format, size, random), known.profile,
                                      random);
        }
        CHECK_MESSAGE(wrong == 0, isa_name(isa), ", ", known.name, ", format ",
                      static_cast<int>(format));
      }
    }
  }
}

}  // namespace

TEST_CASE("arrays sampled in lanes have the bits of those sampled one by one") {
  check_sliced_lanes(TextureShape::array, {{8, 4, 5}, {5, 7, 3}, {1, 1, 1}});
}

TEST_CASE("so have volumes") { check_sliced_lanes(TextureShape::volume, {{5, 7, 6}, {1, 3, 1}}); }

TEST_CASE("so have deeper volumes" * doctest::test_suite("long")) {
  check_sliced_lanes(TextureShape::volume, {{8, 4, 16}});
}

TEST_CASE("so have cubes, at their edges and corners, too") {
  check_sliced_lanes(TextureShape::cube, {{8, 8, 6}, {5, 5, 6}, {1, 1, 6}});
}

TEST_CASE("the least weights of a volume's or cube's next level underflow in lanes as alone") {
  for (const TextureShape shape : {TextureShape::volume, TextureShape::cube}) {
    Random random{62};
    Texture texture = sliced_noise(shape, Format::srgb8, {2, 2, 6}, random);
    clear_image(texture.levels[1], glm::vec4{0.0f}, {});
    std::vector<SlicedPoint> points(kSlicedPoints);
    for (std::size_t i = 0; i < points.size(); ++i) {
      // Nearly at a texel of black, all that is left of the next is a part of the weights.
      points[i] = {{std::ldexp(1.0f, -static_cast<int>(i % 25)), 0.25f, 1e-7f},
                   i < 64 ? std::ldexp(1.0f, -static_cast<int>(i)) : 1.0f - std::ldexp(1.0f, -24)};
    }
    for (const Isa isa : available_isas().subspan(1)) {
      for (const NamedProfile& known : sliced_profiles()) {
        const DecodedTexture decoded = decode_texture(texture, known.profile, isa);
        CHECK_MESSAGE(count_wrong_slices(isa, decoded, {.filter = Filter::trilinear}, known.profile,
                                         points) == 0,
                      isa_name(isa), ", ", known.name);
      }
    }
  }
}
