#include "dof/auto/auto_method.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "dof/auto/candidates.h"

using namespace softfocus;

namespace {

const AutoLimits kNoLimits{};

// A picture with large circles everywhere, of which a part reaches over edges.
SceneTraits blurred_traits(float strength) {
  SceneTraits traits{.width = 1024, .height = 1024};
  traits.nearest_px = -20.0f;
  traits.farthest_px = 9.5f;
  traits.blurred_share = 0.8f;
  traits.blur = 0.1f * strength;
  for (std::size_t i = 0; i < traits.by_radius.size(); ++i) {
    const float got = static_cast<float>(i + 1) / static_cast<float>(traits.by_radius.size());
    traits.by_radius[i] = {(1.0f - got) * traits.blur, got * traits.blur, got * 0.02f * strength,
                           0.0f};
  }
  for (std::size_t i = 0; i < traits.ghosts.size(); ++i) {
    traits.ghosts[i] = 0.04f * strength / static_cast<float>(1u << i);
  }
  return traits;
}

AutoMethod within_error(const SceneTraits& traits, double error) {
  return auto_method(traits, {.max_error = error}, kNoLimits);
}

}  // namespace

TEST_CASE("auto: the pinhole if no circle reaches half a pixel, whatever is asked for") {
  SceneTraits traits = blurred_traits(1.0f);  // which contradict it, and do not count
  traits.nearest_px = -0.49f;
  traits.farthest_px = 0.3f;
  for (const AutoGoal& goal :
       {AutoGoal{.max_error = 0.0}, AutoGoal{.max_error = 1.0}, AutoGoal{.max_time_ms = 1e9}}) {
    const AutoMethod choice = auto_method(traits, goal, kNoLimits);
    CHECK(choice.method == "pinhole");
    CHECK(choice.meets_goal);
    CHECK(choice.reason.find("no circle reaches half a pixel") != std::string::npos);
  }
  traits.farthest_px = 0.5f;
  CHECK(auto_method(traits, {.max_error = 0.0}, kNoLimits).method != "pinhole");
}

TEST_CASE(
    "auto: a smaller error is never answered with a larger predicted one, nor with less time") {
  for (const float strength : {0.02f, 0.3f, 1.0f, 3.0f}) {
    const SceneTraits traits = blurred_traits(strength);
    AutoMethod last = within_error(traits, 1.0);
    for (const double error : {0.3, 0.1, 0.05, 0.02, 0.01, 0.005, 0.001, 0.0001, 0.0}) {
      const AutoMethod choice = within_error(traits, error);
      CAPTURE(error);
      CHECK(choice.predicted_error <= last.predicted_error);
      CHECK(choice.predicted_ms >= last.predicted_ms);
      CHECK(choice.meets_goal == (choice.predicted_error <= error));
      last = choice;
    }
  }
}

TEST_CASE("auto: more time is never answered with a larger predicted error, and is kept to") {
  const SceneTraits traits = blurred_traits(1.0f);
  AutoMethod last = auto_method(traits, {.max_time_ms = 0.0}, kNoLimits);
  CHECK(last.method == "pinhole");
  for (const double ms : {1.0, 5.0, 20.0, 80.0, 500.0, 1e4, 1e9}) {
    const AutoMethod choice = auto_method(traits, {.max_time_ms = ms}, kNoLimits);
    CAPTURE(ms);
    CHECK(choice.predicted_ms <= ms);
    CHECK(choice.predicted_error <= last.predicted_error);
    last = choice;
  }
  CHECK(last.method == "accumulation");
}

TEST_CASE(
    "auto: nothing cheaper by a twentieth than what is chosen is predicted to keep to the error") {
  const SceneTraits traits = blurred_traits(1.0f);
  const AutoMethod choice = within_error(traits, 0.03);
  REQUIRE(choice.meets_goal);
  for (const Candidate& candidate : candidates()) {
    if (1.05 * predicted_ms(candidate, traits, 0) >= choice.predicted_ms) continue;
    // This candidate is the radius before with more room.
    if (candidate.radius > 0 &&
        kFilterRadiiPx[static_cast<std::size_t>(candidate.radius - 1)] >= largest_px(traits)) {
      continue;
    }
    CAPTURE(candidate.method);
    CHECK(predicted_error(candidate, traits) > 0.03);
  }
}

