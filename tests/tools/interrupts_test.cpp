#include "tools/cli/interrupts.h"

#include <doctest/doctest.h>

#ifndef _WIN32
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>

#include "tools/files/whole_file.h"

using namespace softfocus;

namespace {

// What a child leaves in a folder of its own when a signal ends it before a commit.
void check_nothing_left(int signal) {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("softfocus-interrupts-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(signal, SIG_DFL);
    prepare_interrupts();
    WholeFile file{folder / "picture.png"};
    file.write("half of it");
    ::raise(signal);
    ::_exit(0);
  }
  int status = 0;
  CHECK(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == signal);
  CHECK(std::filesystem::is_empty(folder));
  std::filesystem::remove_all(folder);
}

}  // namespace

TEST_CASE("an interrupt ends the program as its signal does, and leaves no file behind") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    CAPTURE(signal);
    check_nothing_left(signal);
  }
}

TEST_CASE("an interrupt leaves files alone that have their name") {
  const auto file = std::filesystem::temp_directory_path() /
                    ("softfocus-interrupted-" + std::to_string(::getpid()));
  const pid_t child = ::fork();
  if (child == 0) {
    prepare_interrupts();
    WholeFile whole{file};
    whole.write("all of it");
    whole.commit();
    ::raise(SIGTERM);
    ::_exit(0);
  }
  int status = 0;
  CHECK(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  CHECK(std::filesystem::exists(file));
  std::filesystem::remove(file);
}
#endif
