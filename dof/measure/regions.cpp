#include "dof/measure/regions.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "dof/smooth_edges.h"
#include "raster/images/texel.h"

namespace softfocus {

std::vector<std::uint8_t> coverage_of(const Image& picture, std::uint16_t background_depth) {
  std::vector<std::uint8_t> covered;
  covered.reserve(static_cast<std::size_t>(picture.width) *
                  static_cast<std::size_t>(picture.height));
  for (int y = 0; y < picture.height; ++y) {
    const std::uint16_t* texels = row<std::uint16_t>(picture, y).data();
    for (int x = 0; x < picture.width; ++x) {
      covered.push_back(texels[4 * x + 3] != background_depth ? 1 : 0);
    }
  }
  return covered;
}

OutlineError outline_error(const std::vector<std::uint8_t>& drawn,
                           const std::vector<std::uint8_t>& shown, int width, int height) {
  const auto at = [&](const std::vector<std::uint8_t>& of, int x, int y) {
    if (x < 0 || y < 0 || x >= width || y >= height) return 0;
    return static_cast<int>(of[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                               static_cast<std::size_t>(x)]);
  };
  OutlineError error;
  std::size_t outline = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int is = at(drawn, x, y), looks = at(shown, x, y);
      error.seen += static_cast<std::size_t>(is);
      if (is == 1 && (at(drawn, x - 1, y) + at(drawn, x + 1, y) + at(drawn, x, y - 1) +
                      at(drawn, x, y + 1)) < 4) {
        ++outline;
      }
      if (is == looks) continue;
      ++(is == 1 ? error.lost : error.gained);
      // The nearest pixel that is drawn as this one is shown; the outline runs half a pixel before.
      constexpr int kFarthest = 32;
      double nearest = kFarthest;
      for (int r = 1; r < kFarthest && nearest > r; ++r) {
        for (int i = -r; i <= r; ++i) {
          const std::array<std::array<int, 2>, 4> ring{
              {{x + i, y - r}, {x + i, y + r}, {x - r, y + i}, {x + r, y + i}}};
          for (const std::array<int, 2>& place : ring) {
            if (at(drawn, place[0], place[1]) != looks) continue;
            const double dx = place[0] - x, dy = place[1] - y;
            nearest = std::fmin(nearest, std::sqrt(dx * dx + dy * dy));
          }
        }
      }
      error.most_px = std::fmax(error.most_px, nearest - 0.5);
    }
  }
  if (outline > 0) {
    error.mean_px = static_cast<double>(error.lost + error.gained) / static_cast<double>(outline);
  }
  return error;
}

namespace {

using Floats = std::vector<float>;

struct Size {
  int width;
  int height;
};

std::size_t index_of(const Size& size, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
         static_cast<std::size_t>(x);
}

Floats signed_radii(const Image& scene, const PixelCoc& coc) {
  Floats radii;
  radii.reserve(static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height));
  for (int y = 0; y < scene.height; ++y) {
    const auto texels = row<std::uint16_t>(scene, y);
    for (std::size_t i = 3; i < texels.size(); i += 4) {
      const float depth = half_to_float(texels[i]);
      assert(is_depth(depth));
      // The formula would give infinity over infinity.
      radii.push_back(std::isinf(depth) ? coc.radius_at_infinity_px : coc_radius_px(coc, depth));
    }
  }
  return radii;
}

/// For the pixels beside an edge in depth, how far its blur reaches; 0 for all others.
Floats edge_reaches(const Floats& radii, const Size& size) {
  Floats reaches(radii.size(), 0.0f);
  const auto look = [&](std::size_t a, std::size_t b) {
    if (!(std::fabs(radii[a] - radii[b]) > kEdgeStepPx)) return;
    const float reach = std::max({std::fabs(radii[a]), std::fabs(radii[b]), 1.0f});
    reaches[a] = std::max(reaches[a], reach);
    reaches[b] = std::max(reaches[b], reach);
  };
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const std::size_t here = index_of(size, x, y);
      if (x + 1 < size.width) look(here, here + 1);
      if (y + 1 < size.height) look(here, index_of(size, x, y + 1));
    }
  }
  return reaches;
}

/// Calls `mark(index)` for pixels on outlines of what is in focus, some twice.
template <class Mark>
void for_each_on_edge(const Image& scene, const Floats& radii, float focus_px, const Mark& mark) {
  const Size size{scene.width, scene.height};
  const auto look = [&](int x, int y, int dx, int dy) {
    const auto inverse_depth = [&](int i) -> std::optional<float> {
      const int u = x + i * dx, v = y + i * dy;
      if (u < 0 || v < 0 || u >= size.width || v >= size.height) return {};
      return 1.0f /
             half_to_float(row<std::uint16_t>(scene, v)[4 * static_cast<std::size_t>(u) + 3]);
    };
    const auto next = inverse_depth(1);
    if (!next) return;
    const float here = *inverse_depth(0);
    if (is_one_surface(here, *next)) return;
    const std::size_t a = index_of(size, x, y), b = index_of(size, x + dx, y + dy);
    if (!(std::fabs(radii[here > *next ? a : b]) <= focus_px)) return;
    if (!is_step(inverse_depth(-1), here, *next, inverse_depth(2))) return;
    mark(a);
    mark(b);
  };
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      look(x, y, 1, 0);
      look(x, y, 0, 1);
    }
  }
}

