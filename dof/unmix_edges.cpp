#include "dof/unmix_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dof/smooth_edges.h"
#include "raster/numbers/half.h"
#include "raster/threads/float_environment.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

constexpr int kUnmixedRows = 8;

struct Step {
  int x, y;
};
// The nearest first.
constexpr std::array<Step, 8> kAcross{
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
/// How far away a surface is looked for without a mixture: on a straight edge the second pixel on
/// either side is the first.
constexpr int kPureReach = 2;

/// The picture as it came.
struct MixedPicture {
  int width, height;
  std::vector<glm::vec3> colours;
  std::vector<float> inverse_depths;  ///< in which planes are linear
  std::vector<std::uint8_t> on_edge;

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  bool has(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }

  /// Whether an edge lies between a pixel and the next one.
  bool has_edge(int x, int y, const Step& step) const {
    if (!has(x + step.x, y + step.y)) return false;
    const auto inverse = [&](int i) -> std::optional<float> {
      const int u = x + i * step.x, v = y + i * step.y;
      if (!has(u, v)) return {};
      return inverse_depths[at(u, v)];
    };
    return is_step(inverse(-1), *inverse(0), *inverse(1), inverse(2));
  }
};

MixedPicture source_of(const ConstImageView& scene, ThreadPool& pool) {
  MixedPicture source{scene.width, scene.height, {}, {}, {}};
  const std::size_t pixels = source.at(0, scene.height);
  source.colours.resize(pixels);
  source.inverse_depths.resize(pixels);
  source.on_edge.resize(pixels);
  for_each_row(pool, scene.height, kUnmixedRows, [&](int y) {
    const std::span<const std::uint16_t> texels = row<std::uint16_t>(scene, y);
    for (int x = 0; x < scene.width; ++x) {
      const std::uint16_t* v = &texels[4 * static_cast<std::size_t>(x)];
      source.colours[source.at(x, y)] = {half_to_float(v[0]), half_to_float(v[1]),
                                         half_to_float(v[2])};
      source.inverse_depths[source.at(x, y)] = 1.0f / half_to_float(v[3]);
    }
  });
  for_each_row(pool, scene.height, kUnmixedRows, [&](int y) {
    for (int x = 0; x < scene.width; ++x) {
      bool on_edge = false;
      for (const Step& step : kAcross) on_edge = on_edge || source.has_edge(x, y, step);
      source.on_edge[source.at(x, y)] = on_edge ? 1 : 0;
    }
  });
  return source;
}

/// Calls `visit` with the place of each pixel that a surface's colour is taken from, and the square
/// of its distance.
template <class Visit>
void for_each_around(const MixedPicture& source, int x, int y, const Visit& visit) {
  for (int dy = -kPureReach; dy <= kPureReach; ++dy) {
    for (int dx = -kPureReach; dx <= kPureReach; ++dx) {
      if (source.has(x + dx, y + dy)) visit(source.at(x + dx, y + dy), dx * dx + dy * dy);
    }
  }
}

struct SurfaceColour {
  glm::vec3 mean{};
  float variance = 0.0f;  ///< of the three channels together
};

/// A surface around a pixel, as it shows where it has no edge, nearer pixels for more.
std::optional<SurfaceColour> pure_colour(const MixedPicture& source, int x, int y, float surface,
                                         float other) {
  // A quarter of the way to the other is still this one.
  const float most = 0.25f * std::fabs(surface - other);
  glm::vec3 sum{};
  float squares = 0.0f, weights = 0.0f;
  for_each_around(source, x, y, [&](std::size_t at, int square) {
    if (source.on_edge[at] != 0 || std::fabs(source.inverse_depths[at] - surface) > most) return;
    const glm::vec3& colour = source.colours[at];
    const float weight = 1.0f / static_cast<float>(1 + square);
    sum += colour * weight;
    squares += glm::dot(colour, colour) * weight;
    weights += weight;
  });
  if (weights == 0.0f) return {};
  const glm::vec3 mean = sum * (1.0f / weights);
  return SurfaceColour{mean, std::max(squares / weights - glm::dot(mean, mean), 0.0f)};
}

/// A surface that shows nowhere without a mixture: the light that it adds to another's, over the
/// pixels that have its depth, which are as many as its area is in the mean. None if the other's
/// texture could be that light.
std::optional<SurfaceColour> colour_by_light(const MixedPicture& source, int x, int y,
                                             float surface, const SurfaceColour& other,
                                             float other_inverse) {
  const float border = 0.5f * (surface + other_inverse);
  glm::vec3 light{};
  float pixels = 0.0f, area = 0.0f;
  for_each_around(source, x, y, [&](std::size_t at, int) {
    if (source.on_edge[at] == 0) return;
    const float depth = source.inverse_depths[at];
    light += source.colours[at] - other.mean;
    pixels += 1.0f;
    if (surface > other_inverse ? depth > border : depth <= border) area += 1.0f;
  });
  constexpr float kMostDoubt = 0.03f;
  if (!(pixels * other.variance < kMostDoubt * glm::dot(light, light))) return {};
  return SurfaceColour{glm::max(other.mean + light * (1.0f / area), glm::vec3{0.0f}),
                       other.variance * pixels / (area * area)};
}

/// The colours of two surfaces around a pixel. None if neither shows without a mixture.
std::optional<std::pair<SurfaceColour, SurfaceColour>> colours_around(const MixedPicture& source,
                                                                      int x, int y, float own,
                                                                      float other) {
  auto own_colour = pure_colour(source, x, y, own, other);
  auto other_colour = pure_colour(source, x, y, other, own);
  if (!own_colour && other_colour) {
    own_colour = colour_by_light(source, x, y, own, *other_colour, other);
  } else if (own_colour && !other_colour) {
    other_colour = colour_by_light(source, x, y, other, *own_colour, own);
  }
  if (!own_colour || !other_colour) return {};
  return std::pair{*own_colour, *other_colour};
}

/// The part of a pixel that another surface has by the depths of its neighbours.
float part_by_depth(const MixedPicture& source, int x, int y, float other) {
  const float own = source.inverse_depths[source.at(x, y)];
  const float border = 0.5f * (own + other);
  float sum = 0.0f, weights = 4.0f;
  for (const Step& step : kAcross) {
    if (!source.has(x + step.x, y + step.y)) continue;
    const float weight = step.x == 0 || step.y == 0 ? 2.0f : 1.0f;
    const float depth = source.inverse_depths[source.at(x + step.x, y + step.y)];
    weights += weight;
    if (other > own ? depth > border : depth < border) sum += weight;
  }
  return sum / weights;
}

/// A pixel as two surfaces.
struct TwoSurfaces {
  glm::vec3 own{}, other{};
  float other_inverse_depth = 0.0f;
  float part = 0.0f;      ///< that the other has
  float residual = 0.0f;  ///< squared: of the colour, what no mixture gives
  bool is_clear = false;  ///< whether both surfaces are of one colour each
  bool mixes = false;     ///< whether the pixel's colour is far from either
};

/// What the mean colours leave over of the pixel's goes to the surface that varies more. False if
/// both vary too little for it: then a third surface has a part.
bool share_rest(const glm::vec3& colour, const SurfaceColour& own, const SurfaceColour& other,
                TwoSurfaces& found) {
  const float own_part = 1.0f - found.part;
  const glm::vec3 rest = colour - (own.mean * own_part + other.mean * found.part);
  found.residual = glm::dot(rest, rest);
  const float varies =
      own_part * own_part * own.variance + found.part * found.part * other.variance;
  constexpr float kMost = 6.0f;  // of the variance
  if (!(found.residual <= kMost * varies)) return false;
  const glm::vec3 share = rest * (1.0f / varies);
  found.own = own.mean + share * (own_part * own.variance);
  found.other = other.mean + share * (found.part * other.variance);
  // No light is negative: then the other has all that is left.
  for (int c = 0; c < 3; ++c) {
    if (colour[c] < 0.0f) continue;
    if (found.own[c] < 0.0f) {
      found.own[c] = 0.0f;
      if (found.part > 0.0f) found.other[c] = colour[c] / found.part;
    } else if (found.other[c] < 0.0f) {
      found.other[c] = 0.0f;
      if (own_part > 0.0f) found.own[c] = colour[c] / own_part;
    }
  }
  for (const glm::vec3& of : {glm::abs(found.own), glm::abs(found.other)}) {
    if (!(std::max({of.x, of.y, of.z}) <= kLargestHalf)) return false;
  }
  return true;
}

std::optional<TwoSurfaces> take_apart(const MixedPicture& source, int x, int y, float other) {
  const auto colours = colours_around(source, x, y, source.inverse_depths[source.at(x, y)], other);
  if (!colours) return {};
  auto [mine, its] = *colours;
  const glm::vec3 colour = source.colours[source.at(x, y)];
  const glm::vec3 apart = its.mean - mine.mean;
  const float square = glm::dot(apart, apart);
  const float light = glm::dot(mine.mean, mine.mean) + glm::dot(its.mean, its.mean);
  constexpr float kLeastContrast = 0.05f;
  if (!(square > kLeastContrast * kLeastContrast * light)) return {};
  constexpr float kNoise = 1e-4f;  // of the light: variance of a surface of one colour
  mine.variance += kNoise * light;
  its.variance += kNoise * light;
  // The likeliest part, of what the colour and the depths around say, each with its doubt.
  constexpr float kDoubt = 0.0625f;  // variance of the part by depths
  const float by_depth = part_by_depth(source, x, y, other);
  const float by_colour = glm::dot(colour - mine.mean, apart) / square;
  const float doubt =
      ((1.0f - by_depth) * (1.0f - by_depth) * mine.variance + by_depth * by_depth * its.variance) /
      square;
  const float part =
      std::clamp((by_colour * kDoubt + by_depth * doubt) / (kDoubt + doubt), 0.0f, 1.0f);
  TwoSurfaces found;
  found.other_inverse_depth = other;
  // As a byte holds it, so that both together are the pixel again.
  found.part = std::floor(part * 255.0f + 0.5f) / 255.0f;
  found.is_clear = doubt < 0.02f;
  found.mixes = by_colour > 0.2f && by_colour < 0.8f;
  if (!share_rest(colour, mine, its, found)) return {};
  return found;
}

/// A pixel with a nearer or a farther surface across an edge: that which explains its colour best.
std::optional<TwoSurfaces> two_surfaces(const MixedPicture& source, int x, int y) {
  const float own = source.inverse_depths[source.at(x, y)];
  std::optional<TwoSurfaces> best;
  for (const bool nearer : {true, false}) {
    for (const Step& step : kAcross) {
      if (!source.has_edge(x, y, step)) continue;
      const float other = source.inverse_depths[source.at(x + step.x, y + step.y)];
      if ((other > own) != nearer) continue;
      const auto found = take_apart(source, x, y, other);
      if (found && (!best || found->residual < best->residual)) best = found;
      break;
    }
  }
  return best;
}

/// How far two surfaces are blurred apart: 0 if a ghost of one in the other could not be seen.
float blur_apart(const DofSettings& settings, float depth_m, float other_m) {
  const auto radius = [&](float metres) {
    const float px = std::isinf(metres) ? settings.coc.radius_at_infinity_px
                                        : coc_radius_px(settings.coc, metres);
    return std::clamp(px, -settings.max_coc_px, settings.max_coc_px);
  };
  const float apart_px = std::fabs(radius(depth_m) - radius(other_m));
  return std::clamp((apart_px - 2.0f) / 3.0f, 0.0f, 1.0f);
}

void soften(TwoSurfaces& found, const glm::vec3& colour, float part) {
  found.own = colour + (found.own - colour) * part;
  found.other = colour + (found.other - colour) * part;
  if (part == 0.0f) found.part = 0.0f;
}

}  // namespace

