// The atlas's cases: the truth holds, wrong answers do not, and calculated truths are what the
// lens sees.

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>

#include "raster/images/texel.h"
#include "tools/stress/answers.h"
#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

using namespace softfocus;

namespace {

constexpr int kSize = 64;

/// A case at its telling severity, with a truth of few views.
struct Posed {
  StressCase of;
  double severity;
  StressTrial trial;
  std::vector<Image> truth;
};

Posed posed(const StressCase& of, double severity, ThreadPool& pool) {
  Posed made{of, severity, of.make(severity, kSize, pool), {}};
  made.truth = make_stress_truth(made.trial, of.views == 0 ? 0 : 32, pool).pictures;
  return made;
}

/// All cases, made once for the tests that follow.
const std::vector<Posed>& posed_cases(ThreadPool& pool) {
  static const std::vector<Posed> cases = [&] {
    std::vector<Posed> all;
    for (const StressCase& of : stress_cases()) {
      all.push_back(posed(of, shown_severity(of, severities_of(of, kSize, false)), pool));
    }
    return all;
  }();
  return cases;
}

double measured(const Posed& made, const std::vector<Image>& result, ThreadPool& pool) {
  return made.of.measure({made.trial, made.severity, made.truth, result, pool});
}

/// The truth with its last picture changed pixel by pixel.
template <class TexelAt>
std::vector<Image> with_last(const Posed& made, const TexelAt& texel_at) {
  std::vector<Image> result = made.truth;
  const Image& right = made.truth.back();
  for (int y = 0; y < right.height; ++y) {
    for (int x = 0; x < right.width; ++x) {
      store_texel<Format::rgba16f>(result.back(), x, y, texel_at(right, x, y), {});
    }
  }
  return result;
}

std::vector<Image> sharp_answer(const Posed& made) {
  std::vector<Image> result;
  for (const StressFrame& frame : made.trial.frames) result.push_back(frame.sharp);
  return result;
}

}  // namespace

TEST_CASE("stress: cases have names of their own, limits and severities that fit small pictures") {
  std::set<std::string_view> names;
  for (const StressCase& of : stress_cases()) {
    CAPTURE(std::string{of.name});
    CHECK(names.insert(of.name).second);
    CHECK(of.limit >= 0.0);
    CHECK(of.views % 16 == 0);
    CHECK(severities_of(of, kSize, false).size() >= 4);
    const std::vector<double> quick = severities_of(of, 128, true);
    CHECK(quick.size() >= 2);
    CHECK(quick.size() <= 3);
    CHECK(quick.front() == of.severities.front());
  }
  CHECK(names.size() == 59);
}

TEST_CASE("stress: circles that do not fit the picture are left out") {
  const StressCase& edge = edge_cases()[0];
  CHECK(severities_of(edge, 256, false).back() == 64);
  CHECK(severities_of(edge, 128, false).back() == 32);
  CHECK(shown_severity(edge, severities_of(edge, 64, false)) == 16);
}

TEST_CASE("stress: in every case the truth holds") {
  ThreadPool pool{2};
  for (const Posed& made : posed_cases(pool)) {
    CAPTURE(std::string{made.of.name});
    // Views have noise, which two pictures of different size do not share.
    const double close = made.of.name == "resolution" ? made.of.limit : 0.02 * made.of.limit;
    CHECK(measured(made, made.truth, pool) <= close);
  }
}

TEST_CASE("stress: in every case one of a sharp, a darker and a shifted answer does not hold") {
  ThreadPool pool{2};
  for (const Posed& made : posed_cases(pool)) {
    CAPTURE(std::string{made.of.name});
    const auto darker = with_last(made, [](const Image& right, int x, int y) {
      return load_texel<Format::rgba16f>(right, x, y) * 0.5f;
    });
    const auto shifted = with_last(made, [](const Image& right, int x, int y) {
      return load_texel<Format::rgba16f>(right, std::min(x + 5, right.width - 1), y);
    });
    const double limit = made.of.limit;
    const bool all_hold = measured(made, sharp_answer(made), pool) <= limit &&
                          measured(made, darker, pool) <= limit &&
                          measured(made, shifted, pool) <= limit;
    CHECK_FALSE(all_hold);
  }
}

TEST_CASE("stress: in every case a picture of NaN does not hold") {
  ThreadPool pool{2};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Posed& made : posed_cases(pool)) {
    CAPTURE(std::string{made.of.name});
    const auto spoilt = with_last(made, [&](const Image&, int, int) {
      return glm::vec4{nan, nan, nan, 1.0f};
    });
    const bool held = measured(made, spoilt, pool) <= made.of.limit;
    CHECK_FALSE(held);
  }
}