/// The discs of all reaches, drawn as spans: each adds 1 where it begins and takes it
/// away behind its end, so that a running sum tells the pixels that any disc covers.
class Band {
 public:
  explicit Band(const Size& size)
      : size_{size}, steps_(index_of({size.width + 1, size.height}, 0, size.height), 0) {}

  void add_disc(int x, int y, float radius) {
    if (full_) return;
    // More than the diagonal covers no more; as an integer it could not be held.
    const double r =
        std::min(static_cast<double>(radius), static_cast<double>(size_.width) + size_.height);
    const double farthest_x = std::max(x, size_.width - 1 - x);
    const double farthest_y = std::max(y, size_.height - 1 - y);
    full_ = r * r >= farthest_x * farthest_x + farthest_y * farthest_y;
    const int whole = static_cast<int>(r);
    for (int row = std::max(0, y - whole); row <= std::min(size_.height - 1, y + whole); ++row) {
      const double dy = row - y;
      const int half = static_cast<int>(std::sqrt(r * r - dy * dy));
      ++steps_[index_of(wide(), std::max(0, x - half), row)];
      --steps_[index_of(wide(), std::min(size_.width - 1, x + half) + 1, row)];
    }
  }

  /// Calls `mark(x, y)` for each covered pixel.
  template <class Mark>
  void for_each(const Mark& mark) const {
    for (int y = 0; y < size_.height; ++y) {
      int discs = 0;
      for (int x = 0; x < size_.width; ++x) {
        discs += steps_[index_of(wide(), x, y)];
        if (full_ || discs > 0) mark(x, y);
      }
    }
  }

 private:
  Size wide() const { return {size_.width + 1, size_.height}; }

  Size size_;
  std::vector<std::int32_t> steps_;
  bool full_ = false;  ///< one disc covers everything, and no other needs to be drawn
};

Region region_of(float radius, float focus_px) {
  if (std::fabs(radius) <= focus_px) return Region::focus;
  return radius < 0.0f ? Region::near_field : Region::far_field;
}

}  // namespace

std::string_view region_name(Region region) {
  switch (region) {
    case Region::silhouette: return "silhouette";
    case Region::near_field: return "near";
    case Region::focus: return "focus";
    case Region::far_field: return "far";
    case Region::edge: return "edge";
  }
  return "";
}

float fitting_focus_px(const Image& scene, const PixelCoc& coc, const Image& labels) {
  const Floats radii = signed_radii(scene, coc);
  constexpr float kNone = std::numeric_limits<float>::infinity();
  float least = kNone;
  for (int y = 0; y < scene.height; ++y) {
    const auto of_row = row<std::uint8_t>(labels, y);
    for (int x = 0; x < scene.width; ++x) {
      const auto region = static_cast<Region>(of_row[static_cast<std::size_t>(x)]);
      if (region == Region::silhouette || region == Region::edge) continue;
      const std::size_t here = index_of({scene.width, scene.height}, x, y);
      least = std::min(least, std::fabs(radii[here]));
    }
  }
  return least > kFocusRadiusPx && least < kNone ? least + kFocusRadiusPx : kFocusRadiusPx;
}

Image label_regions(const Image& scene, const PixelCoc& coc, float focus_px) {
  assert(scene.format == Format::rgba16f);
  const Size size{scene.width, scene.height};
  Image labels = make_image(Format::r8, scene.width, scene.height);
  const auto label = [&](int x, int y, Region region) {
    row<std::uint8_t>(labels, y)[static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(region);
  };
  const Floats radii = signed_radii(scene, coc);
  const Floats reaches = edge_reaches(radii, size);
  Band band{size};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const std::size_t here = index_of(size, x, y);
      label(x, y, region_of(radii[here], focus_px));
      if (reaches[here] > 0.0f) band.add_disc(x, y, reaches[here]);
    }
  }
  band.for_each([&](int x, int y) { label(x, y, Region::silhouette); });
  for_each_on_edge(scene, radii, focus_px, [&](std::size_t i) {
    const auto at = static_cast<int>(i);
    label(at % size.width, at / size.width, Region::edge);
  });
  return labels;
}

std::array<RegionMean, kRegions> means_by_region(const PixelMap& map, const Image& labels) {
  assert(labels.format == Format::r8);
  assert(labels.width == map.width && labels.height == map.height);
  std::array<RegionMean, kRegions> regions{};
  for (int y = 0; y < map.height; ++y) {
    const auto values = row(map, y);
    const auto of_pixels = row<std::uint8_t>(labels, y);
    for (std::size_t x = 0; x < values.size(); ++x) {
      RegionMean& region = regions[of_pixels[x]];
      ++region.pixels;
      region.mean += values[x];
    }
  }
  for (RegionMean& region : regions) {
    region.mean = region.pixels == 0 ? std::numeric_limits<double>::quiet_NaN()
                                     : region.mean / static_cast<double>(region.pixels);
  }
  return regions;
}

}  // namespace softfocus
