// A signal leaves nothing half-written, and ends the run with the signal's status.

#include <sys/stat.h>

#include "tests/support/cli_refused.h"
#include "tests/support/frame_runs.h"
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

TEST_CASE("an interrupted chart leaves no temporary file") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("chart");
  const Words words{"chart",   "--scenes",  "figures", "--methods", "two-pass", "--size",
                    "256x256", "--samples", "8192",    "-o",        out};
  for (const int signal : {SIGINT, SIGTERM}) {
    CHECK(signal_that_ended(words, signal, soon()) == signal);
    if (!std::filesystem::exists(out)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator{out}) {
      CHECK_FALSE(entry.path().filename().string().starts_with(".softfocus-"));
    }
  }
}
