#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "scenes/make/procedural_texture.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

#include "raster/numbers/random_bits.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
namespace {

// What the kernels share with the code that calls them. Columns hold a number for each point of a
// row: those left in their texels, then those right in them, each half filled up to whole vectors.

constexpr std::size_t kOctaves = 4;

// One octave of a noise along a row of points: upper + rise * weight.
struct OctaveLine {
  const double* upper;
  const double* rise;
  double weight;
};

// What colours a point: (ground + (figure - ground) * share) * factor.
struct PointColours {
  std::array<double, 3> ground;
  std::array<const double*, 3> figure;
  const double* share;
  const double* factor;
};

}  // namespace
}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/make/procedural_texture.cpp"
#include "raster/lanes/for_each_isa.inl"

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

namespace {

// The texels of rows, point by point: the scalar form, and the oracle.
void paint_rows(const ProceduralTexture& wanted, int first, int end, Image& image) {
  const TextureRecipe& recipe = wanted.recipe;
  for (int y = first; y < end; ++y) {
    const auto texels = row<std::uint8_t>(image, y);
    for (int x = 0; x < recipe.size; ++x) {
      glm::dvec3 sum{0.0};
      for (const double below : {0.25, 0.75}) {
        for (const double right : {0.25, 0.75}) {
          sum += wanted.pattern->colour_at(recipe, (x + right) / recipe.size,
                                           (y + below) / recipe.size);
        }
      }
      for (int channel = 0; channel < 3; ++channel) {
        texels[static_cast<std::size_t>(4 * x + channel)] =
            linear_to_unorm8(static_cast<float>(sum[channel] * 0.25));
      }
      texels[static_cast<std::size_t>(4 * x + 3)] = 255;
    }
  }
}

// --- in lanes, a row of points at a time ---
//
// Points of a row share v, and rows of points between the same rows of a lattice share all that
// depends on u. So a noise is blended along u once for each row of its lattice; a row of points
// takes one multiplication and one sum an octave. Each operation is the oracle's, on the same
// numbers.

using Column = std::vector<double>;

// Where the points of a row lie: u of each.
struct Points {
  explicit Points(int size)
      : stride(static_cast<std::size_t>(std::max(size, kMostLanes))), u(2 * stride) {
    for (std::size_t right = 0; right < 2; ++right) {
      for (int x = 0; x < size; ++x) {
        u[right * stride + static_cast<std::size_t>(x)] = (x + (right == 0 ? 0.25 : 0.75)) / size;
      }
    }
  }
  std::size_t stride;
  Column u;
};

// One octave of value_noise() along the points.
class OctaveColumns {
 public:
  OctaveColumns(const Points& points, int period_x, int period_y)
      : period_x_(period_x),
        period_y_(period_y),
        upper_(points.u.size()),
        lower_(points.u.size()),
        rise_(points.u.size()) {
    for (const double u : points.u) {
      const Cell column = cell_at(u * period_x);
      columns_.push_back(column.index);
      weights_.push_back(smooth_step(0.0, 1.0, column.inside));
    }
  }

  OctaveLine line(std::uint64_t seed, double v) {
    const Cell row = cell_at(v * period_y_);
    if (seed != seed_ || row.index != row_) {
      if (seed == seed_ && row.index == row_below_) {
        std::swap(upper_, lower_);
      } else {
        blend_along_u(seed, row.index, upper_);
      }
      seed_ = seed;
      row_ = row.index;
      row_below_ = row.index + 1 < period_y_ ? row.index + 1 : 0;
      blend_along_u(seed, row_below_, lower_);
      for (std::size_t i = 0; i < rise_.size(); ++i) rise_[i] = lower_[i] - upper_[i];
    }
    return {upper_.data(), rise_.data(), smooth_step(0.0, 1.0, row.inside)};
  }

