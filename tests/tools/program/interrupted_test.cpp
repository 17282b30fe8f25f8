// A signal leaves nothing half-written, and ends the run with the signal's status.

#include <sys/stat.h>

#include <array>
#include <csignal>

#include "tests/support/cli_refused.h"
#include "tests/support/frame_runs.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/image_file.h"

using namespace softfocus;

namespace {

/// After a while in which a run has begun its work, which takes minutes.
auto soon() {
  return [turns = 0]() mutable { return ++turns > 100; };
}

/// The run ends by the signal, and the directory is as before.
void check_interrupted(const TemporaryDirectory& directory, const Words& words, int signal) {
  CAPTURE(words[0]);
  CAPTURE(signal);
  const std::vector<std::string> before = directory.listing();
  CHECK(signal_that_ended(words, signal, soon()) == signal);
  CHECK(directory.listing() == before);
}

}  // namespace

TEST_CASE("an interrupted refocus leaves its old output and nothing else") {
  const TemporaryDirectory directory;
  const std::string picture = directory.file("a.npy"), out = directory.file("out.exr");
  // Its writer never ends.
  const std::string depth = directory.file("pipe");
  REQUIRE(::mkfifo(depth.c_str(), 0600) == 0);
  const int writer = ::open(depth.c_str(), O_RDWR | O_CLOEXEC);
  const Bytes bytes = encode_npy(make_image(Format::rgba16f, 8, 6));
  write_file(picture, bytes);
  write_file(out, "old");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    check_interrupted(directory, {"refocus", picture, depth, "-o", out, "--format", "png"}, signal);
    CHECK(read_file(out) == "old");
  }
  ::close(writer);
}

TEST_CASE("an interrupted accumulation leaves nothing, as a picture and as sums") {
  const TemporaryDirectory directory;
  const Words words{"render", "figures",   "--method", "accumulation", "--samples", "8192",
                    "--size", "1024x1024", "-o"};
  for (const int signal : {SIGINT, SIGTERM}) {
    check_interrupted(directory, joined(words, {directory.file("a.png")}), signal);
    check_interrupted(directory, joined(words, {directory.file("a.sum"), "--shard", "1/2"}),
                      signal);
  }
}

TEST_CASE("an interrupted sequence has whole frames alone, and goes on with the same files") {
  const TemporaryDirectory directory;
  for (const int signal : {SIGINT, SIGTERM}) {
    const Words frames{"render", "figures",   "--size", "160x120", "--frames",
                       "1..30",  "--threads", "2",      "-o"};
    const Words words = joined(frames, {directory.file("o_%02d.png")});
    const std::string second = directory.file("o_02.png");
    REQUIRE(signal_that_ended(words, signal, [&] { return std::filesystem::exists(second); }) ==
            signal);
    for (const std::string& name : directory.listing()) {
      CHECK_FALSE(name.starts_with(".softfocus-"));
      if (name.ends_with(".png")) CHECK_NOTHROW(read_image_file(directory.file(name)));
    }
    CHECK(run_program(words).status == 0);
    CHECK(run_program(joined(frames, {directory.file("w_%02d.png")})).status == 0);
    CHECK(same_files(directory.file("o_02.png"), directory.file("w_02.png")));
    CHECK(same_files(directory.file("o_30.png"), directory.file("w_30.png")));
    for (const std::string& name : directory.listing()) {
      std::filesystem::remove(directory.file(name));
    }
  }
}

namespace {

/// How many regular files stand in the folder and below it, and the bytes of all of them; with
/// those that are being written, or without.
std::uint64_t filled(const std::string& folder, bool with_temporary) {
  std::uint64_t sum = 0;
  std::error_code error;
  std::filesystem::recursive_directory_iterator at{folder, error};
  for (; !error && at != std::filesystem::recursive_directory_iterator{}; at.increment(error)) {
    const bool is_temporary = at->path().filename().string().starts_with(".softfocus-");
    if (is_temporary && !with_temporary) continue;
    const std::uintmax_t bytes = at->is_regular_file(error) ? at->file_size(error) : 0;
    sum += error ? 0 : 1 + static_cast<std::uint64_t>(bytes);
  }
  return sum;
}

void check_no_temporary_file(const std::string& folder) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator{folder}) {
    CHECK_FALSE(entry.path().filename().string().starts_with(".softfocus-"));
  }
}

