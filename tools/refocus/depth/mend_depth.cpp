#include "tools/refocus/depth/mend_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "raster/images/texel.h"

namespace softfocus {
namespace {

double radius_px(double far_px, double focus_m, float metres) {
  const auto z = static_cast<double>(metres);
  return far_px * (z - focus_m) / z;
}

constexpr double kOtherFocus = 16.0;

}  // namespace

std::optional<FinerLens> finer_lens(float nearest_m, float farthest_m, const PixelCoc& coc) {
  constexpr double kEnough = 64.0;  // pixels: a 32nd is known of these
  const auto far_px = static_cast<double>(coc.radius_at_infinity_px);
  if (far_px <= kEnough) return std::nullopt;
  const double focus_m = static_cast<double>(coc.focus_m);
  const double nearest = radius_px(far_px, focus_m, nearest_m);
  const double farthest = radius_px(far_px, focus_m, farthest_m);
  // Not so near the farthest that depths there become many, nor so small that the nearest leave
  // what halves can hold.
  const double other_px = std::max(1.125 * farthest, 4.0);
  if (other_px - nearest > 0.5 * (far_px - nearest)) return std::nullopt;
  return FinerLens{
      far_px, focus_m, other_px, {static_cast<float>(other_px), static_cast<float>(kOtherFocus)}};
}

void to_finer_depths(std::span<float> metres, const FinerLens& lens) {
  for (float& depth_m : metres) {
    const double radius = radius_px(lens.far_px, lens.focus_m, depth_m);
    depth_m = static_cast<float>(kOtherFocus * lens.other_px / (lens.other_px - radius));
  }
}

std::optional<PixelCoc> with_finer_depths(DepthMap& map, const PixelCoc& coc) {
  if (map.metres.empty()) return std::nullopt;
  const auto ends = std::minmax_element(map.metres.begin(), map.metres.end());
  const std::optional<FinerLens> lens = finer_lens(*ends.first, *ends.second, coc);
  if (!lens) return std::nullopt;
  to_finer_depths(map.metres, *lens);
  return lens->coc;
}

namespace {

std::size_t place_of(int x, int y, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x);
}

/// About as an eye sees it.
glm::vec4 seen_colour(const Image& colour, int x, int y) {
  glm::vec4 seen = load_texel<Format::rgba16f>(colour, x, y);
  for (int c = 0; c < 3; ++c) seen[c] = std::sqrt(std::clamp(seen[c], 0.0f, 1.0f));
  return seen;
}

/// The mean colour around the middle of the part of the picture that a pixel of the smaller map
/// covers: half of its width and height, for its depth is that of its middle.
std::vector<glm::vec4> colours_of(const DepthMap& map, const Image& colour, ThreadPool& pool) {
  std::vector<glm::vec4> means(map.metres.size());
  pool.for_each(map.height, [&](int y) {
    const auto first_of = [](int i, int small, int large) {
      return static_cast<int>(std::int64_t{i} * large / small);
    };
    const auto middle_of = [](int& first, int& end) {
      const int quarter = (end - first) / 4;
      first += quarter;
      end = std::max(end - quarter, first + 1);
    };
    int y0 = first_of(y, map.height, colour.height);
    int y1 = first_of(y + 1, map.height, colour.height);
    middle_of(y0, y1);
    for (int x = 0; x < map.width; ++x) {
      int x0 = first_of(x, map.width, colour.width);
      int x1 = first_of(x + 1, map.width, colour.width);
      middle_of(x0, x1);
      glm::vec4 sum{0.0f};
      for (int v = y0; v < y1; ++v) {
        for (int u = x0; u < x1; ++u) sum += seen_colour(colour, u, v);
      }
      means[place_of(x, y, map.width)] = sum * (1.0f / static_cast<float>((x1 - x0) * (y1 - y0)));
    }
  });
  return means;
}

struct Weighed {
  float metres = 0.0f;
  float weight = 0.0f;
};

/// The mean of 1/z of those that are within a twentieth of the weighted median.
float mean_near_median(std::array<Weighed, 25>& all, std::size_t count) {
  const auto end = all.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(all.begin(), end,
            [](const Weighed& a, const Weighed& b) { return a.metres < b.metres; });
  float total = 0.0f;
  for (auto it = all.begin(); it != end; ++it) total += it->weight;
  float half = 0.0f;
  float median = all.front().metres;
  for (auto it = all.begin(); it != end; ++it) {
    half += it->weight;
    median = it->metres;
    if (half >= 0.5f * total) break;
  }
  constexpr float kWithin = 0.05f;
  float sum = 0.0f, weights = 0.0f;
  for (auto it = all.begin(); it != end; ++it) {
    if (std::isinf(median) || !(std::fabs(it->metres - median) <= kWithin * median)) continue;
    sum += it->weight / it->metres;
    weights += it->weight;
  }
  return weights > 0.0f ? weights / sum : median;
}

/// 1/z in a line between the four depths around (u, v), if the 4x4 around it are of one smooth
/// surface: a plane's 1/z is linear in the picture, so that its second differences are 0. Colours
/// need not be asked there, and would lean to one side on a pattern.
std::optional<float> on_smooth_surface(const DepthMap& map, float u, float v) {
  const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
  std::array<std::array<float, 4>, 4> inverse{};
  float largest = 0.0f;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      const int column = std::clamp(i + x - 1, 0, map.width - 1);
      const int row = std::clamp(j + y - 1, 0, map.height - 1);
      float& value = inverse[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
      value = 1.0f / map.metres[place_of(column, row, map.width)];
      largest = std::max(largest, value);
    }
  }
  constexpr float kBend = 0.01f;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = 0; b < 2; ++b) {
      const float across = inverse[a][b] - 2.0f * inverse[a][b + 1] + inverse[a][b + 2];
      const float down = inverse[b][a] - 2.0f * inverse[b + 1][a] + inverse[b + 2][a];
      if (std::fabs(across) > kBend * largest || std::fabs(down) > kBend * largest) return {};
    }
  }
  const float s = u - static_cast<float>(i), t = v - static_cast<float>(j);
  const float above = inverse[1][1] + s * (inverse[1][2] - inverse[1][1]);
  const float below = inverse[2][1] + s * (inverse[2][2] - inverse[2][1]);
  return 1.0f / (above + t * (below - above));
}

}  // namespace

