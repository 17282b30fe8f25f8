#include "tools/stress/trial_record.h"

#include <algorithm>

#include "dof/measure/flip.h"
#include "dof/measure/heat_map.h"
#include "raster/images/texel.h"
#include "tools/cli/option_values.h"
#include "tools/files/base64.h"
#include "tools/golden/hashes.h"
#include "tools/pictures/image_file.h"
#include "tools/report/kept_results.h"
#include "tools/report/worst_crop.h"
#include "tools/stress/answers.h"
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

/// A hash of the numbers and pictures that all cases on these pictures give for a wrong answer: it
/// differs whenever a measure or the page's pictures have changed.
std::uint64_t case_measures_hash(const StressCase& of, const StressAnswer& right) {
  std::vector<Image> wrong;
  for (const Image& picture : right.truth) wrong.push_back(with_wrong_pixels(picture));
  const StressAnswer answer{right.trial, right.severity, right.truth, wrong, right.pool};
  Hash hash;
  add_number(hash, of.measure(answer));
  for (const StressCase& other : stress_cases()) {
    if (other.name != of.name && same_trials(of, other)) add_number(hash, other.measure(answer));
  }
  const SpecimenPair pair = specimen_pair();
  const double gain = display_gain(pair.truth);
  add_number(hash, gain);
  add_text(hash, stress_picture(pair.picture, gain));
  add_text(hash, stress_error_picture(pair.truth, pair.picture, gain, right.pool));
  return hash.value;
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

std::string trial_key(const StressCase& of, double severity, const StressTrial& trial, int views,
                      ThreadPool& pool) {
  // They change with all of a scene that the sharp picture does not show.
  constexpr int kProbeViews = 16;
  std::string key = "softfocus " SOFTFOCUS_VERSION "; " + std::string{of.name} + " at " +
                    exact_number(severity) + "; views " + std::to_string(views);
  for (const StressFrame& frame : trial.frames) {
    const DofSettings& settings = frame.settings;
    key += "; size " + std::to_string(frame.sharp.height) + ", " +
           hash_text(hash_image(frame.sharp)) + ", at infinity " +
           exact_number(double{settings.coc.radius_at_infinity_px}) + " px, focus " +
           exact_number(double{settings.coc.focus_m}) + " m, max-coc " +
           exact_number(double{settings.max_coc_px}) + " px";
    if (frame.truth.width > 0) key += ", truth " + hash_text(hash_image(frame.truth));
  }
  const std::vector<Image> truth =
      make_stress_truth(trial, views == 0 ? 0 : kProbeViews, pool).pictures;
  if (views > 0) key += "; first views " + hashes_of(truth);
  return key + "; measures " +
         hash_text(case_measures_hash(of, {trial, severity, truth, {}, pool}));
}

}  // namespace softfocus