 private:
  void blend_along_u(std::uint64_t seed, int lattice_row, Column& values) const {
    int column = -1;
    double left = 0.0, rise = 0.0;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (columns_[i] != column) {
        column = columns_[i];
        left = cell_random(seed, column, lattice_row);
        rise = cell_random(seed, column + 1 < period_x_ ? column + 1 : 0, lattice_row) - left;
      }
      values[i] = left + rise * weights_[i];
    }
  }

  int period_x_, period_y_;
  int row_ = -1, row_below_ = -1;
  std::uint64_t seed_ = 0;
  std::vector<int> columns_;
  Column weights_, upper_, lower_, rise_;
};

// fractal_noise() along the points.
class NoiseColumns {
 public:
  NoiseColumns(const Points& points, int cells_x, int cells_y) : values_(points.u.size()) {
    for (std::size_t i = 0; i < kOctaves; ++i) {
      octaves_.emplace_back(points, cells_x << i, cells_y << i);
    }
  }
  const Column& at(std::uint64_t seed, double v, Isa isa) {
    std::array<OctaveLine, kOctaves> lines{};
    for (std::size_t i = 0; i < kOctaves; ++i) lines[i] = octaves_[i].line(seed + i, v);
    SOFTFOCUS_KERNEL(isa, add_octaves)(lines, values_.size(), values_.data());
    return values_;
  }

 private:
  std::vector<OctaveColumns> octaves_;
  Column values_;
};

// What the patterns have in common, and what a row of points gets.
struct PatternRow {
  PatternRow(const TextureRecipe& wanted, Isa unit)
      : recipe(wanted),
        isa(unit),
        points(wanted.size),
        share(points.u.size(), 1.0),
        factor(points.u.size(), 1.0) {
    figure.fill(Column(points.u.size()));
    noises.reserve(2);  // whose values are referred to
  }

  void set_figure(std::size_t i, glm::dvec3 value) {
    for (int c = 0; c < 3; ++c) figure[static_cast<std::size_t>(c)][i] = value[c];
  }
  void set_colours(glm::dvec3 below, glm::dvec3 above) {
    ground = below;
    for (std::size_t i = 0; i < points.u.size(); ++i) set_figure(i, above);
  }
  NoiseColumns& noise(std::size_t number, int cells_x, int cells_y) {
    if (noises.size() == number) noises.emplace_back(points, cells_x, cells_y);
    return noises[number];
  }
  // grain() into `factor`.
  void set_grain(double v, double strength) {
    const Column& grains = noise(0, 8, 8).at(recipe.seed + 100, v, isa);
    SOFTFOCUS_KERNEL(isa, subtract_scaled)(grains.data(), strength, factor.size(), factor.data());
  }
  // smooth_step() of the smaller of `edges` and `edge` into `share`.
  void set_share_by_edges(double edge, double low, double high) {
    SOFTFOCUS_KERNEL(isa, step_from_edge)
    (edges.data(), edge, low, high, share.size(), share.data());
  }

  const TextureRecipe& recipe;
  Isa isa;
  Points points;
  std::vector<NoiseColumns> noises{};
  int row_of_cells = -1;  // that `figure` and `edges` belong to
  Column edges{};         // of the patterns with fields: how far a point is from its sides
  glm::dvec3 ground{0.0};
  std::array<Column, 3> figure{};
  Column share, factor;
};

// Whether the next row of the pattern's cells begins.
bool begins_cells(PatternRow& row, int index) {
  return std::exchange(row.row_of_cells, index) != index;
}

void checker_row(PatternRow& row, double v) {
  const TextureRecipe& recipe = row.recipe;
  const int below = cell_at(v * recipe.cells).index;
  if (begins_cells(row, below)) {
    for (std::size_t i = 0; i < row.points.u.size(); ++i) {
      const int fields = cell_at(row.points.u[i] * recipe.cells).index + below;
      row.set_figure(i, colour(recipe, (fields & 1) != 0 ? 1 : 0));
    }
  }
  row.set_grain(v, 0.15);
}

