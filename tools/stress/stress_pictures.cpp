#include "tools/stress/stress_pictures.h"

#include <algorithm>

#include "dof/measure/flip.h"
#include "dof/measure/heat_map.h"
#include "raster/images/texel.h"
#include "tools/files/base64.h"
#include "tools/pictures/image_file.h"
#include "tools/report/worst_crop.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

/// The side of the pictures in the page, at most.
constexpr int kStressPagePx = 128;

Image brightened(const Image& picture, double gain) {
  Image bright = make_image(Format::rgba16f, picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      glm::vec4 texel = load_texel<Format::rgba16f>(picture, x, y);
      for (int c = 0; c < 3; ++c) texel[c] *= static_cast<float>(gain);
      store_texel<Format::rgba16f>(bright, x, y, texel, {});
    }
  }
  return bright;
}

int stress_factor(const Image& picture) {
  return reduction_factor(picture.width, picture.height, kStressPagePx);
}

}  // namespace

double display_gain(const Image& truth) {
  constexpr double kEnough = 0.4, kWanted = 0.8;
  double brightest = 0.0;
  for (int y = 0; y < truth.height; ++y) {
    for (int x = 0; x < truth.width; ++x) brightest = std::max(brightest, light_at(truth, x, y));
  }
  return brightest > 0.0 && brightest < kEnough ? kWanted / brightest : 1.0;
}

std::string stress_picture(const Image& picture, double gain) {
  return base64(encode_png(reduced(brightened(picture, gain), stress_factor(picture))));
}

std::string stress_error_picture(const Image& truth, const Image& result, double gain,
                                 ThreadPool& pool) {
  const PixelMap flip =
      flip_map(brightened(truth, gain), brightened(result, gain), clamped_tone(), pool);
  return base64(encode_png(heat_picture(reduced(flip, stress_factor(truth)))));
}

}  // namespace softfocus
