#include <fcntl.h>
#include <sys/stat.h>

#include <optional>
#include <string>
#include <string_view>

#include "tests/support/cli_render.h"
#include "tests/support/skip.h"

using namespace softfocus;

TEST_CASE("render: an NPY file is a '<f2' array of height, width and 4") {
  const std::string bytes = rendered("figures", {});
  CHECK(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
  CHECK(contains(bytes.substr(0, 128),
                 "{'descr': '<f2', 'fortran_order': False, 'shape': (32, 48, 4), }"));
  CHECK(bytes.size() == 128 + kWidth * kHeight * 8);
}

TEST_CASE("render: a PNG file is an RGB picture of 8 bits") {
  const std::string bytes = rendered("figures", {}, "a.png");
  // IHDR: width, height, depth 8, colour type 2.
  CHECK(bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  CHECK(bytes.substr(16, 10) == std::string("\0\0\0\x30\0\0\0\x20\x08\x02", 10));
}

TEST_CASE("render: a PFM file is a little-endian colour picture") {
  const std::string bytes = rendered("figures", {}, "a.pfm");
  CHECK(bytes.starts_with("PF\n48 32\n-1.0\n"));
  CHECK(bytes.size() == 14 + kWidth * kHeight * 12);
}

TEST_CASE("render: standard output gets the bytes that a file gets, a PNG if nothing is said") {
  for (const std::string format : {"png", "pfm", "npy"}) {
    const std::string file = rendered("figures", {}, ("a." + format).c_str());
    CHECK(run_program(render("figures", "-", {"--format", format})).out == file);
    if (format == "png") CHECK(run_program(render("figures", "-")).out == file);
  }
}

TEST_CASE("render: --format decides whatever the file's name says") {
  CHECK(rendered("figures", {"--format", "npy"}, "picture") == rendered("figures", {}));
  CHECK(rendered("figures", {"--format", "png"}, "a.npy") == rendered("figures", {}, "a.png"));
}

TEST_CASE("render: a file that was there is replaced and keeps its permissions") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.npy");
  write_file(file, "old");
  REQUIRE(::chmod(file.c_str(), 0640) == 0);
  CHECK(run_program(render("figures", file)).status == 0);
  CHECK(read_file(file) == rendered("figures", {}));
  CHECK(std::filesystem::status(file).permissions() == std::filesystem::perms{0640});
}

TEST_CASE("render: a new file has the permissions that the umask leaves") {
  const TemporaryDirectory directory;
  const mode_t before = ::umask(027);
  run_program(render("figures", directory.file("a.png")));
  ::umask(before);
  CHECK(std::filesystem::status(directory.file("a.png")).permissions() ==
        std::filesystem::perms{0640});
}

TEST_CASE("render: a symbolic link is written through, even to a file that is not there yet") {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory.file("deep"));
  std::filesystem::create_symlink("deep/b.npy", directory.file("a.npy"));
  for (int time = 0; time < 2; ++time) {
    CHECK(run_program(render("figures", directory.file("a.npy"))).status == 0);
    CHECK(std::filesystem::is_symlink(directory.file("a.npy")));
    CHECK(read_file(directory.file("deep/b.npy")) == rendered("figures", {}));
  }
  CHECK(directory.listing() == Words{"a.npy", "a.npy.json", "deep"});
}

TEST_CASE("render: a device is written to and stays a device") {
  CHECK(run_program(render("figures", "/dev/null", {"--format", "png"})).status == 0);
  CHECK(std::filesystem::is_character_file("/dev/null"));
}

TEST_CASE("render: a named pipe is written to and stays a pipe") {
  const TemporaryDirectory directory;
  const std::string pipe = directory.file("a.npy");
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  auto received = std::async(std::launch::async, [&] { return read_file(pipe); });
  CHECK(run_program(render("figures", pipe)).status == 0);
  CHECK(received.get() == rendered("figures", {}));
  CHECK(std::filesystem::is_fifo(pipe));
}

namespace {

/// What a run shows on a terminal; nothing if none can be made.
std::optional<std::string> shown_on_terminal(const Words& words) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0 || ::grantpt(terminal) != 0 || ::unlockpt(terminal) != 0) return std::nullopt;
  const std::string name = ::ptsname(terminal);
  CHECK(run_program(words, {.err_to = name}).status == 0);
  // A read may give a part of what was written; the last one fails, as no writer is left.
  std::string shown;
  char text[4096];
  for (ssize_t count = 0; (count = ::read(terminal, text, sizeof text)) > 0;) {
    shown.append(text, static_cast<std::size_t>(count));
  }
  ::close(terminal);
  return shown;
}

}  // namespace

TEST_CASE("a terminal shows the stage, and nothing of it is left at the end") {
  const TemporaryDirectory directory;
  const Words plain = render("figures", directory.file("a.png"));
  Words soft = plain;
  soft.insert(soft.end(), {"--shadows", "volumes", "--light-angle", "1", "--soft", "3"});
  Words frames = soft;
  frames.insert(frames.end(), {"--effect", "temporal-aa"});
  const Words turn{"relief", "turn", "figures", "--frames", "4", "--size", "32x32"};
  struct Shown {
    Words words;
    std::string_view stage;
  };
  for (const Shown& run :
       {Shown{plain, "drawing ..."}, Shown{soft, "drawing, 3 of 3 points of the lights ..."},
        Shown{frames, "drawing, 2 of 3 points of the lights ..."},
        Shown{turn, "frame 1 of 4 ..."}}) {
    CAPTURE(run.stage);
    const std::optional<std::string> shown = shown_on_terminal(run.words);
    if (!shown) return skip("terminal", "no terminal can be made");
    CHECK(contains(*shown, run.stage));
    CHECK(shown->ends_with("\r\x1b[K"));
  }
}
