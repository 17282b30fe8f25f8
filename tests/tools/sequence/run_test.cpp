#include <doctest/doctest.h>

#include <atomic>
#include <iostream>
#include <mutex>
#include <set>
#include <sstream>

#include "tests/support/run_program.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/sequence/run_frames.h"

using namespace softfocus;

namespace {

/// Collects a run's lines on standard error.
class Said {
 public:
  Said() : before_(std::cerr.rdbuf(text_.rdbuf())) {}
  ~Said() { std::cerr.rdbuf(before_); }
  Said(const Said&) = delete;
  Said& operator=(const Said&) = delete;
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::streambuf* before_;
};

std::vector<FrameWork> works(const TemporaryDirectory& directory, int count) {
  std::vector<FrameWork> frames;
  for (int i = 0; i < count; ++i) {
    const std::string name = directory.file("f_" + std::to_string(i));
    frames.push_back({.number = i, .file = name, .settings = 1, .outputs = {name}});
  }
  return frames;
}

FrameRunOptions run_of(const TemporaryDirectory& directory, int threads, int at_once) {
  return {.output = directory.file("f_%d"),
          .shard = {},
          .pool = {.threads = threads},
          .at_once = at_once};
}

}  // namespace

TEST_CASE("a run makes each frame once, with its share of the threads, and the bad ones not" *
          doctest::test_suite("threads")) {
  const TemporaryDirectory directory;
  const auto frames = works(directory, 60);
  std::mutex mutex;
  std::multiset<std::size_t> made;
  std::multiset<int> shares;
  const auto make = [&](std::size_t frame, FrameRun& run) {
    if (frame % 20 == 7) throw FileError("bad");
    std::atomic<int> sum{0};
    run.pool.for_each(10, [&](int i) { sum += i; });
    CHECK(sum == 45);
    write_file(frames[frame].outputs[0].string(), std::to_string(frame));
    const std::lock_guard lock(mutex);
    made.insert(frame);
    shares.insert(run.pool.threads());
  };
  {
    const Said said;
    CHECK(run_frames(frames, run_of(directory, 8, 3), make) == kFailed);
    CHECK(said.text().ends_with("softfocus: 60 frames: 57 made, 3 failed (7, 27, 47)\n"));
    CHECK(contains(said.text(), "softfocus: frame 27, '" + frames[27].file + "': bad\n"));
  }
  CHECK(made.size() == 57);
  CHECK(std::set<std::size_t>(made.begin(), made.end()).size() == 57);
  for (const int share : shares) CHECK((share == 2 || share == 3));
  made.clear();
  const Said said;
  CHECK(run_frames(frames, run_of(directory, 8, 3), make) == kFailed);
  CHECK(made.empty());
  CHECK(said.text().starts_with("softfocus: 57 of 60 frames are there\n"));
}

TEST_CASE("frames that cannot be written end a run if three come in a row, others do not") {
  const TemporaryDirectory directory;
  const auto frames = works(directory, 20);
  const auto run_with = [&](auto fails) {
    const Said said;
    FrameRunOptions options = run_of(directory, 1, 1);
    options.again = true;
    CHECK(run_frames(frames, options, [&](std::size_t frame, FrameRun&) { fails(frame); }) ==
          kFailed);
    return said.text();
  };
  CHECK(run_with([](std::size_t frame) {
          if (frame % 3 != 2) throw WriteError("no room");
        }).ends_with("6 made, 14 failed (0, 1, 3, 4, 6 and 9 more)\n"));
  CHECK(run_with([](std::size_t frame) {
          if (frame > 9) throw WriteError("no room");
        }).ends_with("10 made, 3 failed (10, 11, 12), 7 left\n"));
  CHECK(run_with([](std::size_t) {
          throw FileError("bad");
        }).ends_with("0 made, 20 failed (0, 1, 2, 3, 4 and 15 more)\n"));
  CHECK(run_with([](std::size_t) {
          throw std::bad_alloc{};
        }).ends_with("0 made, 20 failed (0, 1, 2, 3, 4 and 15 more)\n"));
}

TEST_CASE("warnings are said with their frame, three of them, and all with -v") {
  const TemporaryDirectory directory;
  const auto frames = works(directory, 5);
  const auto lines_with = [&](bool verbose) {
    const Said said;
    FrameRunOptions options = run_of(directory, 1, 1);
    options.again = true;
    options.verbose = verbose;
    CHECK(run_frames(frames, options, [](std::size_t, FrameRun& run) {
            run.warnings.emplace_back("so so");
            run.report = "the report\n";
          }) == kDone);
    const std::string text = said.text();
    CHECK(contains(text, "softfocus: warning: frame 2: so so\n"));
    CHECK(contains(text, "softfocus: warning: 2 more; -v lists them\n") == !verbose);
    CHECK(contains(text, "frame 4\nthe report\n") == verbose);
    return std::count(text.begin(), text.end(), '\n');
  };
  CHECK(lines_with(false) == 3 + 1 + 1);
  CHECK(lines_with(true) == 5 + 2 * 5 + 1);
}