UnmixedEdges unmix_edges(const ImageView& scene, const DofSettings& settings,
                         const Profile& profile, ThreadPool& pool) {
  const DefaultFloatEnvironment environment;
  const MixedPicture source = source_of(scene, pool);
  struct Taken {
    int x;
    TwoSurfaces surfaces;
  };
  std::vector<std::vector<Taken>> rows(static_cast<std::size_t>(scene.height));
  std::vector<std::array<int, 2>> counts(rows.size());
  for_each_row(pool, scene.height, kUnmixedRows, [&](int y) {
    for (int x = 0; x < scene.width; ++x) {
      if (source.on_edge[source.at(x, y)] == 0) continue;
      auto found = two_surfaces(source, x, y);
      if (!found) continue;
      auto& [edges, mixtures] = counts[static_cast<std::size_t>(y)];
      edges += found->is_clear ? 1 : 0;
      mixtures += found->is_clear && found->mixes ? 1 : 0;
      soften(*found, source.colours[source.at(x, y)],
             blur_apart(settings, 1.0f / source.inverse_depths[source.at(x, y)],
                        1.0f / found->other_inverse_depth));
      if (found->part > 0.0f) rows[static_cast<std::size_t>(y)].push_back({x, *found});
    }
  });
  int edges = 0, mixtures = 0;
  for (const auto& of_row : counts) {
    edges += of_row[0];
    mixtures += of_row[1];
  }
  UnmixedEdges result;
  // Means over a pixel are of any part: a fifth or more of such pixels lie between. Of one sample a
  // pixel it is a tenth at most, by shading and texture.
  if (7 * mixtures <= edges) return result;
  result.other = make_image(Format::rgba16f, scene.width, scene.height);
  result.coverage = make_image(Format::r8, scene.width, scene.height);
  for_each_row(pool, scene.height, kUnmixedRows, [&](int y) {
    const std::span<std::uint16_t> own = row<std::uint16_t>(scene, y);
    const std::span<std::uint16_t> other = row<std::uint16_t>(result.other, y);
    const std::span<std::uint8_t> coverage = row<std::uint8_t>(result.coverage, y);
    const auto half = [&](float value) { return float_to_half(value, profile.half_store); };
    for (const auto& [x, found] : rows[static_cast<std::size_t>(y)]) {
      const std::size_t texel = 4 * static_cast<std::size_t>(x);
      for (int c = 0; c < 3; ++c) {
        own[texel + static_cast<std::size_t>(c)] = half(found.own[c]);
        other[texel + static_cast<std::size_t>(c)] = half(found.other[c]);
      }
      other[texel + 3] = half(1.0f / found.other_inverse_depth);
      coverage[static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(found.part * 255.0f + 0.5f);
    }
  });
  for (const auto& of_row : rows) result.pixels += of_row.size();
  return result;
}

}  // namespace softfocus
