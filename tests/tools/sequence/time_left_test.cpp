#include "tools/cli/progress.h"

#include <doctest/doctest.h>

using namespace softfocus;

namespace {

/// Work on a clock of its own.
struct Simulated {
  double now_s = 0.0;
  TimeLeft left{[this] { return now_s; }};

  void work(const std::string& kind, double units, double seconds_a_unit) {
    now_s += units * seconds_a_unit;
    left.done(kind, units);
  }
};

}  // namespace

TEST_CASE("time left: nothing is known before anything is done") {
  Simulated of;
  of.left.plan("a", 10, 1.0);
  CHECK(of.left.seconds() == 0.0);
}

TEST_CASE("time left: each kind of work goes on at its own pace, whatever was guessed") {
  Simulated of;
  of.left.plan("truth", 100, 1.0);
  of.left.plan("measure", 4, 1.0);
  of.work("truth", 100, 0.01);
  of.work("measure", 1, 2.0);
  CHECK(of.left.seconds() == doctest::Approx(3 * 2.0));
  of.work("measure", 1, 2.0);
  CHECK(of.left.seconds() == doctest::Approx(2 * 2.0));
}

TEST_CASE("time left: until a kind's first is done, its guess counts, scaled by the others'") {
  Simulated of;
  of.left.plan("truth", 100, 1.0);
  of.left.plan("measure", 4, 50.0);
  of.work("truth", 50, 0.02);
  // 50 units a guess of 1 took 1 s: 50 more take 1 s, and four of 50 take 4 s.
  CHECK(of.left.seconds() == doctest::Approx(1.0 + 4.0));
}

TEST_CASE("time left: what need not be done is taken out, and pauses count for nothing") {
  Simulated of;
  of.left.plan("truth", 10, 1.0);
  of.work("truth", 2, 1.0);
  of.left.drop("truth", 5);
  CHECK(of.left.units_left("truth") == 3.0);
  of.now_s += 100.0;
  of.left.start();
  of.work("truth", 1, 1.0);
  CHECK(of.left.seconds() == doctest::Approx(2.0));
  of.left.drop("truth", 5);
  CHECK(of.left.seconds() == 0.0);
}

TEST_CASE("time left: on a chart's work it is right within a tenth from the second scene on") {
  constexpr int kScenes = 6, kContenders = 60, kRounds = 7;
  constexpr double kSampleS = 0.008, kMeasureS = 1.3;
  const auto frame_s = [](int contender) { return 0.01 * (1 + contender % 9); };
  Simulated of;
  of.left.plan("truth", kScenes * 4096.0, 1.0);
  double all_s = kScenes * 4096.0 * kSampleS;
  for (int i = 0; i < kContenders; ++i) {
    of.left.plan("measure", kScenes, 40.0);  // a guess that is four times too small
    of.left.plan("time " + std::to_string(i), kScenes * kRounds, 6.0);
    all_s += kScenes * (kMeasureS + kRounds * frame_s(i));
  }
  for (int scene = 0; scene < kScenes; ++scene) {
    const auto check = [&] {
      if (scene > 0) CHECK(of.left.seconds() == doctest::Approx(all_s - of.now_s).epsilon(0.1));
    };
    for (int group = 0; group < 64; ++group) of.work("truth", 64, kSampleS);
    check();
    for (int i = 0; i < kContenders; ++i) of.work("measure", 1, kMeasureS);
    check();
    for (int round = 0; round < kRounds; ++round) {
      for (int i = 0; i < kContenders; ++i) of.work("time " + std::to_string(i), 1, frame_s(i));
      check();
    }
  }
  CHECK(of.left.seconds() == 0.0);
}

TEST_CASE("time left: in words it is rounded up, coarser the longer it is") {
  CHECK(time_left_text(0) == "about 5 s left");
  CHECK(time_left_text(6) == "about 10 s left");
  CHECK(time_left_text(21) == "about 30 s left");
  CHECK(time_left_text(60) == "about 60 s left");
  CHECK(time_left_text(61) == "about 2 min left");
  CHECK(time_left_text(180) == "about 3 min left");
  CHECK(time_left_text(7300) == "about 2.25 h left");
}