PlaneValues without_bands(const PlaneValues& codes, int width, int height, ThreadPool& pool) {
  // Means of a box around each pixel, of codes a step away at most, moved by half a step at most.
  // Repeated, so that plateaus wider than the box become slopes too.
  constexpr int kReach = 4;
  constexpr int kPasses = 8;
  PlaneValues from = codes, to = codes;
  for (int pass = 0; pass < kPasses; ++pass) {
    pool.for_each(height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        const std::size_t here = place_of(x, y, width);
        const float code = codes[here];
        float sum = 0.0f, count = 0.0f;
        // Both neighbours at a distance or none: a mean at a picture's or a surface's border would
        // lean inwards.
        for (int d = 1; d <= kReach; ++d) {
          for (const auto& [dx, dy] : {std::array{d, 0}, std::array{0, d}}) {
            if (x - dx < 0 || x + dx >= width || y - dy < 0 || y + dy >= height) continue;
            const std::size_t a = place_of(x - dx, y - dy, width);
            const std::size_t b = place_of(x + dx, y + dy, width);
            if (!(std::fabs(codes[a] - code) <= 1.0f && std::fabs(codes[b] - code) <= 1.0f)) {
              continue;
            }
            sum += from[a] + from[b];
            count += 2.0f;
          }
        }
        const float mean = count > 0.0f ? (sum + from[here]) / (count + 1.0f) : from[here];
        to[here] = std::clamp(mean, code - 0.5f, code + 0.5f);
      }
    });
    std::swap(from, to);
  }
  return from;
}

DepthMap upsampled_to_nearest(const DepthMap& map, int width, int height) {
  DepthMap large{width, height, std::vector<float>(place_of(0, height, width))};
  for (int y = 0; y < height; ++y) {
    const int v = static_cast<int>(std::int64_t{2 * y + 1} * map.height / (2 * height));
    for (int x = 0; x < width; ++x) {
      const int u = static_cast<int>(std::int64_t{2 * x + 1} * map.width / (2 * width));
      large.metres[place_of(x, y, width)] = map.metres[place_of(u, v, map.width)];
    }
  }
  return large;
}

