#include "scenes/make/procedural_texture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "raster/numbers/random_bits.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
namespace {

constexpr std::size_t kAlpha = 3;

// Whether a test holds for every byte of a channel.
template <class Test>
bool all_of_channel(const Image& picture, std::size_t channel, Test test) {
  for (int y = 0; y < picture.height; ++y) {
    const auto texels = row<std::uint8_t>(picture, y);
    for (std::size_t i = channel; i < texels.size(); i += 4) {
      if (!test(texels[i])) return false;
    }
  }
  return true;
}

}  // namespace

Texture make_opacity_texture(const Image& picture) {
  assert(picture.format == Format::rgba8 || picture.format == Format::srgb8);
  const bool is_opaque =
      all_of_channel(picture, kAlpha, [](std::uint8_t alpha) { return alpha == 255; });
  Image opacity = make_image(Format::rgba8, picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y) {
    const auto from = row<std::uint8_t>(picture, y);
    const auto to = row<std::uint8_t>(opacity, y);
    for (std::size_t i = 0; i < from.size(); i += 4) {
      const int mean = (from[i] + from[i + 1] + from[i + 2] + 1) / 3;
      std::fill_n(&to[i], 4, is_opaque ? static_cast<std::uint8_t>(mean) : from[i + kAlpha]);
    }
  }
  Texture texture = make_texture(std::move(opacity));
  generate_mipmaps(texture, Profile{});
  return texture;
}

bool is_cut_out(const Texture& opacity) {
  return all_of_channel(opacity.levels[0], kAlpha,
                        [](std::uint8_t value) { return value == 0 || value == 255; });
}

namespace {

glm::dvec3 mix(glm::dvec3 a, glm::dvec3 b, double t) { return a + (b - a) * t; }

glm::dvec3 colour(const TextureRecipe& recipe, std::size_t index) {
  return glm::dvec3{recipe.colours[index]};
}

// 0 below `low`, 1 above `high`, a cubic between.
double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// A position in cells, not below 0: the cell and where in it.
struct Cell {
  int index;
  double inside;  // 0 to 1
};

Cell cell_at(double position) {
  const int index = static_cast<int>(position);
  return {index, position - index};
}

double cell_random(std::uint64_t seed, int x, int y) {
  const auto cell = static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32 |
                    static_cast<std::uint32_t>(y);
  return unit_interval(mix_bits(seed * 0x9E3779B97F4A7C15u + cell));
}

// Value noise: random values on a lattice that repeats after `period_x` x `period_y`
// cells, blended by smooth steps. 0 to 1.
double value_noise(std::uint64_t seed, double x, double y, int period_x, int period_y) {
  const Cell column = cell_at(x);
  const Cell row = cell_at(y);
  // A remainder would take longer than all else.
  const int right = column.index + 1 < period_x ? column.index + 1 : 0;
  const int below = row.index + 1 < period_y ? row.index + 1 : 0;
  const auto lattice = [&](int i, int j) {
    return cell_random(seed, i == 0 ? column.index : right, j == 0 ? row.index : below);
  };
  const double s = smooth_step(0.0, 1.0, column.inside);
  const double t = smooth_step(0.0, 1.0, row.inside);
  const double upper = lattice(0, 0) + (lattice(1, 0) - lattice(0, 0)) * s;
  const double lower = lattice(0, 1) + (lattice(1, 1) - lattice(0, 1)) * s;
  return upper + (lower - upper) * t;
}

// Four octaves, each twice as fine and half as strong as the one before. 0 to 1.
double fractal_noise(std::uint64_t seed, double u, double v, int cells_x, int cells_y) {
  double sum = 0.0;
  double strength = 8.0 / 15.0;
  for (int octave = 0; octave < 4; ++octave) {
    sum += strength * value_noise(seed + static_cast<std::uint64_t>(octave), u * cells_x,
                                  v * cells_y, cells_x, cells_y);
    strength *= 0.5;
    cells_x *= 2;
    cells_y *= 2;
  }
  return sum;
}

// Fine grain that keeps a flat colour from looking painted by a machine.
double grain(const TextureRecipe& recipe, double u, double v, double strength) {
  return 1.0 - strength * fractal_noise(recipe.seed + 100, u, v, 8, 8);
}

glm::dvec3 checker(const TextureRecipe& recipe, double u, double v) {
  const int fields = cell_at(u * recipe.cells).index + cell_at(v * recipe.cells).index;
  return colour(recipe, (fields & 1) != 0 ? 1 : 0) * grain(recipe, u, v, 0.15);
}

glm::dvec3 stripes(const TextureRecipe& recipe, double u, double v) {
  const int stripe = cell_at(v * recipe.cells).index;
  return colour(recipe, (stripe & 1) != 0 ? 1 : 0) * grain(recipe, u, v, 0.15);
}

glm::dvec3 dots(const TextureRecipe& recipe, double u, double v) {
  const double x = cell_at(u * recipe.cells).inside - 0.5;
  const double y = cell_at(v * recipe.cells).inside - 0.5;
  const double from_centre = std::sqrt(x * x + y * y);
  return mix(colour(recipe, 1), colour(recipe, 0), smooth_step(0.29, 0.32, from_centre)) *
         grain(recipe, u, v, 0.15);
}

// How far inside a field with joints around it: 0 in the joint, 1 on the field, from
// the distance to the nearest edge in units of the field's height.
double field(double x, double y, double width, double joint) {
  const double to_edge = std::min(std::min(x, width - x), std::min(y, 1.0 - y));
  return smooth_step(joint, 2.0 * joint, to_edge);
}

glm::dvec3 bricks(const TextureRecipe& recipe, double u, double v) {
  const int bricks_a_course = std::max(1, recipe.cells / 2);
  const Cell course = cell_at(v * recipe.cells);
  const double shift = (course.index & 1) != 0 ? 0.5 : 0.0;
  const Cell brick = cell_at(u * bricks_a_course + shift);
  const double tone = cell_random(recipe.seed, brick.index % bricks_a_course, course.index);
  const double inside = field(brick.inside * 2.0, course.inside, 2.0, 0.045);
  return mix(colour(recipe, 0), mix(colour(recipe, 1), colour(recipe, 2), tone), inside) *
         grain(recipe, u, v, 0.45);
}

glm::dvec3 tiles(const TextureRecipe& recipe, double u, double v) {
  const Cell column = cell_at(u * recipe.cells);
  const Cell row = cell_at(v * recipe.cells);
  const double tone = cell_random(recipe.seed, column.index, row.index);
  const glm::dvec3 glaze =
      colour(recipe, ((column.index + row.index) & 1) != 0 ? 2 : 1) * (0.85 + 0.15 * tone);
  return mix(colour(recipe, 0), glaze, field(column.inside, row.inside, 1.0, 0.02)) *
         grain(recipe, u, v, 0.2);
}

glm::dvec3 planks(const TextureRecipe& recipe, double u, double v) {
  const Cell plank = cell_at(v * recipe.cells);
  const auto own = recipe.seed + 1000u * static_cast<std::uint64_t>(plank.index);
  // Long along the plank, thin across it.
  const double fibres = fractal_noise(own, u, v, 2, 4 * recipe.cells);
  const double rings = fractal_noise(own + 50, u, v, 1, recipe.cells);
  const double band = cell_at(rings * 9.0).inside;
  const double tone = 0.45 * fibres + 0.3 * band + 0.25 * cell_random(own, plank.index, 7);
  const double gap = smooth_step(0.0, 0.06, std::min(plank.inside, 1.0 - plank.inside));
  return mix(colour(recipe, 0), colour(recipe, 1), tone) * (0.35 + 0.65 * gap);
}

glm::dvec3 marble(const TextureRecipe& recipe, double u, double v) {
  const double warp = fractal_noise(recipe.seed, u, v, recipe.cells, recipe.cells);
  // A whole number of waves along u, so that the veins meet at the seam.
  const double wave = cell_at(u * recipe.cells + 3.0 * warp).inside;
  const double from_crest = std::fabs(2.0 * wave - 1.0);
  const double vein = 1.0 - smooth_step(0.0, 0.55, from_crest);
  const double cloud = fractal_noise(recipe.seed + 20, u, v, recipe.cells, recipe.cells);
  return mix(colour(recipe, 0), colour(recipe, 1), std::min(1.0, 0.8 * vein + 0.35 * cloud));
}

glm::dvec3 clouds(const TextureRecipe& recipe, double u, double v) {
  const double cover = fractal_noise(recipe.seed, u, v, recipe.cells, recipe.cells);
  return mix(colour(recipe, 0), colour(recipe, 1), smooth_step(0.25, 0.75, cover));
}

constexpr TexturePattern kPatterns[] = {
    {"checker", "two fields", 2, checker},
    {"stripes", "two stripes", 2, stripes},
    {"dots", "ground, dot", 2, dots},
    {"bricks", "mortar, brick, other brick", 3, bricks},
    {"tiles", "joint, tile, other tile", 3, tiles},
    {"planks", "dark, light", 2, planks},
    {"marble", "stone, vein", 2, marble},
    {"clouds", "sky, cloud", 2, clouds},
};

}  // namespace