/// Interrupts a run each time that it has kept more results in the folder, and every other time
/// while it writes them, with SIGINT, SIGTERM and SIGHUP in turn. The last run ends by itself.
int interrupt_each_stage(const Words& words, const std::string& folder) {
  constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
  for (std::size_t times = 0;; ++times) {
    REQUIRE(times < 200);
    const int signal = kSignals[times % kSignals.size()];
    const bool while_writing = times % 2 == 1;
    const std::uint64_t before = filled(folder, while_writing);
    const int ended_by =
        signal_that_ended(words, signal, [&] { return filled(folder, while_writing) != before; });
    if (ended_by == 0) return static_cast<int>(times);
    CHECK(ended_by == signal);
    check_no_temporary_file(folder);
  }
}

/// Interrupted at every stage, the run has the files that it has if nothing disturbs it.
void check_each_stage(const Words& words, int least_stages) {
  const TemporaryDirectory directory;
  const std::string often = directory.file("often"), once = directory.file("once");
  CHECK(interrupt_each_stage(joined(words, {"-o", often}), often) >= least_stages);
  CHECK(run_program(joined(words, {"-o", often})).status == 0);
  CHECK(run_program(joined(words, {"-o", once})).status == 0);
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator{once}) {
    if (!entry.is_regular_file()) continue;
    CAPTURE(entry.path());
    const std::filesystem::path other = std::filesystem::path{often} / entry.path().filename();
    CHECK(same_files(other.string(), entry.path().string()));
    ++compared;
  }
  CHECK(compared > 0);
}

}  // namespace

TEST_CASE("a sequence that is interrupted at each frame ends with an undisturbed one's files") {
  const TemporaryDirectory often, once, input;
  const std::string drawn = input.file("d.exr");
  const bool has_exr = missing_exr().empty();
  if (has_exr) {
    REQUIRE(
        run_program({"render", "figures", "--size", "160x120", "--show", "pinhole", "-o", drawn})
            .status == 0);
  }
  const Words frames{"--frames", "1..8", "-o"};
  for (const Words& words : {joined({"render", "figures", "--size", "160x120"}, frames),
                             joined({"refocus", drawn, "--focus", "1:1m 8:2m"}, frames)}) {
    if (words.front() == "refocus" && !has_exr) continue;
    CAPTURE(words.front());
    const std::string name = "/" + words.front() + "_%02d.png";
    CHECK(interrupt_each_stage(joined(words, {often.path() + name}), often.path()) >= 4);
    REQUIRE(run_program(joined(words, {once.path() + name})).status == 0);
    for (int frame = 1; frame <= 8; ++frame) {
      const std::string file = words.front() + "_0" + std::to_string(frame) + ".png";
      CHECK(same_files(often.file(file), once.file(file)));
    }
  }
}

TEST_CASE("a chart that is interrupted at each stage ends with an undisturbed one's files") {
  check_each_stage({"chart", "--scenes", "figures", "--methods", "two-pass,disc-layers", "--quick",
                    "--rounds", "0", "--size", "48x48", "--samples", "512"},
                   4);
}

TEST_CASE("an atlas that is interrupted at each stage ends with an undisturbed one's files") {
  check_each_stage({"stress", "--cases", "near-edge,point-light", "--methods", "two-pass,one-pass",
                    "--quick", "--size", "64"},
                   4);
}

TEST_CASE("an interrupted chart leaves no temporary file") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("chart");
  const Words words{"chart",   "--scenes",  "figures", "--methods", "two-pass", "--size",
                    "256x256", "--samples", "8192",    "-o",        out};
  for (const int signal : {SIGINT, SIGTERM}) {
    CHECK(signal_that_ended(words, signal, soon()) == signal);
    if (std::filesystem::exists(out)) check_no_temporary_file(out);
  }
}