TEST_CASE("stress: a calculated truth is what the lens sees, where the case is a scene") {
  ThreadPool pool{2};
  int compared = 0;
  for (const Posed& made : posed_cases(pool)) {
    const auto& scene = made.trial.frames[0].scene;
    if (made.of.views > 0 || !scene || scene->shadows || scene->relief) continue;
    CAPTURE(std::string{made.of.name});
    const Image views = make_stress_truth(made.trial, 512, pool).pictures[0];
    double difference = 0.0, light = 0.0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        difference += std::fabs(light_at(views, x, y) - light_at(made.truth[0], x, y));
        light += light_at(made.truth[0], x, y);
      }
    }
    CHECK(difference < 0.07 * light);
    ++compared;
  }
  CHECK(compared == 13);
}

TEST_CASE("stress: no method is right by taking the truth's own points of the lens") {
  ThreadPool pool{2};
  const StressTrial trial = crowd_cases()[1].make(8, kSize, pool);
  const StressTruth truth = make_stress_truth(trial, kStressSamples, pool);
  const auto answer = method_pictures("accumulation", trial, pool);
  REQUIRE(answer);
  CHECK_FALSE(equal(truth.pictures[0], (*answer)[0]));
  CHECK(answer_flip(truth.pictures[0], (*answer)[0], pool) > 0.0);
  CHECK(answer_flip(truth.first_half[0], truth.second_half[0], pool) < 0.1);
}

TEST_CASE("stress: methods that draw the scene have no answer to a picture") {
  ThreadPool pool{2};
  const StressCase& point = light_cases()[0];
  const StressTrial trial = point.make(4, kSize, pool);
  CHECK_FALSE(method_pictures("accumulation", trial, pool));
  CHECK_FALSE(method_pictures("auto", trial, pool));
  const auto pinhole = method_pictures("pinhole", trial, pool);
  REQUIRE(pinhole);
  CHECK(equal((*pinhole)[0], trial.frames[0].sharp));
}

TEST_CASE("stress: only kinds of shadows answer cases of shadows, and projected ones are right") {
  ThreadPool pool{2};
  for (const Posed& made : posed_cases(pool)) {
    const auto& scene = made.trial.frames[0].scene;
    CAPTURE(std::string{made.of.name});
    const auto projected = method_pictures("projected", made.trial, pool);
    REQUIRE(projected.has_value() == (scene && scene->shadows));
    if (!projected) continue;
    CHECK(measured(made, *projected, pool) <= made.of.limit);
    CHECK_FALSE(method_pictures("pinhole", made.trial, pool));
    CHECK_FALSE(method_pictures("accumulation", made.trial, pool));
  }
}

TEST_CASE("stress: only impostors answer cases of reliefs, and are right at the mildest") {
  ThreadPool pool{2};
  for (const StressCase& of : relief_cases()) {
    CAPTURE(std::string{of.name});
    const StressTrial trial = of.make(of.severities.front(), 128, pool);
    const auto renewed = method_pictures("impostor", trial, pool);
    REQUIRE(renewed);
    const double severity = of.severities.front();
    CHECK(of.measure({trial, severity, std::span{&trial.frames[0].truth, 1}, *renewed, pool}) <
          2.0 * of.limit);
    CHECK_FALSE(method_pictures("pinhole", trial, pool));
    CHECK_FALSE(method_pictures("projected", trial, pool));
  }
  CHECK_FALSE(method_pictures("octahedral", light_cases()[0].make(4, kSize, pool), pool));
}

TEST_CASE("stress: while the shutter is closed motion blur has no answer") {
  ThreadPool pool{2};
  CHECK_FALSE(method_pictures("motion-blur", light_cases()[0].make(4, kSize, pool), pool));
  CHECK_FALSE(method_pictures("motion-blur-simple", crowd_cases()[1].make(8, kSize, pool), pool));
}

TEST_CASE("stress: while the shutter is open filters of depth of field have no answer") {
  ThreadPool pool{2};
  for (const StressCase& of : shutter_cases()) {
    CAPTURE(std::string{of.name});
    const double severity = shown_severity(of, severities_of(of, kSize, false));
    const StressTrial trial = of.make(severity, kSize, pool);
    CHECK_FALSE(method_pictures("two-pass", trial, pool));
    CHECK_FALSE(method_pictures("auto", trial, pool));
    const auto instant = method_pictures("pinhole", trial, pool);
    REQUIRE(instant);
    CHECK(equal((*instant)[0], trial.frames[0].sharp));
    const auto views = method_pictures("accumulation", trial, pool);
    REQUIRE(views);
    const Image truth = make_stress_truth(trial, of.views == 0 ? 0 : 256, pool).pictures[0];
    const double of_instant = answer_flip(truth, (*instant)[0], pool);
    CHECK(answer_flip(truth, (*views)[0], pool) < 0.2 * of_instant);
    const auto blurred = method_pictures("motion-blur", trial, pool);
    REQUIRE(blurred);
    const double of_blurred = answer_flip(truth, (*blurred)[0], pool);
    MESSAGE(of_instant << ", motion-blur " << of_blurred);
    CHECK(of_blurred < 0.7 * of_instant);
  }
}