void stripes_row(PatternRow& row, double v) {
  const int stripe = cell_at(v * row.recipe.cells).index;
  if (begins_cells(row, stripe)) {
    row.set_colours(glm::dvec3{0.0}, colour(row.recipe, (stripe & 1) != 0 ? 1 : 0));
  }
  row.set_grain(v, 0.15);
}

void dots_row(PatternRow& row, double v) {
  const TextureRecipe& recipe = row.recipe;
  if (begins_cells(row, 0)) {
    row.set_colours(colour(recipe, 1), colour(recipe, 0));
    for (const double u : row.points.u) {
      const double x = cell_at(u * recipe.cells).inside - 0.5;
      row.edges.push_back(x * x);
    }
  }
  const double y = cell_at(v * recipe.cells).inside - 0.5;
  SOFTFOCUS_KERNEL(row.isa, step_from_centre)
  (row.edges.data(), y * y, 0.29, 0.32, row.share.size(), row.share.data());
  row.set_grain(v, 0.15);
}

void bricks_row(PatternRow& row, double v) {
  const TextureRecipe& recipe = row.recipe;
  const int bricks_a_course = std::max(1, recipe.cells / 2);
  const Cell course = cell_at(v * recipe.cells);
  if (begins_cells(row, course.index)) {
    const double shift = (course.index & 1) != 0 ? 0.5 : 0.0;
    row.ground = colour(recipe, 0);
    row.edges.resize(row.points.u.size());
    for (std::size_t i = 0; i < row.edges.size(); ++i) {
      const Cell brick = cell_at(row.points.u[i] * bricks_a_course + shift);
      const double tone = cell_random(recipe.seed, brick.index % bricks_a_course, course.index);
      row.set_figure(i, mix(colour(recipe, 1), colour(recipe, 2), tone));
      const double x = brick.inside * 2.0;
      row.edges[i] = std::min(x, 2.0 - x);
    }
  }
  row.set_share_by_edges(std::min(course.inside, 1.0 - course.inside), 0.045, 2.0 * 0.045);
  row.set_grain(v, 0.45);
}

void tiles_row(PatternRow& row, double v) {
  const TextureRecipe& recipe = row.recipe;
  const Cell below = cell_at(v * recipe.cells);
  if (begins_cells(row, below.index)) {
    row.ground = colour(recipe, 0);
    row.edges.resize(row.points.u.size());
    for (std::size_t i = 0; i < row.edges.size(); ++i) {
      const Cell column = cell_at(row.points.u[i] * recipe.cells);
      const double tone = cell_random(recipe.seed, column.index, below.index);
      row.set_figure(i, colour(recipe, ((column.index + below.index) & 1) != 0 ? 2 : 1) *
                            (0.85 + 0.15 * tone));
      row.edges[i] = std::min(column.inside, 1.0 - column.inside);
    }
  }
  row.set_share_by_edges(std::min(below.inside, 1.0 - below.inside), 0.02, 2.0 * 0.02);
  row.set_grain(v, 0.2);
}

void planks_row(PatternRow& row, double v) {
  const TextureRecipe& recipe = row.recipe;
  if (begins_cells(row, 0)) row.set_colours(colour(recipe, 0), colour(recipe, 1));
  const Cell plank = cell_at(v * recipe.cells);
  const auto own = recipe.seed + 1000u * static_cast<std::uint64_t>(plank.index);
  const Column& fibres = row.noise(0, 2, 4 * recipe.cells).at(own, v, row.isa);
  const Column& rings = row.noise(1, 1, recipe.cells).at(own + 50, v, row.isa);
  SOFTFOCUS_KERNEL(row.isa, tones_of_wood)
  (fibres.data(), rings.data(), 0.25 * cell_random(own, plank.index, 7), row.share.size(),
   row.share.data());
  const double gap = smooth_step(0.0, 0.06, std::min(plank.inside, 1.0 - plank.inside));
  std::fill(row.factor.begin(), row.factor.end(), 0.35 + 0.65 * gap);
}

