#include "tools/info/shadow_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "scenes/draw/light_points.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/shadows/maps/map_errors.h"
#include "scenes/shadows/shadow_truth.h"
#include "tools/cli/timing.h"

namespace softfocus {
namespace {

// The frames of a light's points, one after the other, with hard shadows.
struct PointFrames : RepeatedShadows {
  PointFrames(const ShadowMeasure& measure, ThreadPool& with)
      : RepeatedShadows(measure.scene, measure, with), whole(measure.scene.lights) {
    scene.light_points = 1;
    draw_point(0);
  }

  void draw_point(int point) {
    scene.lights = lights_at_point(whole, static_cast<std::uint32_t>(point));
    draw();
  }

  std::vector<Light> whole;
};

// Counts of points that do not reach a pixel: of each soft light, pixel after pixel.
using DarkCounts = std::vector<std::vector<std::uint16_t>>;

// The numbers of SceneShadows::lights that are soft.
std::vector<std::size_t> soft_numbers(const PointFrames& frames) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < frames.shadows().lights.size(); ++i) {
    if (is_soft(frames.whole[frames.shadows().lights[i]])) numbers.push_back(i);
  }
  return numbers;
}

constexpr int kPointsOfTruth = 1024;

DarkCounts counts_by_rays(const PointFrames& frames, const std::vector<std::size_t>& soft) {
  const SceneShadows& shadows = frames.shadows();
  const std::vector<SeenFacet>& seen = shadows.seen[0];
  const ShadowView view = frames.view();
  DarkCounts counts(soft.size(), std::vector<std::uint16_t>(seen.size()));
  for (int point = kPointsOfTruth; point < 2 * kPointsOfTruth; ++point) {
    const std::vector<Light> lights =
        lights_at_point(frames.whole, static_cast<std::uint32_t>(point));
    for (std::size_t i = 0; i < soft.size(); ++i) {
      const ShadowLight light = shadow_light(lights[shadows.lights[soft[i]]]);
      const ShadowTruth truth{shadows.facets, light, view, frames.camera.eye, true};
      const std::vector<std::uint8_t> dark =
          dark_pixels(truth, seen, view.width, view.height, frames.pool);
      for (std::size_t p = 0; p < dark.size(); ++p) {
        counts[i][p] = static_cast<std::uint16_t>(counts[i][p] + dark[p]);
      }
    }
  }
  return counts;
}

struct ShareErrors {
  double rms = 0.0;           // of pixels times lights that are seen
  double penumbra_rms = 0.0;  // of those that the truth has partly in shadow
  double largest = 0.0;
  std::size_t penumbra = 0;
};

ShareErrors share_errors(const DarkCounts& counts, int points, const DarkCounts& truth,
                         std::span<const SeenFacet> seen) {
  ShareErrors errors;
  double sum = 0.0, penumbra_sum = 0.0;
  std::size_t all = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    for (std::size_t p = 0; p < seen.size(); ++p) {
      if (!shows_facet(seen[p])) continue;
      const double error = std::fabs(static_cast<double>(counts[i][p]) / points -
                                     static_cast<double>(truth[i][p]) / kPointsOfTruth);
      ++all;
      sum += error * error;
      errors.largest = std::max(errors.largest, error);
      if (truth[i][p] == 0 || truth[i][p] == kPointsOfTruth) continue;
      ++errors.penumbra;
      penumbra_sum += error * error;
    }
  }
  errors.rms = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(all, 1)));
  errors.penumbra_rms =
      std::sqrt(penumbra_sum / static_cast<double>(std::max<std::size_t>(errors.penumbra, 1)));
  return errors;
}

}  // namespace

void measure_soft(const ShadowMeasure& measure, bool check, Findings& found, ThreadPool& pool) {
  const int points = measure.scene.light_points;
  PreparedScene soft = prepare_scene(measure.scene, Profile{}, pool);
  PointFrames frames{measure, pool};
  Image picture = frames.picture;
  std::vector<Milliseconds> times{{"frame, " + count_text(points, "point")},
                                  {"frame, hard shadows kept"}};
  time_in_turn(
      times, measure.runs, [&] { draw_scene(soft, frames.camera, measure.frame, picture, pool); },
      [&] { frames.draw_point(0); });
  found.add_times(times);
  if (!check) return;
  const SceneShadows& shadows = frames.shadows();
  ShadowErrors sum;
  for (int point = 0; point < points; ++point) {
    frames.draw_point(point);
    std::vector<ShadowLight> lights;
    for (const std::size_t number : shadows.lights) {
      lights.push_back(shadow_light(frames.scene.lights[number]));
    }
    const ShadowErrors errors =
        shadow_errors(shadows.facets, lights, shadows.seen[0], shadows.masks[0], frames.view(),
                      frames.camera.eye, true, pool);
    sum.seen += errors.seen;
    sum.in_shadow += errors.in_shadow;
    sum.near_edge += errors.near_edge;
    sum.wrong += errors.wrong;
  }
  add_shadow_errors(sum, found);
}

void find_soft_table(const ShadowMeasure& measure, Findings& found, ThreadPool& pool) {
  PointFrames frames{measure, pool};
  const std::vector<std::size_t> soft = soft_numbers(frames);
  DarkCounts truth;
  const double truth_ms = milliseconds_of([&] { truth = counts_by_rays(frames, soft); });
  found.add({{"scene", measure.scene.name},
             {"points_by_rays", kPointsOfTruth},
             {"rays_seconds", truth_ms / 1e3}});
  found.begin_table("points", {{"points", 8},
                               {"rms", 12, 5},
                               {"penumbra_rms", 14, 5},
                               {"largest", 12, 3},
                               {"ms", 10},
                               {"penumbra", 12}});
  const std::size_t pixels = frames.shadows().seen[0].size();
  DarkCounts counts(soft.size(), std::vector<std::uint16_t>(pixels));
  double all_ms = 0.0;
  int drawn = 0;
  for (const int points : {1, 4, 16, 64, 256, 1024}) {
    for (; drawn < points; ++drawn) {
      all_ms += milliseconds_of([&] { frames.draw_point(drawn); });
      const std::vector<std::uint8_t>& mask = frames.shadows().masks[0];
      for (std::size_t i = 0; i < soft.size(); ++i) {
        for (std::size_t p = 0; p < pixels; ++p) {
          counts[i][p] = static_cast<std::uint16_t>(counts[i][p] + (mask[p] >> soft[i] & 1));
        }
      }
    }
    const ShareErrors errors = share_errors(counts, points, truth, frames.shadows().seen[0]);
    found.add_row({{"points", points},
                   {"rms", errors.rms},
                   {"penumbra_rms", errors.penumbra_rms},
                   {"largest", errors.largest},
                   {"ms", all_ms},
                   {"penumbra", errors.penumbra}});
  }
}

}  // namespace softfocus
