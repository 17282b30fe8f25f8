// The oracle of what near things hide: disc_hidden.h's rules, pixel by pixel.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "dof/disc_layers/disc_hidden.h"
#include "dof/picture_planes.h"
#include "raster/numbers/half.h"

namespace softfocus {
namespace {

// The step by which something farther than r must lie behind it.
float step_behind(float radius_px) { return 1.0f + 0.25f * std::fabs(radius_px); }

constexpr std::size_t kWays = 4;  // left, right, up, down
constexpr int kWayX[kWays] = {-1, 1, 0, 0}, kWayY[kWays] = {0, 0, -1, 1};

using Distances = std::array<int, kWays>;  // 0: no source
using Texel = std::array<std::uint16_t, 4>;

struct HiddenPixel {
  int x, y;
  float radius_px;  // of the nearest source, but at least -1: the pixel looks for no other
  float distance;   // to it
  Texel texel;
};

// Signed radii, of hidden things where they are known, and the distances of those to their source.
struct RadiusView {
  ConstImageView scene, picture;
  const float* radii;
  const float* distances;
  std::ptrdiff_t stride;

  float radius(int x, int y) const { return radii[y * stride + x]; }
  float distance(int x, int y) const { return distances[y * stride + x]; }
};

inline Texel texel_at(const ConstImageView& image, int x, int y) {
  Texel texel;
  std::memcpy(texel.data(), image.texels + y * image.stride_bytes + 8 * std::ptrdiff_t{x},
              sizeof texel);
  return texel;
}

// Whether a pixel has been given another depth.
inline bool is_hidden(const ConstImageView& scene, const ConstImageView& picture, int x, int y) {
  return texel_at(scene, x, y)[3] != texel_at(picture, x, y)[3];
}

float finite(std::uint16_t half) {
  const float value = half_to_float(half);
  return value == value ? std::min(std::max(value, -65504.0f), 65504.0f) : 0.0f;
}

bool is_source(float radius_px, float of_radius_px) {
  return radius_px > of_radius_px + step_behind(of_radius_px);
}

// Leaves out sources that are themselves hidden, if the way by them is longer than the circle
// reaches.
void leave_out_far(const RadiusView& view, int x, int y, Distances& distances) {
  const float reach = 1.0f - view.radius(x, y);
  for (std::size_t i = 0; i < kWays; ++i) {
    const int u = x + kWayX[i] * distances[i], v = y + kWayY[i] * distances[i];
    if (distances[i] == 0 || !is_hidden(view.scene, view.picture, u, v)) continue;
    const auto here = static_cast<float>(distances[i]);
    const float beyond = view.distance(u, v);
    if (here * here + beyond * beyond > reach * reach) distances[i] = 0;
  }
}

// What a pixel hides, by its sources.
HiddenPixel blend_sources(const RadiusView& view, int x, int y, const Distances& distances) {
  std::size_t nearest = kWays;
  for (std::size_t i = 0; i < kWays; ++i) {
    if (distances[i] == 0) continue;
    if (nearest == kWays || distances[i] < distances[nearest]) nearest = i;
  }
  const auto place = [&](std::size_t i) {
    return std::array{x + kWayX[i] * distances[i], y + kWayY[i] * distances[i]};
  };
  const auto [u, v] = place(nearest);
  HiddenPixel pixel{x, y, view.radius(u, v), static_cast<float>(distances[nearest]),
                    texel_at(view.picture, u, v)};
  float weights = 0.0f;
  int sources = 0;
  std::array<float, 3> sums{};
  for (std::size_t i = 0; i < kWays; ++i) {
    if (distances[i] == 0) continue;
    const auto [px, py] = place(i);
    if (std::fabs(view.radius(px, py) - pixel.radius_px) > step_behind(pixel.radius_px)) continue;
    const float weight = 1.0f / static_cast<float>(distances[i] * distances[i]);
    const Texel from = texel_at(view.picture, px, py);
    for (std::size_t c = 0; c < 3; ++c) sums[c] += finite(from[c]) * weight;
    weights += weight;
    ++sources;
  }
  pixel.radius_px = std::max(pixel.radius_px, -1.0f);
  if (sources == 1) return pixel;
  for (std::size_t c = 0; c < 3; ++c) {
    pixel.texel[c] = float_to_half(sums[c] / weights, HalfRounding::nearest_even);
  }
  return pixel;
}

void hide(HiddenPicture& hidden, const ImageView& picture, const HiddenPixel& pixel) {
  std::copy(pixel.texel.begin(), pixel.texel.end(),
            row<std::uint16_t>(picture, pixel.y).begin() + 4 * pixel.x);
  hidden.mark(pixel.x, pixel.y);
}

ConstImageView behind_near(const ConstImageView& scene, const HiddenPicture& hidden) {
  if (hidden.empty()) return scene;
  return hidden.picture;
}

}  // namespace

HiddenPicture find_hidden_oracle(const DofInput& input) {
  const int width = input.scene.width, height = input.scene.height;
  HiddenPicture hidden = nothing_hidden(width, height);
  ImageView made;
  std::vector<float> radii,
      distance_of(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) radii.push_back(split_texel(input, x, y).radius_px);
  }
  const auto radius_at = [&](int x, int y) {
    return radii[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(x)];
  };
  const auto find_source = [&](int x, int y, std::size_t way) {
    float before = radius_at(x, y);
    for (int i = 1; static_cast<float>(i) <= 1.0f - radius_at(x, y); ++i) {
      const int u = x + i * kWayX[way], v = y + i * kWayY[way];
      if (u < 0 || u >= width || v < 0 || v >= height) return 0;
      const float radius = radius_at(u, v);
      if (is_source(radius, before)) return is_source(radius, radius_at(x, y)) ? i : 0;
      if (!(radius < -1.0f)) return 0;
      before = radius;
    }
    return 0;
  };
  for (int round = 0; round < 2; ++round) {
    const ConstImageView picture = behind_near(input.scene, hidden);
    const RadiusView view{input.scene, picture, radii.data(), distance_of.data(), width};
    std::vector<HiddenPixel> found;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (!(radius_at(x, y) < -1.0f)) continue;
        Distances distances{};
        for (std::size_t way = 0; way < kWays; ++way) distances[way] = find_source(x, y, way);
        leave_out_far(view, x, y, distances);
        if (distances == Distances{}) continue;
        found.push_back(blend_sources(view, x, y, distances));
      }
    }
    if (found.empty()) return hidden;
    if (hidden.empty()) {
      made = make_hidden_picture(hidden, width, height);
      for (int y = 0; y < height; ++y) {
        const auto from = row<std::uint16_t>(input.scene, y);
        std::copy(from.begin(), from.end(), row<std::uint16_t>(made, y).begin());
      }
    }
    for (const HiddenPixel& pixel : found) {
      hide(hidden, made, pixel);
      const auto at = static_cast<std::size_t>(pixel.y * width + pixel.x);
      radii[at] = pixel.radius_px;
      distance_of[at] = pixel.distance;
    }
  }
  return hidden;
}

}  // namespace softfocus