std::span<const TexturePattern> texture_patterns() { return kPatterns; }

const TexturePattern* find_texture_pattern(std::string_view name) {
  const auto found = std::find_if(std::begin(kPatterns), std::end(kPatterns),
                                  [&](const TexturePattern& p) { return p.name == name; });
  return found != std::end(kPatterns) ? found : nullptr;
}

Texture make_procedural_texture(const TexturePattern& pattern, const TextureRecipe& recipe) {
  assert(recipe.size >= 1 && recipe.size <= kMaxTextureSize &&
         (recipe.size & (recipe.size - 1)) == 0);
  assert(recipe.cells >= 1 && recipe.colours.size() == pattern.colour_count);
  Image image = make_image(Format::rgba8, recipe.size, recipe.size);
  for (int y = 0; y < recipe.size; ++y) {
    const auto texels = row<std::uint8_t>(image, y);
    for (int x = 0; x < recipe.size; ++x) {
      glm::dvec3 sum{0.0};
      for (const double below : {0.25, 0.75}) {
        for (const double right : {0.25, 0.75}) {
          sum += pattern.colour_at(recipe, (x + right) / recipe.size, (y + below) / recipe.size);
        }
      }
      for (int channel = 0; channel < 3; ++channel) {
        texels[static_cast<std::size_t>(4 * x + channel)] =
            linear_to_unorm8(static_cast<float>(sum[channel] * 0.25));
      }
      texels[static_cast<std::size_t>(4 * x + 3)] = 255;
    }
  }
  Texture texture = make_texture(std::move(image));
  generate_mipmaps(texture, Profile{});
  return texture;
}

}  // namespace softfocus
