#include "dof/methods/ring_bucket.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

double sat(double v) { return std::clamp(v, 0.0, 1.0); }
double mix(double a, double b, double share) { return a + share * (b - a); }
double away_from_zero(double v) { return std::copysign(std::floor(std::fabs(v) + 0.500001), v); }
double half_share(double r) { return sat((r * r - 0.25) / 3.75); }

// The header's steps, pixel by pixel, for the green of a picture of a single tile.
struct Oracle {
  DofInput input;
  int width, height;  // of half resolution

  struct Half {
    double colour, share;
    float size;  // binary32, since it is compared with the rings' borders
  };
  Half half(int hx, int hy) const {
    hx = std::clamp(hx, 0, width - 1);
    hy = std::clamp(hy, 0, height - 1);
    std::array<SplitTexel, 4> p;
    float nearest = 1e9f;
    for (int i = 0; i < 4; ++i) {
      p[static_cast<std::size_t>(i)] =
          split_texel(input, std::min(2 * hx + i % 2, input.scene.width - 1),
                      std::min(2 * hy + i / 2, input.scene.height - 1));
      nearest = std::min(nearest, p[static_cast<std::size_t>(i)].radius_px);
    }
    double sum = 0.0, count = 0.0;
    for (const SplitTexel& texel : p) {
      if (texel.radius_px - nearest > 1.0f) continue;
      sum += static_cast<double>(texel.g);
      count += 1.0;
    }
    const float size = 0.5f * std::sqrt(std::max(nearest * nearest - 4.0f, 0.0f));
    return {sum / count, nearest < 0.0f ? half_share(static_cast<double>(nearest)) : 0.0,
            std::max(size, 0.5f)};
  }

  struct Fields {
    double far, near, opacity;
  };
  Fields gather(int hx, int hy, double reach) const {
    const int rings = std::clamp(static_cast<int>(std::ceil(reach)), 1, 5);
    const double spacing = std::max(reach / rings, 1.0);
    struct Tap {
      int ring;
      double dx, dy, distance;
    };
    std::vector<Tap> taps;
    for (int ring = rings; ring >= 0; --ring) {
      const int count = std::max(8 * ring, 1);
      for (int i = 0; i < count; ++i) {
        const double angle = 2.0 * 3.14159265358979 * i / count;
        const double dx = away_from_zero(ring * spacing * std::cos(angle));
        const double dy = away_from_zero(ring * spacing * std::sin(angle));
        taps.push_back({ring, dx, dy, std::hypot(dx, dy)});
      }
    }
    const double outer = (rings + 0.5) * spacing;
    const double density = static_cast<double>(taps.size()) / (outer * outer);
    double least = 1.0;
    for (int i = 1; i <= 32; ++i) {
      const double radius = reach * i / 32.0;
      if (radius < 0.5) continue;
      double sum = 0.0;
      for (const Tap& tap : taps) sum += sat(radius - tap.distance + 0.5);
      least = std::min(least, sum / std::max(1.0, radius * radius * density));
    }
    const Half own = half(hx, hy);
    struct Bucket {
      double weight = 0.0, colour = 0.0, size = 0.0;
    } previous, near;
    for (int ring = rings; ring >= 0; --ring) {
      Bucket current;
      double hits = 0.0, count = 0.0;
      for (const Tap& tap : taps) {
        if (tap.ring != ring) continue;
        const Half p = half(hx + static_cast<int>(tap.dx), hy + static_cast<int>(tap.dy));
        const auto size = static_cast<double>(p.size);
        const double reached = sat(size - tap.distance + 0.5);
        const double light = 1.0 / std::max(1.0, size * size * density);
        near.weight += reached * light * p.share;
        near.colour += reached * light * p.share * p.colour;
        const double w = (reached + 1e-3 * own.share) * light * (1.0 - p.share);
        const bool joins = size > (ring + 0.5) * spacing;
        Bucket& bucket = joins ? previous : current;
        bucket.weight += w;
        bucket.colour += w * p.colour;
        bucket.size += w * size;
        if (!joins) hits += reached * (1.0 - p.share);
        count += 1.0;
      }
      const auto mean = [](const Bucket& b) { return b.weight > 0.0 ? b.size / b.weight : 0.0; };
      const double kept = 1.0 - hits / count * sat(mean(previous) - mean(current));
      previous = {previous.weight * kept + current.weight, previous.colour * kept + current.colour,
                  previous.size * kept + current.size};
    }
    return {previous.weight > 0.0 ? previous.colour / previous.weight : own.colour,
            near.weight > 0.0 ? near.colour / near.weight : own.colour,
            sat(near.weight / std::max(least, 0.25))};
  }
};

using Field = std::vector<double>;

double at(const Field& field, int width, int height, int x, int y) {
  return field[static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width +
                                        std::clamp(x, 0, width - 1))];
}

Field medians(const Field& field, int width, int height) {
  Field result;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::vector<double> nine;
      for (int i = 0; i < 9; ++i) {
        nine.push_back(at(field, width, height, x + i % 3 - 1, y + i / 3 - 1));
      }
      std::sort(nine.begin(), nine.end());
      result.push_back(nine[4]);
    }
  }
  return result;
}

double enlarged(const Field& field, int width, int height, int x, int y) {
  const int ox = x % 2 == 0 ? -1 : 1, oy = y % 2 == 0 ? -1 : 1;
  const auto row = [&](int hy) {
    return mix(at(field, width, height, x / 2, hy), at(field, width, height, x / 2 + ox, hy), 0.25);
  };
  return mix(row(y / 2), row(y / 2 + oy), 0.25);
}

}  // namespace

TEST_CASE("ring-bucket is what its steps say") {
  ThreadPool pool(2);
  for (const float max_coc : {3.0f, 9.0f, 16.0f}) {
    constexpr int kWidth = 31, kHeight = 28;
    const Image scene = random_scene_image(kWidth, kHeight, 1);
    const DofInput input{scene, {.coc = {14.0f, 2.0f}, .max_coc_px = max_coc}, {}};
    const Oracle oracle{input, (kWidth + 1) / 2, (kHeight + 1) / 2};
    const int width = oracle.width, height = oracle.height;
    float largest = 0.0f;
    for (int i = 0; i < width * height; ++i) {
      largest = std::max(largest, oracle.half(i % width, i / width).size);
    }
    const double reach = 0.25 * std::ceil(4.0 * static_cast<double>(largest));
    Field far, near, opacity;
    for (int i = 0; i < width * height; ++i) {
      const Oracle::Fields fields = oracle.gather(i % width, i / width, reach);
      far.push_back(fields.far);
      near.push_back(fields.near);
      opacity.push_back(fields.opacity);
    }
    for (Field* field : {&far, &near, &opacity}) *field = medians(*field, width, height);

    Image result = make_image(Format::rgba16f, kWidth, kHeight);
    ring_bucket(input, result, pool);
    double worst = 0.0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const SplitTexel own = split_texel(input, x, y);
        const auto r = static_cast<double>(own.radius_px);
        const double behind = mix(static_cast<double>(own.g), enlarged(far, width, height, x, y),
                                  r < 0.0 ? sat(-r - 2.0) : half_share(r));
        const double expected = mix(behind, enlarged(near, width, height, x, y),
                                    enlarged(opacity, width, height, x, y));
        worst =
            std::max(worst, std::fabs(static_cast<double>(load_texel(result, x, y).y) - expected));
      }
    }
    INFO("max_coc ", max_coc);
    CHECK(worst < 0x1p-10);
  }
}
