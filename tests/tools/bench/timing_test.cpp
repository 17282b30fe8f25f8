#include "tools/cli/timing.h"

#include <doctest/doctest.h>

#include "tools/bench/paired_runs.h"

using namespace softfocus;

namespace {

void check_spread(const std::vector<double>& samples, const Spread& expected) {
  const Spread spread = spread_of(samples);
  CHECK(spread.median == expected.median);
  CHECK(spread.min == expected.min);
  CHECK(spread.max == expected.max);
}

// Stages that do nothing but note that they ran.
std::vector<TimedStage> noting(const std::vector<std::string>& names, std::string& ran) {
  std::vector<TimedStage> stages;
  stages.reserve(names.size());
  for (const std::string& name : names) {
    stages.push_back({name, [name, &ran] { ran += name + " "; }});
  }
  return stages;
}

}  // namespace

TEST_CASE("timing: the median of an odd number of samples is the one in the middle") {
  check_spread({7.0}, {7.0, 7.0, 7.0});
  check_spread({9.0, 1.0, 4.0}, {4.0, 1.0, 9.0});
  check_spread({5.0, 5.0, 1.0, 100.0, 2.0}, {5.0, 1.0, 100.0});
}

TEST_CASE("timing: the median of an even number of samples is the mean of the middle two") {
  check_spread({4.0, 1.0}, {2.5, 1.0, 4.0});
  check_spread({8.0, 1.0, 2.0, 4.0}, {3.0, 1.0, 8.0});
}

TEST_CASE("timing: ratios are taken pair by pair, the peer's time over ours") {
  const std::vector<double> ours{1.0, 2.0, 4.0}, peers{3.0, 3.0, 2.0};
  CHECK(pair_ratios(ours, peers) == std::vector<double>{3.0, 1.5, 0.5});
}

TEST_CASE("timing: the median of the ratios is not the ratio of the medians") {
  // A machine that slows down for one pair slows both down.
  const std::vector<double> ours{1.0, 10.0, 1.5}, peers{2.0, 20.0, 3.0};
  CHECK(spread_of(pair_ratios(ours, peers)).median == 2.0);
  CHECK(spread_of(pair_ratios(ours, peers)).max == 2.0);
}

TEST_CASE("timing: pairs take turns in who is first") {
  std::string ran;
  time_in_pairs(noting({"a", "b"}, ran), noting({"A", "B"}, ran), 3,
                [&](int pair) { ran += std::to_string(pair) + " "; });
  // Each begins with its first stage once without a clock.
  CHECK(ran == "0 a a b A A B 1 A A B a a b 2 a a b A A B ");
}

TEST_CASE("timing: each stage has a time above 0 for each pair, under its name") {
  std::string ran;
  const PairedSamples samples =
      time_in_pairs(noting({"a", "b"}, ran), noting({"A"}, ran), 10, [](int) {});
  REQUIRE(samples.ours.size() == 2);
  REQUIRE(samples.peers.size() == 1);
  CHECK(samples.ours[1].name == "b");
  CHECK(samples.peers[0].name == "A");
  for (const StageSamples& stage : {samples.ours[0], samples.ours[1], samples.peers[0]}) {
    CHECK(stage.ms.size() == 10);
    for (const double ms : stage.ms) CHECK(ms > 0.0);
  }
}

TEST_CASE("timing: without a peer ours are timed alone") {
  std::string ran;
  const PairedSamples samples = time_in_pairs(noting({"a"}, ran), {}, 3, [](int) {});
  CHECK(ran == "a a a a a a ");
  CHECK(samples.peers.empty());
}

TEST_CASE("timing: a warm-up runs every stage twice at least, in order") {
  std::string ran;
  warm_up(noting({"a", "b"}, ran));
  CHECK(ran.starts_with("a b a b "));
  CHECK(ran.ends_with("a b "));
}
