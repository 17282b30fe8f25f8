#include "tools/chart/subject.h"

#include <algorithm>
#include <array>
#include <vector>

#include "tools/chart/contenders/bloom_truth.h"
#include "tools/chart/contenders/shadow_contenders.h"
#include "tools/chart/contenders/turn_contenders.h"
#include "tools/chart/scene.h"

namespace softfocus {
namespace {

constexpr std::string_view kAccumulationName = "accumulation";

/// An effect's name, and the value of one of its parameters.
ChosenEffect with_value(std::string_view name, std::string_view parameter, double value) {
  ChosenEffect chosen{find_effect(name), {}};
  for (const Parameter& of : chosen.effect->parameters) {
    chosen.parameters.push_back(of.name == parameter ? value : of.preset);
  }
  return chosen;
}

ChartEntry plain_entry(const std::string& method) {
  return {.method = method, .filter = find_method(method)};
}

std::vector<ChartEntry> view_entries(const std::vector<int>& counts) {
  std::vector<ChartEntry> entries;
  entries.reserve(counts.size());
  for (const int samples : counts) {
    entries.push_back({.method = std::string{kAccumulationName}, .samples = samples});
  }
  return entries;
}

// --- motion blur ---

constexpr std::array<std::string_view, 3> kMotionBlurs{"motion-blur-simple", "motion-blur-2012",
                                                       "motion-blur"};

std::vector<std::string> motion_methods() {
  std::vector<std::string> names{std::string{kPinhole}};
  names.insert(names.end(), kMotionBlurs.begin(), kMotionBlurs.end());
  names.emplace_back(kAccumulationName);
  return names;
}

std::vector<ChartEntry> motion_entries(const std::string& method, int, bool quick) {
  if (method == kPinhole) return {plain_entry(method)};
  if (method == kAccumulationName) {
    return view_entries(quick ? std::vector{4, 16} : std::vector{2, 4, 8, 16, 32, 64});
  }
  std::vector<ChartEntry> entries;
  for (const double samples : quick ? std::vector{16.0} : std::vector{8.0, 16.0, 32.0}) {
    entries.push_back({.method = method,
                       .effects = {with_value(method, "samples", samples)},
                       .setting = {"samples", samples}});
  }
  return entries;
}

// --- anti-aliasing ---

/// Samples of a pixel, the scene drawn twice as wide and high, and two blurs.
constexpr std::string_view kMultisample = "multisample";
constexpr std::string_view kSupersample = "supersample";
/// The average of so many frames from other places in the pixel.
constexpr std::string_view kTemporal = "temporal-aa";
constexpr std::array<std::string_view, 2> kBlurs{"gaussian-3", "gaussian"};

std::vector<std::string> smoothing_methods() {
  std::vector<std::string> names{std::string{kPinhole}};
  names.insert(names.end(), kBlurs.begin(), kBlurs.end());
  names.emplace_back(kMultisample);
  names.emplace_back(kSupersample);
  names.emplace_back(kTemporal);
  names.emplace_back(kAccumulationName);
  return names;
}

std::vector<ChartEntry> smoothing_entries(const std::string& method, int, bool quick) {
  if (method == kPinhole) return {plain_entry(method)};
  if (method == kMultisample) {
    std::vector<ChartEntry> entries;
    for (const int samples : {4, 8}) {
      entries.push_back({.method = method,
                         .multisample = samples,
                         .setting = {"samples", static_cast<double>(samples)}});
    }
    return entries;
  }
  if (method == kSupersample) return {{.method = method, .supersample = 2}};
  if (method == kTemporal) {
    std::vector<ChartEntry> entries;
    for (const double frames : quick ? std::vector{16.0} : std::vector{4.0, 8.0, 16.0, 32.0}) {
      entries.push_back({.method = method,
                         .effects = {with_value(method, "", 0.0)},
                         .setting = {"frames", frames}});
    }
    return entries;
  }
  if (method == "gaussian-3") {
    return {{.method = method, .effects = {with_value(method, "", 0.0)}}};
  }
  if (method == "gaussian") {
    std::vector<ChartEntry> entries;
    for (const double sigma : {0.4, 0.6}) {
      entries.push_back({.method = method,
                         .effects = {with_value(method, "sigma", sigma)},
                         .setting = {"sigma", sigma}});
    }
    return entries;
  }
  return view_entries(quick ? std::vector{4, 16} : std::vector{2, 4, 8, 16, 32});
}

// --- bloom ---

constexpr std::string_view kBloom = "bloom", kSteadyBloom = "bloom-steady",
                           kGaussianBloom = "bloom-gaussian";

Image truth_of_bloom(const ChartScene& scene, ThreadPool& pool) {
  return bloom_truth(BloomSettings{}, scene.pinhole, pool);
}

std::vector<std::string> bloom_methods() {
  return {std::string{kPinhole}, std::string{kBloom}, std::string{kSteadyBloom},
          std::string{kGaussianBloom}};
}

std::vector<ChartEntry> bloom_entries(const std::string& method, int, bool quick) {
  if (method == kPinhole) return {plain_entry(method)};
  if (method == kSteadyBloom) {
    return {{.method = method, .effects = {with_value(kBloom, "steady", 1.0)}}};
  }
  std::vector<ChartEntry> entries;
  if (method == kGaussianBloom) {
    for (const double sigma : quick ? std::vector{16.0} : std::vector{4.0, 8.0, 16.0, 32.0}) {
      entries.push_back({.method = method,
                         .effects = {with_value(kGaussianBloom, "sigma", sigma)},
                         .setting = {"sigma", sigma}});
    }
    return entries;
  }
  for (const double levels : quick ? std::vector{2.0, 6.0} : std::vector{2.0, 3.0, 4.0, 5.0, 6.0}) {
    entries.push_back({.method = method,
                       .effects = {with_value(kBloom, "levels", levels)},
                       .setting = {"levels", levels}});
  }
  return entries;
}

const std::vector<ChartSubject>& subjects() {
  static const std::vector<ChartSubject> all{
      {.name = "depth-of-field",
       .title = "Depth of field",
       .truth = "the mean of pictures from many points of the lens",
       .sample = "points of the lens",
       .methods = chart_methods,
       .entries = chart_entries},
      ChartSubject{.name = "motion-blur",
                   .title = "Motion blur",
                   .truth = "the mean of pictures at many times while the shutter is open",
                   .sample = "times",
                   .scenes = {"windmill", "crossing", "cube-room", "sphere-world"},
                   .truth_samples = 1024,
                   .quick_truth_samples = 256,
                   .through_lens = false,
                   .sampling = {.shutter_frames = 0.5},
                   .orbit_degrees_per_frame = 2.0,
                   .methods = motion_methods,
                   .entries = motion_entries},
      ChartSubject{.name = "anti-aliasing",
                   .title = "Anti-aliasing",
                   .truth = "the mean of pictures from many places in each pixel",
                   .sample = "places in the pixel",
                   .scenes = {"figures", "lattice", "near-fence", "sphere-world", "grazing-floor"},
                   .truth_samples = 1024,
                   .quick_truth_samples = 256,
                   .through_lens = false,
                   .sampling = {.jitter = true},
                   .methods = smoothing_methods,
                   .entries = smoothing_entries},
      ChartSubject{.name = "bloom",
                   .title = "Bloom",
                   .truth = "its bright light convolved with the sum of the pyramid's kernels",
                   .sample = "",
                   .scenes = {"night-lights", "bright-edges", "crossing"},
                   .truth_samples = 0,
                   .quick_truth_samples = 0,
                   .through_lens = false,
                   .truth_of = truth_of_bloom,
                   .methods = bloom_methods,
                   .entries = bloom_entries},
      ChartSubject{.name = "shadows",
                   .title = "Hard shadows",
                   .truth = "a ray from the point that each pixel shows to each light",
                   .sample = "",
                   .truth_samples = 0,
                   .quick_truth_samples = 0,
                   .through_lens = false,
                   .truth_of = truth_of_shadows,
                   .ranked = kShadowErrors,
                   .measure = "Wrong pixels are counted for each light: a pixel is wrong if no ray "
                              "from it, or from within 1/256 pixel of it, gives its answer.",
                   .methods = shadow_methods,
                   .entries = shadow_entries},
      ChartSubject{.name = "impostors",
                   .title = "Impostors",
                   .truth = "16 views of a full turn about the scene, redrawn",
                   .sample = "",
                   .scenes = {"figures", "windmill", "clutter", "lattice"},
                   .truth_samples = 0,
                   .quick_truth_samples = 0,
                   .through_lens = false,
                   .truth_of = truth_of_turn,
                   .turns = true,
                   .ranked = kTurnErrors,
                   .measure = "Of a whole turn, a frame's time is the mean, renewals included; the "
                              "pinhole redraws. The outline is wrong pixels a pixel of outline. An "
                              "atlas is drawn before the turn.",
                   .methods = turn_methods,
                   .entries = turn_entries},
  };
  return all;
}

}  // namespace

std::span<const ChartSubject> chart_subjects() { return subjects(); }

const ChartSubject* find_chart_subject(std::string_view name) {
  const auto all = chart_subjects();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const ChartSubject& of) { return of.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace softfocus
