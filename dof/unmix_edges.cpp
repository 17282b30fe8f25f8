#include "dof/unmix_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "dof/smooth_edges.h"
#include "raster/numbers/half.h"
#include "raster/pipeline/multisample.h"
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
struct Source {
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

Source source_of(const ConstImageView& scene, ThreadPool& pool) {
  Source source{scene.width, scene.height, {}, {}, {}};
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

/// A surface's colour around a pixel, of pixels that are of it alone, or else of those on edges.
struct SurfaceColour {
  glm::vec3 mean{};
  bool is_pure = false;
};

template <class Visit>
void for_each_of_surface(const Source& source, int x, int y, float surface, float other,
                         const Visit& visit) {
  // A quarter of the way to the other is still this one.
  const float most = 0.25f * std::fabs(surface - other);
  for (int dy = -kPureReach; dy <= kPureReach; ++dy) {
    for (int dx = -kPureReach; dx <= kPureReach; ++dx) {
      if (!source.has(x + dx, y + dy)) continue;
      const std::size_t at = source.at(x + dx, y + dy);
      if (std::fabs(source.inverse_depths[at] - surface) > most) continue;
      visit(at, 1.0f / static_cast<float>(1 + dx * dx + dy * dy));
    }
  }
}

SurfaceColour colour_of(const Source& source, int x, int y, float surface, float other) {
  SurfaceColour found;
  glm::vec3 pure{}, mixed{};
  float pure_weight = 0.0f, mixed_weight = 0.0f;
  for_each_of_surface(source, x, y, surface, other, [&](std::size_t at, float weight) {
    if (source.on_edge[at] == 0) {
      pure += source.colours[at] * weight;
      pure_weight += weight;
    } else {
      mixed += source.colours[at] * weight;
      mixed_weight += weight;
    }
  });
  found.is_pure = pure_weight > 0.0f;
  found.mean = found.is_pure ? pure * (1.0f / pure_weight) : mixed * (1.0f / mixed_weight);
  return found;
}

/// The mixed pixel of a surface whose colour is farthest from another surface's.
glm::vec3 purest(const Source& source, int x, int y, float surface, float other,
                 const glm::vec3& other_colour) {
  glm::vec3 colour{};
  float most = -1.0f;
  for_each_of_surface(source, x, y, surface, other, [&](std::size_t at, float) {
    const glm::vec3 apart = source.colours[at] - other_colour;
    const float square = glm::dot(apart, apart);
    if (square > most) {
      most = square;
      colour = source.colours[at];
    }
  });
  return colour;
}

/// A pixel as two surfaces.
struct TwoSurfaces {
  glm::vec3 own{}, other{};
  float other_inverse_depth = 0.0f;
  float part = 0.0f;      ///< that the other has
  float residual = 0.0f;  ///< squared: of the colour, what no mixture gives
};

std::optional<TwoSurfaces> take_apart(const Source& source, int x, int y, float other) {
  const float own = source.inverse_depths[source.at(x, y)];
  SurfaceColour mine = colour_of(source, x, y, own, other);
  SurfaceColour its = colour_of(source, x, y, other, own);
  if (!mine.is_pure) mine.mean = purest(source, x, y, own, other, its.mean);
  if (!its.is_pure) its.mean = purest(source, x, y, other, own, mine.mean);
  const glm::vec3 colour = source.colours[source.at(x, y)];
  const glm::vec3 apart = its.mean - mine.mean;
  const float square = glm::dot(apart, apart);
  const float light = glm::dot(mine.mean, mine.mean) + glm::dot(its.mean, its.mean);
  constexpr float kLeastContrast = 0.05f;
  if (!(square > kLeastContrast * kLeastContrast * light)) return {};
  TwoSurfaces found;
  found.other_inverse_depth = other;
  const float part = std::clamp(glm::dot(colour - mine.mean, apart) / square, 0.0f, 1.0f);
  // As a byte holds it, so that both together are the pixel again.
  found.part = std::floor(part * 255.0f + 0.5f) / 255.0f;
  const glm::vec3 rest = colour - (mine.mean * (1.0f - found.part) + its.mean * found.part);
  found.residual = glm::dot(rest, rest);
  found.own = mine.mean + rest;
  found.other = its.mean + rest;
  return found;
}

/// Of the surfaces across edges the one of which, with its own, the pixel's colour is a mixture.
std::optional<TwoSurfaces> two_surfaces(const Source& source, int x, int y) {
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

}  // namespace

UnmixedEdges unmix_edges(const ImageView& scene, const Profile& profile, ThreadPool& pool) {
  const Source source = source_of(scene, pool);
  struct Taken {
    int x;
    TwoSurfaces surfaces;
  };
  std::vector<std::vector<Taken>> rows(static_cast<std::size_t>(scene.height));
  std::vector<std::array<std::size_t, 2>> counts(rows.size());
  for_each_row(pool, scene.height, kUnmixedRows, [&](int y) {
    for (int x = 0; x < scene.width; ++x) {
      if (source.on_edge[source.at(x, y)] == 0) continue;
      const auto found = two_surfaces(source, x, y);
      if (!found) continue;
      auto& [edges, mixtures] = counts[static_cast<std::size_t>(y)];
      ++edges;
      mixtures += found->part > 0.2f && found->part < 0.8f ? 1 : 0;
      if (found->part > 0.0f) rows[static_cast<std::size_t>(y)].push_back({x, *found});
    }
  });
  std::size_t edges = 0, mixtures = 0;
  for (const auto& of_row : counts) {
    edges += of_row[0];
    mixtures += of_row[1];
  }
  UnmixedEdges result;
  // Means over a pixel are of any part. Without them it is a surface's texture that lies between.
  if (6 * mixtures < edges) return result;
  result.other = make_image(Format::rgba16f, scene.width, scene.height);
  result.coverage = make_image(Format::r8, scene.width, scene.height);
  for_each_row(pool, scene.height, kUnmixedRows, [&](int y) {
    const std::span<std::uint16_t> own = row<std::uint16_t>(scene, y);
    const std::span<std::uint16_t> other = row<std::uint16_t>(result.other, y);
    const std::span<std::uint8_t> coverage = row<std::uint8_t>(result.coverage, y);
    const auto half = [&](float value) {
      return float_to_half(std::max(value, 0.0f), profile.half_store);
    };
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
