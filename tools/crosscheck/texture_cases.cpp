// Stages `bilinear-rgba16f`, `bilinear-rgba8` and `mipmap`: textures of random texels,
// sampled at random places.

#include <array>
#include <cmath>
#include <limits>

#include "raster/images/sampler.h"
#include "raster/images/texel.h"
#include "raster/passes/draw_mipmaps.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/objects.h"

namespace softfocus {
namespace {

constexpr int kSamples = 256;  // a side of the picture of samples

// The kind of a texture's texels.
enum class Texels { any_colour, special };

// Colours with detail; or half subnormals, the largest halves, zeros of both signs,
// infinities and NaN, where a weight of exactly 0 matters.
Image random_image(Format format, int width, int height, Texels texels, RandomNumbers& random) {
  static constexpr std::array<std::uint16_t, 11> kSpecial{
      0x0000, 0x8000, 0x0001, 0x83FF, 0x0400, 0x7BFF, 0xFBFF, 0x7C00, 0x3C00, 0x3555, 0x7E00};
  Image image = make_image(format, width, height);
  for (int y = 0; y < height; ++y) {
    if (format == Format::rgba16f) {
      for (std::uint16_t& value : row<std::uint16_t>(image, y)) {
        value = texels == Texels::special
                    ? kSpecial[static_cast<std::size_t>(random.below(kSpecial.size()))]
                    : float_to_half(random.between(-4.0f, 4.0f), HalfRounding::nearest_even);
      }
    } else {
      for (std::uint8_t& value : row<std::uint8_t>(image, y)) {
        value = static_cast<std::uint8_t>(random.word() >> 24);
      }
    }
  }
  return image;
}

// (u, v, level, 0): anywhere, inside, exactly on texel centres and borders, far outside.
Image random_coordinates(int width, int height, float lod_least, float lod_most,
                         RandomNumbers& random) {
  Image image = make_image(Format::rgba32f, kSamples, kSamples);
  for (int y = 0; y < kSamples; ++y) {
    const auto values = row<float>(image, y);
    for (std::size_t x = 0; x < kSamples; ++x) {
      float* at = &values[4 * x];
      const auto along = [&](int size) {
        // Now and then a number that is no place; drivers read some texel there too.
        static constexpr std::array<float, 6> kNoPlaces{
            1e9f, -1e9f, 3e38f, HUGE_VALF, -HUGE_VALF, std::numeric_limits<float>::quiet_NaN()};
        if (random.below(64) == 0) {
          return kNoPlaces[static_cast<std::size_t>(random.below(kNoPlaces.size()))];
        }
        switch (random.below(8)) {
          case 0:
            return static_cast<float>(random.below(2 * size + 1)) * 0.5f / static_cast<float>(size);
          case 1: return random.between(-300.0f, 300.0f);
          case 2:
          case 3: return random.between(-2.5f, 2.5f);
          default: return random.between(0.0f, 1.0f);
        }
      };
      at[0] = along(width);
      at[1] = along(height);
      at[2] = random.between(lod_least, lod_most);
      if (random.below(4) == 0) at[2] = std::floor(at[2] * 2.0f) * 0.5f;
    }
  }
  return image;
}

struct TextureCase {
  Format format;
  int width;
  int height;
  Filter filter;
  Wrap wrap;
  Texels texels = Texels::any_colour;
  bool mipmapped = false;
};

void sample_both(const Bench& bench, Tally& tally, const TextureCase& what, unsigned seed) {
  RandomNumbers random{seed};
  Texture texture =
      make_texture(random_image(what.format, what.width, what.height, what.texels, random));
  if (what.mipmapped) {
    for (int width = what.width, height = what.height; width > 1 || height > 1;) {
      width = std::max(1, width / 2);
      height = std::max(1, height / 2);
      texture.levels.push_back(random_image(what.format, width, height, what.texels, random));
    }
  }
  const auto levels = static_cast<float>(texture.levels.size());
  const Image coordinates =
      random_coordinates(what.width, what.height, what.mipmapped ? -1.0f : 0.0f,
                         what.mipmapped ? levels : 0.0f, random);
  const Sampler sampler{what.filter, what.wrap, what.wrap};

  const GlTexture picture = upload(texture, sampler);
  const GlTexture places = upload(coordinates);
  const GlTarget target = make_target(std::array{Format::rgba32f}, kSamples, kSamples, false);
  const GlProgram program = link_program(bench.gl, bench.shaders, "fullscreen.vert", "sample.frag");
  set_texture(program, "picture", 0, picture);
  set_texture(program, "coordinates", 1, places);
  draw_fullscreen(target, program);

  Image emulated = make_image(Format::rgba32f, kSamples, kSamples);
  bench.pool.for_each(kSamples, [&](int y) {
    for (int x = 0; x < kSamples; ++x) {
      const glm::vec4 at = load_texel(coordinates, x, y);
      store_texel(emulated, x, y, sample(texture, sampler, {at.x, at.y}, at.z, bench.profile),
                  bench.profile);
    }
  });
  add_pictures(tally, read_colour(target, 0), emulated);
}

void generate_both(const Bench& bench, Tally& tally, Format format, int width, int height) {
  RandomNumbers random{static_cast<unsigned>(width * 1000 + height)};
  Texture texture = make_texture(random_image(format, width, height, Texels::any_colour, random));
  const GlTexture generated = upload(texture, {});
  generate_levels(generated);
  generate_mipmaps_as(texture, bench.profile);
  for (std::size_t level = 1; level < texture.levels.size(); ++level) {
    const Image& ours = texture.levels[level];
    add_pictures(tally,
                 read_level(generated, format, static_cast<int>(level), ours.width, ours.height),
                 ours, "level " + std::to_string(level));
  }
}

std::string size_name(int width, int height) {
  return std::to_string(width) + 'x' + std::to_string(height);
}

constexpr std::pair<Wrap, const char*> kWraps[] = {
    {Wrap::repeat, "repeat"}, {Wrap::mirrored_repeat, "mirror"}, {Wrap::clamp_to_edge, "clamp"}};

constexpr std::pair<int, int> kSizes[] = {{64, 32}, {37, 19},  {1, 16},
                                          {1, 1},   {100, 75}, {256, 256}};

}  // namespace

void add_texture_cases(std::vector<Case>& cases) {
  unsigned seed = 100;
  const auto add = [&](const std::string& stage, const std::string& name, bool quick,
                       const TextureCase& what) {
    cases.push_back(
        {stage, name, quick, true, [what, at = ++seed](const Bench& bench, Tally& tally) {
           sample_both(bench, tally, what, at);
         }});
  };
  for (const auto& [wrap, wrap_name] : kWraps) {
    for (const auto& [width, height] : kSizes) {
      const std::string name = size_name(width, height) + '-' + wrap_name;
      const bool quick = width == 64 || width == 37;
      add("bilinear-rgba16f", name, quick,
          {Format::rgba16f, width, height, Filter::bilinear, wrap});
    }
    add("bilinear-rgba16f", std::string("special-values-") + wrap_name, true,
        {Format::rgba16f, 37, 19, Filter::bilinear, wrap, Texels::special});
    add("bilinear-rgba16f", std::string("nearest-") + wrap_name, false,
        {Format::rgba16f, 37, 19, Filter::nearest, wrap});
    add("bilinear-rgba8", std::string("nearest-") + wrap_name, false,
        {Format::rgba8, 37, 19, Filter::nearest, wrap});
  }
  for (const auto& [wrap, wrap_name] : kWraps) {
    for (const auto& [width, height] : kSizes) {
      const std::string name = size_name(width, height) + '-' + wrap_name;
      const bool quick = width == 64 || width == 37;
      add("bilinear-rgba8", name, quick, {Format::rgba8, width, height, Filter::bilinear, wrap});
      add("bilinear-rgba8", "r8-" + name, false,
          {Format::r8, width, height, Filter::bilinear, wrap});
      add("bilinear-rgba8", "srgb-" + name, false,
          {Format::srgb8, width, height, Filter::bilinear, wrap});
    }
  }
  for (const auto& [format, format_name] :
       {std::pair{Format::rgba8, "rgba8"}, std::pair{Format::rgba16f, "rgba16f"}}) {
    for (const auto& [width, height] :
         {std::pair{64, 64}, std::pair{256, 32}, std::pair{100, 37}}) {
      cases.push_back(
          {"mipmap", std::string("generate-") + format_name + '-' + size_name(width, height), true,
           true, [f = format, w = width, h = height](const Bench& bench, Tally& tally) {
             generate_both(bench, tally, f, w, h);
           }});
    }
    for (const auto& [wrap, wrap_name] : kWraps) {
      add("mipmap", std::string("trilinear-") + format_name + '-' + wrap_name, true,
          {format, 64, 32, Filter::trilinear, wrap, Texels::any_colour, true});
      add("mipmap", std::string("trilinear-odd-") + format_name + '-' + wrap_name, false,
          {format, 37, 19, Filter::trilinear, wrap, Texels::any_colour, true});
      add("mipmap", std::string("nearest-level-") + format_name + '-' + wrap_name, false,
          {format, 64, 32, Filter::bilinear, wrap, Texels::any_colour, true});
    }
  }
}

}  // namespace softfocus
