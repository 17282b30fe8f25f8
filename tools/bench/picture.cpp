#include "tools/bench/picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/exact_math.h"
#include "raster/numbers/random_bits.h"

namespace softfocus {
namespace {

constexpr int kDiscs = 48;
constexpr double kMostBlur = 1.2;  // as a part of the filter's largest radius

// The depth whose signed circle is `blur` times the filter's largest:
// blur = horizon (z - focus) / z, solved for z.
float depth_of_blur(double blur) {
  return static_cast<float>(kBenchPictureFocusM / (1.0 - blur / kBenchPictureHorizon));
}

void store(Image& image, int x, int y, float depth_m, const std::vector<double>& wave_x,
           const std::vector<double>& wave_y) {
  const auto place = static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint64_t>(x);
  const std::uint64_t noise = mix_bits(place);
  glm::vec4 texel{0.0f, 0.0f, 0.0f, depth_m};
  for (int i = 0; i < 3; ++i) {
    const double smooth = 0.4 + 0.2 * wave_x[static_cast<std::size_t>(x + i * image.width)] +
                          0.2 * wave_y[static_cast<std::size_t>(y + i * image.height)];
    const double rough = 0.4 * unit_interval(mix_bits(noise + static_cast<std::uint64_t>(i)));
    texel[i] = static_cast<float>(smooth + rough);
  }
  store_texel<Format::rgba16f>(image, x, y, texel, {});
}

// Three sines along a side, one after the other, of 2, 3 and 5 periods.
std::vector<double> waves(int length) {
  std::vector<double> values;
  for (const int periods : {2, 3, 5}) {
    for (int i = 0; i < length; ++i) {
      values.push_back(exact_math::sin_degrees(360.0 * periods * (i + 0.5) / length));
    }
  }
  return values;
}

struct Disc {
  double x;
  double y;
  double radius;
  float depth_m;
};

// Sizes and places in pixels, by the shorter side.
Disc random_disc(const Image& image, RandomSequence& random) {
  Disc disc{};
  disc.x = next_between(random, 0.0, image.width);
  disc.y = next_between(random, 0.0, image.height);
  disc.radius = next_between(random, 0.01, 0.12) * std::min(image.width, image.height);
  disc.depth_m = depth_of_blur(next_between(random, -kMostBlur, kMostBlur));
  return disc;
}

int first_pixel(double edge) { return std::max(static_cast<int>(std::floor(edge)), 0); }

}  // namespace

Image bench_picture(int width, int height) {
  Image image = make_image(Format::rgba16f, width, height);
  const std::vector<double> wave_x = waves(width), wave_y = waves(height);
  for (int y = 0; y < height; ++y) {
    const double down = (y + 0.5) / height;
    const float depth_m = depth_of_blur(kMostBlur - 1.5 * kMostBlur * down);
    for (int x = 0; x < width; ++x) store(image, x, y, depth_m, wave_x, wave_y);
  }
  RandomSequence random{48};
  for (int i = 0; i < kDiscs; ++i) {
    const Disc disc = random_disc(image, random);
    for (int y = first_pixel(disc.y - disc.radius);
         y < std::min(height, static_cast<int>(disc.y + disc.radius) + 1); ++y) {
      for (int x = first_pixel(disc.x - disc.radius);
           x < std::min(width, static_cast<int>(disc.x + disc.radius) + 1); ++x) {
        const double dx = x + 0.5 - disc.x, dy = y + 0.5 - disc.y;
        if (dx * dx + dy * dy < disc.radius * disc.radius) {
          store(image, x, y, disc.depth_m, wave_x, wave_y);
        }
      }
    }
  }
  return image;
}

}  // namespace softfocus