void marble_row(PatternRow& row, double v) {
  const TextureRecipe& recipe = row.recipe;
  if (begins_cells(row, 0)) {
    row.set_colours(colour(recipe, 0), colour(recipe, 1));
    for (const double u : row.points.u) row.edges.push_back(u * recipe.cells);
  }
  const Column& warp = row.noise(0, recipe.cells, recipe.cells).at(recipe.seed, v, row.isa);
  const Column& cloud = row.noise(1, recipe.cells, recipe.cells).at(recipe.seed + 20, v, row.isa);
  SOFTFOCUS_KERNEL(row.isa, veins_of_marble)
  (row.edges.data(), warp.data(), cloud.data(), row.share.size(), row.share.data());
}

void clouds_row(PatternRow& row, double v) {
  const TextureRecipe& recipe = row.recipe;
  if (begins_cells(row, 0)) row.set_colours(colour(recipe, 0), colour(recipe, 1));
  const Column& cover = row.noise(0, recipe.cells, recipe.cells).at(recipe.seed, v, row.isa);
  SOFTFOCUS_KERNEL(row.isa, step_row)(cover.data(), 0.25, 0.75, row.share.size(), row.share.data());
}

using FillRow = void (*)(PatternRow& row, double v);

// Of a pattern; nullptr if it has colour_at() alone.
FillRow fill_of(const TexturePattern& pattern) {
  constexpr std::pair<std::string_view, FillRow> kRows[] = {
      {"checker", checker_row}, {"stripes", stripes_row}, {"dots", dots_row},
      {"bricks", bricks_row},   {"tiles", tiles_row},     {"planks", planks_row},
      {"marble", marble_row},   {"clouds", clouds_row},
  };
  const auto found = std::find_if(std::begin(kRows), std::end(kRows),
                                  [&](const auto& row) { return row.first == pattern.name; });
  return found != std::end(kRows) ? found->second : nullptr;
}

void paint_rows_in_lanes(const ProceduralTexture& wanted, FillRow fill_row, int first, int end,
                         Isa isa, Image& image) {
  const int size = wanted.recipe.size;
  PatternRow row{wanted.recipe, isa};
  const std::size_t stride = row.points.stride;
  std::vector<double> sums(3 * stride);
  std::vector<std::uint32_t> texels(stride);
  for (int y = first; y < end; ++y) {
    std::fill(sums.begin(), sums.end(), 0.0);
    for (const double below : {0.25, 0.75}) {
      fill_row(row, (y + below) / size);
      const PointColours colours{{row.ground.x, row.ground.y, row.ground.z},
                                 {row.figure[0].data(), row.figure[1].data(), row.figure[2].data()},
                                 row.share.data(),
                                 row.factor.data()};
      SOFTFOCUS_KERNEL(isa, add_colours)(colours, stride, sums.data());
    }
    SOFTFOCUS_KERNEL(isa, pack_texels)(sums.data(), stride, texels.data());
    std::memcpy(softfocus::row<std::uint8_t>(image, y).data(), texels.data(),
                4 * static_cast<std::size_t>(size));
  }
}

}  // namespace

std::vector<Texture> make_procedural_textures(std::span<const ProceduralTexture> wanted,
                                              ThreadPool* pool) {
  if (pool == nullptr) {
    ThreadPool here{1};
    return make_procedural_textures(wanted, &here);
  }
  struct Band {
    std::size_t texture;
    int first, end;
  };
  constexpr int kBandRows = 64;  // so that what a band begins with costs little
  std::vector<Image> images;
  std::vector<Band> bands;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const TextureRecipe& recipe = wanted[i].recipe;
    assert(recipe.size >= 1 && recipe.size <= kMaxTextureSize &&
           (recipe.size & (recipe.size - 1)) == 0);
    assert(recipe.cells >= 1 && recipe.colours.size() == wanted[i].pattern->colour_count);
    images.push_back(make_image(Format::rgba8, recipe.size, recipe.size));
    for (int y = 0; y < recipe.size; y += kBandRows) {
      bands.push_back({i, y, std::min(y + kBandRows, recipe.size)});
    }
  }
  pool->for_each(static_cast<int>(bands.size()), [&](int i) {
    const Band& band = bands[static_cast<std::size_t>(i)];
    const ProceduralTexture& texture = wanted[band.texture];
    Image& image = images[band.texture];
    if (const FillRow fill_row = fill_of(*texture.pattern);
        fill_row == nullptr || pool->isa() == Isa::scalar) {
      paint_rows(texture, band.first, band.end, image);
    } else {
      paint_rows_in_lanes(texture, fill_row, band.first, band.end, pool->isa(), image);
    }
  });
  std::vector<Texture> textures(wanted.size());
  pool->for_each(static_cast<int>(wanted.size()), [&](int i) {
    const auto number = static_cast<std::size_t>(i);
    textures[number] = make_texture(std::move(images[number]));
    generate_mipmaps(textures[number], Profile{});
  });
  return textures;
}