TEST_CASE(
    "auto: of what takes up to a twentieth longer than the cheapest, the most accurate is taken") {
  const SceneTraits traits = blurred_traits(1.0f);
  const auto is_open = [&](const Candidate& candidate) {
    return candidate.radius <= 0 ||
           kFilterRadiiPx[static_cast<std::size_t>(candidate.radius - 1)] < largest_px(traits);
  };
  int not_the_cheapest = 0;
  for (int step = 0; step < 70; ++step) {
    const double error = 0.02 + 0.002 * step;
    double cheapest_ms = 1e9;
    for (const Candidate& candidate : candidates()) {
      if (is_open(candidate) && predicted_error(candidate, traits) <= error) {
        cheapest_ms = std::min(cheapest_ms, predicted_ms(candidate, traits, 0));
      }
    }
    const AutoMethod choice = within_error(traits, error);
    CAPTURE(error);
    for (const Candidate& candidate : candidates()) {
      if (!is_open(candidate) || predicted_ms(candidate, traits, 0) > 1.05 * cheapest_ms) continue;
      CHECK(choice.predicted_error <= predicted_error(candidate, traits));
    }
    not_the_cheapest += choice.predicted_ms > cheapest_ms ? 1 : 0;
  }
  CHECK(not_the_cheapest > 0);
}

TEST_CASE("auto: edges of either kind are predicted to cost what the table says") {
  for (const Candidate& candidate : candidates()) {
    if (candidate.radius < 0) continue;
    const SceneTraits plain = blurred_traits(1.0f);
    const auto more = [&](float RadiusTraits::*edges) {
      SceneTraits traits = plain;
      traits.by_radius[static_cast<std::size_t>(candidate.radius)].*edges += 0.5f;
      return predicted_error(candidate, traits) - predicted_error(candidate, plain);
    };
    CAPTURE(candidate.method);
    CHECK(more(&RadiusTraits::near_edges) ==
          doctest::Approx(0.5 * static_cast<double>(candidate.error.near_edges)).epsilon(1e-4));
    CHECK(more(&RadiusTraits::far_edges) ==
          doctest::Approx(0.5 * static_cast<double>(candidate.error.far_edges)).epsilon(1e-4));
  }
}

TEST_CASE("auto: no filter is given more room than the largest circle or --max-coc") {
  const SceneTraits traits = blurred_traits(1.0f);
  for (const float limit : {1.0f, 2.0f, 8.0f, 12.0f, 20.0f, 64.0f}) {
    for (const double error : {0.5, 0.1, 0.05, 0.02}) {
      const AutoMethod choice = auto_method(traits, {.max_error = error}, {limit, 0});
      CAPTURE(limit);
      CHECK(choice.radius_px <= std::min(limit, 20.0f));
    }
  }
}

TEST_CASE("auto: what cannot be reached is answered with what comes nearest") {
  const SceneTraits traits = blurred_traits(1.0f);
  const AutoMethod choice = within_error(traits, 0.0);
  CHECK_FALSE(choice.meets_goal);
  for (const Candidate& candidate : candidates()) {
    CHECK(choice.predicted_error <= predicted_error(candidate, traits));
  }
}

TEST_CASE("auto: more triangles make drawing again dearer, and filters not") {
  const SceneTraits traits = blurred_traits(1.0f);
  for (const Candidate& candidate : candidates()) {
    const double few = predicted_ms(candidate, traits, 1000);
    const double many = predicted_ms(candidate, traits, 1000000);
    CHECK((many > few) == (candidate.samples >= 0));
  }
}

TEST_CASE("auto: a choice reads as it would be asked for") {
  CHECK(setting_text({.method = "pinhole", .traits = {}}) == "pinhole");
  CHECK(setting_text({.method = "two-pass", .radius_px = 8.0f, .traits = {}}) ==
        "two-pass, radius 8");
  CHECK(setting_text({.method = "accumulation", .samples = 64, .traits = {}}) ==
        "accumulation, 64 samples");
}