DepthMap upsampled_by_colour(const DepthMap& map, const Image& colour, ThreadPool& pool) {
  const std::vector<glm::vec4> colours = colours_of(map, colour, pool);
  DepthMap large{colour.width, colour.height,
                 std::vector<float>(place_of(0, colour.height, colour.width))};
  const float across = static_cast<float>(map.width) / static_cast<float>(colour.width);
  const float down = static_cast<float>(map.height) / static_cast<float>(colour.height);
  pool.for_each(colour.height, [&](int y) {
    const float v = (static_cast<float>(y) + 0.5f) * down - 0.5f;
    const int v0 = static_cast<int>(std::floor(v + 0.5f));
    for (int x = 0; x < colour.width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) * across - 0.5f;
      const int u0 = static_cast<int>(std::floor(u + 0.5f));
      if (const auto smooth = on_smooth_surface(map, u, v)) {
        large.metres[place_of(x, y, colour.width)] = *smooth;
        continue;
      }
      const glm::vec4 own = seen_colour(colour, x, y);
      std::array<Weighed, 25> all{};
      std::size_t count = 0;
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          const int j = v0 + dy, i = u0 + dx;
          if (j < 0 || i < 0 || j >= map.height || i >= map.width) continue;
          const std::size_t at = place_of(i, j, map.width);
          const float far_x = static_cast<float>(i) - u, far_y = static_cast<float>(j) - v;
          float apart = 0.0f;
          for (int c = 0; c < 3; ++c) {
            const float d = colours[at][c] - own[c];
            apart += d * d;
          }
          // Bells of rational numbers: the exponential has other bits on other machines. Colours
          // a thirtieth apart count for half.
          const float near = 1.0f / (1.0f + far_x * far_x + far_y * far_y);
          const float alike = 1.0f / (1.0f + 900.0f * apart);
          all[count++] = {map.metres[at], near * near * alike * alike};
        }
      }
      large.metres[place_of(x, y, colour.width)] = mean_near_median(all, count);
    }
  });
  return large;
}

std::size_t mend_edges(DepthMap& map, ThreadPool& pool) {
  const DepthMap from = map;
  std::vector<std::size_t> mended(static_cast<std::size_t>(map.height), 0);
  constexpr std::array<std::array<int, 2>, 4> kDirections{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  constexpr float kJump = 0.05f;         // of the nearer surface: less is no edge
  constexpr float kFlat = 0.2f;          // of the jump: a surface changes less from pixel to pixel
  constexpr float kNearSurface = 0.02f;  // of the jump: what is as near to a surface belongs to it
  pool.for_each(map.height, [&](int y) {
    for (int x = 0; x < map.width; ++x) {
      const float own = from.metres[place_of(x, y, map.width)];
      float largest_jump = 0.0f;
      for (const auto& direction : kDirections) {
        const auto at = [&](int steps) {
          const int u = std::clamp(x + steps * direction[0], 0, map.width - 1);
          const int v = std::clamp(y + steps * direction[1], 0, map.height - 1);
          return from.metres[place_of(u, v, map.width)];
        };
        for (const int reach : {1, 2}) {
          const float a = at(-reach), b = at(reach);
          const float jump = std::fabs(b - a);
          if (!(jump > kJump * std::min(a, b)) || !(jump > largest_jump)) continue;
          const bool between = own > std::min(a, b) + kNearSurface * jump &&
                               own < std::max(a, b) - kNearSurface * jump;
          const bool flat = std::fabs(at(-reach - 1) - a) <= kFlat * jump &&
                            std::fabs(at(reach + 1) - b) <= kFlat * jump;
          if (!between || !flat) continue;
          largest_jump = jump;
          map.metres[place_of(x, y, map.width)] = std::fabs(own - a) <= std::fabs(own - b) ? a : b;
        }
      }
      mended[static_cast<std::size_t>(y)] += largest_jump > 0.0f;
    }
  });
  std::size_t count = 0;
  for (const std::size_t of_row : mended) count += of_row;
  return count;
}

void mend(DepthMap& map, const Image& colour, const Mending& mending, MendedDepth& mended,
          ThreadPool& pool) {
  // Edges first: a mixture of two surfaces would grow into a surface of its own.
  if (mending.edges) mended.edge_pixels = mend_edges(map, pool);
  if (map.width == colour.width && map.height == colour.height) return;
  mended.upsampled = true;
  const bool is_smaller = map.width <= colour.width && map.height <= colour.height;
  map = mending.by_colour && is_smaller ? upsampled_by_colour(map, colour, pool)
                                        : upsampled_to_nearest(map, colour.width, colour.height);
}

}  // namespace softfocus