Texture make_procedural_texture(const TexturePattern& pattern, const TextureRecipe& recipe) {
  const ProceduralTexture wanted{&pattern, recipe};
  return std::move(make_procedural_textures({&wanted, 1}, nullptr).front());
}

}  // namespace softfocus

#else  // the kernels

// Of one register: half as many as lanes.
using PointDoubles [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = double;
using PointInts [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = std::int32_t;
using PointFloats [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = float;
inline constexpr std::size_t kPointLanes = SOFTFOCUS_LANES / 2;

SOFTFOCUS_INLINE PointDoubles load_points(const double* from) {
  PointDoubles v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
SOFTFOCUS_INLINE void store_points(double* to, PointDoubles v) { std::memcpy(to, &v, sizeof v); }
SOFTFOCUS_INLINE PointDoubles splat_points(double value) { return PointDoubles{} + value; }
SOFTFOCUS_INLINE PointDoubles smaller_points(PointDoubles a, PointDoubles b) {
  return b < a ? b : a;
}

SOFTFOCUS_INLINE PointDoubles root_points(PointDoubles v) {
#if SOFTFOCUS_LANES == 16
  return (PointDoubles)_mm512_maskz_sqrt_pd(0xFF, (__m512d)v);
#elif SOFTFOCUS_LANES == 8
  return (PointDoubles)_mm256_sqrt_pd((__m256d)v);
#elif defined(__SSE2__)
  return (PointDoubles)_mm_sqrt_pd((__m128d)v);
#else
  for (std::size_t k = 0; k < kPointLanes; ++k) v[k] = std::sqrt(v[k]);
  return v;
#endif
}

/// smooth_step()
SOFTFOCUS_INLINE PointDoubles step_points(double low, double high, PointDoubles x) {
  PointDoubles t = (x - low) / (high - low);
  t = t < 0.0 ? splat_points(0.0) : t;
  t = t > 1.0 ? splat_points(1.0) : t;
  return t * t * (3.0 - 2.0 * t);
}

/// Cell::inside
SOFTFOCUS_INLINE PointDoubles inside_points(PointDoubles position) {
  return position -
         __builtin_convertvector(__builtin_convertvector(position, PointInts), PointDoubles);
}

/// fractal_noise()
void add_octaves(const std::array<OctaveLine, kOctaves>& octaves, std::size_t count,
                 double* values) {
  for (std::size_t i = 0; i < count; i += kPointLanes) {
    PointDoubles sum = splat_points(0.0);
    double strength = 8.0 / 15.0;
    for (const OctaveLine& octave : octaves) {
      sum +=
          strength * (load_points(octave.upper + i) + load_points(octave.rise + i) * octave.weight);
      strength *= 0.5;
    }
    store_points(values + i, sum);
  }
}

/// 1 - strength * value
void subtract_scaled(const double* values, double strength, std::size_t count, double* to) {
  for (std::size_t i = 0; i < count; i += kPointLanes) {
    store_points(to + i, 1.0 - strength * load_points(values + i));
  }
}

void step_row(const double* values, double low, double high, std::size_t count, double* to) {
  for (std::size_t i = 0; i < count; i += kPointLanes) {
    store_points(to + i, step_points(low, high, load_points(values + i)));
  }
}

/// field(), of what is nearer of two edges
void step_from_edge(const double* edges, double edge, double low, double high, std::size_t count,
                    double* to) {
  const PointDoubles other = splat_points(edge);
  for (std::size_t i = 0; i < count; i += kPointLanes) {
    const PointDoubles nearest = smaller_points(load_points(edges + i), other);
    store_points(to + i, step_points(low, high, nearest));
  }
}

/// dots()' share of the ground, from squares of distances
void step_from_centre(const double* squares, double square, double low, double high,
                      std::size_t count, double* to) {
  for (std::size_t i = 0; i < count; i += kPointLanes) {
    const PointDoubles distance = root_points(load_points(squares + i) + square);
    store_points(to + i, step_points(low, high, distance));
  }
}

/// planks()' tone
void tones_of_wood(const double* fibres, const double* rings, double own, std::size_t count,
                   double* to) {
  for (std::size_t i = 0; i < count; i += kPointLanes) {
    const PointDoubles band = inside_points(load_points(rings + i) * 9.0);
    store_points(to + i, 0.45 * load_points(fibres + i) + 0.3 * band + own);
  }
}

/// marble()'s share of the vein; `waves`: without the warp
void veins_of_marble(const double* waves, const double* warp, const double* cloud,
                     std::size_t count, double* to) {
  for (std::size_t i = 0; i < count; i += kPointLanes) {
    const PointDoubles wave = inside_points(load_points(waves + i) + 3.0 * load_points(warp + i));
    const PointDoubles side = 2.0 * wave - 1.0;
    const PointDoubles from_crest = side < 0.0 ? -side : side;
    const PointDoubles vein = 1.0 - step_points(0.0, 0.55, from_crest);
    store_points(to + i,
                 smaller_points(splat_points(1.0), 0.8 * vein + 0.35 * load_points(cloud + i)));
  }
}

/// Adds what two points of each texel have, the left one first.
void add_colours(const PointColours& colours, std::size_t stride, double* sums) {
  for (std::size_t i = 0; i < stride; i += kPointLanes) {
    const PointDoubles left_share = load_points(colours.share + i);
    const PointDoubles left_factor = load_points(colours.factor + i);
    const PointDoubles right_share = load_points(colours.share + stride + i);
    const PointDoubles right_factor = load_points(colours.factor + stride + i);
    for (std::size_t c = 0; c < 3; ++c) {
      const double ground = colours.ground[c];
      const PointDoubles left = load_points(colours.figure[c] + i);
      const PointDoubles right = load_points(colours.figure[c] + stride + i);
      PointDoubles sum = load_points(sums + c * stride + i);
      sum += (ground + (left - ground) * left_share) * left_factor;
      sum += (ground + (right - ground) * right_share) * right_factor;
      store_points(sums + c * stride + i, sum);
    }
  }
}

/// linear_to_unorm8() of a quarter of each sum; red, green, blue and 255 in memory.
void pack_texels(const double* sums, std::size_t stride, std::uint32_t* texels) {
  for (std::size_t i = 0; i < stride; i += kPointLanes) {
    PointInts packed = PointInts{};
    for (std::size_t c = 0; c < 3; ++c) {
      const PointDoubles mean = load_points(sums + c * stride + i) * 0.25;
      PointDoubles value =
          __builtin_convertvector(__builtin_convertvector(mean, PointFloats), PointDoubles);
      value = value > 0.0 ? value : splat_points(0.0);
      value = value < 1.0 ? value : splat_points(1.0);
      const PointInts code = __builtin_convertvector(value * 255.0 + 0.5, PointInts);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
      packed |= code << static_cast<int>(24 - 8 * c);
    }
    packed |= 255;
#else
      packed |= code << static_cast<int>(8 * c);
    }
    packed |= static_cast<std::int32_t>(0xFF000000u);
#endif
    std::memcpy(texels + i, &packed, sizeof packed);
  }
}

#endif
