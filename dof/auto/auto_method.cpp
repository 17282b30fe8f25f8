#include "dof/auto/auto_method.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <vector>

#include "dof/auto/candidates.h"
#include "dof/dof.h"

namespace softfocus {
namespace {

constexpr float kSharpBelow = 0.5f;

/// Times within this factor count as equal: the prediction is no better.
constexpr double kAsFast = 1.05;

std::string percent_text(double share) {
  const double percent = 100.0 * share;
  return percent > 0.0 && percent < 1.0 ? "less than 1 %"
                                        : std::to_string(std::lround(percent)) + " %";
}

AutoMethod with_predictions(const Candidate& candidate, const SceneTraits& traits,
                            const AutoLimits& limits) {
  AutoMethod choice{.method = candidate.method, .traits = traits};
  choice.candidate = static_cast<std::size_t>(&candidate - limits.table.data());
  if (candidate.radius >= 0) {
    // No filter does otherwise with a radius that no circle reaches.
    choice.radius_px = std::min(kFilterRadiiPx[static_cast<std::size_t>(candidate.radius)],
                                std::ceil(largest_px(traits)));
  }
  if (candidate.samples >= 0) {
    choice.samples = kSampleCounts[static_cast<std::size_t>(candidate.samples)];
  }
  choice.predicted_error = predicted_error(candidate, traits);
  choice.predicted_ms = predicted_ms(candidate, traits, limits.triangles);
  return choice;
}

// Whether the candidate may be taken, and is not another one with more room.
bool is_open(const Candidate& candidate, const AutoMethod& choice, const SceneTraits& traits,
             const AutoLimits& limits) {
  if (candidate.radius < 0) return true;
  if (limits.max_radius_px && choice.radius_px > *limits.max_radius_px) return false;
  return candidate.radius == 0 ||
         kFilterRadiiPx[static_cast<std::size_t>(candidate.radius - 1)] < largest_px(traits);
}

std::string blur_text(const SceneTraits& traits) {
  return percent_text(static_cast<double>(traits.blurred_share)) +
         " of the picture is out of focus, with circles of up to " +
         number_text(static_cast<double>(largest_px(traits))) + " pixels";
}

std::string off_by(const AutoMethod& other) {
  return setting_text(other) + " is predicted to be off by " + number_text(other.predicted_error);
}

// The most accurate of those that are cheaper.
const AutoMethod* best_below(const std::vector<AutoMethod>& choices, double ms) {
  const AutoMethod* best = nullptr;
  for (const AutoMethod& choice : choices) {
    if (choice.predicted_ms >= ms) continue;
    if (best == nullptr || choice.predicted_error < best->predicted_error) best = &choice;
  }
  return best;
}

const AutoMethod* best_within(const std::vector<AutoMethod>& choices, double ms) {
  const AutoMethod* best = nullptr;
  for (const AutoMethod& choice : choices) {
    if (choice.predicted_ms > ms) continue;
    if (best == nullptr || choice.predicted_error < best->predicted_error) best = &choice;
  }
  return best;
}

AutoMethod cheapest_within(const std::vector<AutoMethod>& choices, double max_error) {
  const AutoMethod* found = nullptr;
  const AutoMethod* nearest = &choices.front();
  for (const AutoMethod& choice : choices) {
    if (choice.predicted_error < nearest->predicted_error) nearest = &choice;
    if (choice.predicted_error > max_error) continue;
    if (found == nullptr || choice.predicted_ms < found->predicted_ms) found = &choice;
  }
  const AutoMethod& cheapest = found != nullptr ? *found : *nearest;
  const AutoMethod* const as_fast = best_within(choices, kAsFast * cheapest.predicted_ms);
  assert(as_fast != nullptr);  // the cheapest is among them
  AutoMethod chosen = found != nullptr ? *as_fast : *nearest;
  chosen.meets_goal = found != nullptr;
  chosen.reason = blur_text(chosen.traits);
  if (const AutoMethod* cheaper = best_below(choices, cheapest.predicted_ms)) {
    chosen.reason += "; of all that is cheaper, " + off_by(*cheaper);
  } else {
    chosen.reason += ", which is hardly seen; nothing is cheaper";
  }
  return chosen;
}

AutoMethod most_accurate_within(const std::vector<AutoMethod>& choices, double max_time_ms) {
  const AutoMethod* found = best_within(choices, max_time_ms);
  if (found == nullptr) found = &choices.front();  // the pinhole's, which takes no time
  const AutoMethod* next = nullptr;
  for (const AutoMethod& choice : choices) {
    if (choice.predicted_ms <= max_time_ms) continue;
    if (next == nullptr || choice.predicted_ms < next->predicted_ms) next = &choice;
  }
  AutoMethod chosen = *found;
  chosen.reason = blur_text(chosen.traits) + "; nothing as fast is predicted to be more accurate";
  if (next != nullptr) {
    chosen.reason +=
        ", and " + setting_text(*next) + " would take " + number_text(next->predicted_ms) + " ms";
  }
  return chosen;
}

}  // namespace

std::vector<AutoMethod> open_choices(const SceneTraits& traits, const AutoLimits& limits) {
  std::vector<AutoMethod> choices;
  for (const Candidate& candidate : limits.table) {
    AutoMethod choice = with_predictions(candidate, traits, limits);
    if (is_open(candidate, choice, traits, limits)) choices.push_back(std::move(choice));
  }
  return choices;
}

AutoMethod auto_method(const SceneTraits& traits, const AutoGoal& goal, const AutoLimits& limits) {
  const std::vector<AutoMethod> choices = open_choices(traits, limits);
  if (largest_px(traits) < kSharpBelow) {
    AutoMethod sharp = choices.front();
    sharp.predicted_error = 0.0;
    sharp.reason = "no circle reaches half a pixel: the largest radius is " +
                   number_text(static_cast<double>(largest_px(traits)));
    return sharp;
  }
  return goal.max_time_ms ? most_accurate_within(choices, *goal.max_time_ms)
                          : cheapest_within(choices, goal.max_error);
}

AutoMethod auto_filter(const ConstImageView& picture, const PixelCoc& coc, const AutoGoal& goal,
                       std::optional<float> max_radius_px, ThreadPool& pool) {
  std::vector<Candidate> filters;
  for (const Candidate& candidate : candidates()) {
    if (find_method(candidate.method) != nullptr) filters.push_back(candidate);
  }
  return auto_method(scene_traits(picture, coc, pool), goal,
                     {.max_radius_px = max_radius_px, .table = filters});
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

bool is_sharp(const AutoMethod& choice) { return choice.method == "pinhole"; }

std::string setting_text(const AutoMethod& choice) {
  std::string text{choice.method};
  if (choice.samples > 0) text += ", " + std::to_string(choice.samples) + " samples";
  if (choice.radius_px > 0.0f) {
    text += ", radius " + number_text(static_cast<double>(choice.radius_px));
  }
  return text;
}

}  // namespace softfocus
