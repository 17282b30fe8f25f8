#include "tools/cli/interrupts.h"

#include <doctest/doctest.h>

#ifndef _WIN32
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tools/cli/platform.h"
#include "tools/files/whole_file.h"

using namespace softfocus;

namespace {

// A signal that a child must not get before it is prepared: blocked from the fork on, by the mask
// that the child inherits.
class Blocked {
 public:
  explicit Blocked(int signal) {
    sigemptyset(&signals_);
    sigaddset(&signals_, signal);
    ::pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }
  ~Blocked() { allow(); }
  void allow() const { ::pthread_sigmask(SIG_UNBLOCK, &signals_, nullptr); }

 private:
  sigset_t signals_{};
};

// A child leaves nothing in its folder when a signal ends it before a commit.
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

TEST_CASE("an interrupt waits for the file that another thread is making, and removes it") {
  const auto file =
      std::filesystem::temp_directory_path() / ("softfocus-made-" + std::to_string(::getpid()));
  const pid_t child = ::fork();
  if (child == 0) {
    prepare_interrupts();
    std::jthread maker{[&] {
      const RemovedByInterrupt removed{file, [&] {
                                         std::ofstream{file} << "half";
                                         ::kill(::getpid(), SIGTERM);
                                         ::usleep(50'000);
                                         return true;
                                       }};
      ::pause();
    }};
    for (;;) ::pause();
  }
  int status = 0;
  CHECK(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  CHECK_FALSE(std::filesystem::exists(file));
  std::filesystem::remove(file);
}

TEST_CASE("interrupts in a row, to threads that make files, leave whole files alone") {
  const auto folder =
      std::filesystem::temp_directory_path() / ("softfocus-threads-" + std::to_string(::getpid()));
  for (int round = 0; round < 40; ++round) {
    std::filesystem::create_directory(folder);
    const Blocked interrupts{SIGINT};
    const pid_t child = ::fork();
    if (child == 0) {
      prepare_interrupts();
      interrupts.allow();
      const auto make = [&](int number) {
        for (;;) {
          WholeFile file{folder / std::to_string(number)};
          file.write("whole");
        }
      };
      const std::jthread one{make, 1}, two{make, 2}, three{make, 3};
      for (;;) ::pause();
    }
    ::usleep(2'000);
    int status = 0;
    while (::waitpid(child, &status, WNOHANG) == 0) ::kill(child, SIGINT);
    CHECK(WIFSIGNALED(status));
    CHECK(std::filesystem::is_empty(folder));
    std::filesystem::remove_all(folder);
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

TEST_CASE("what a killed process left is removed by the next that writes there, and nothing else") {
  const auto folder =
      std::filesystem::temp_directory_path() / ("softfocus-killed-" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  const auto names = [&] {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator{folder}) {
      found.push_back(entry.path().filename().string());
    }
    return found;
  };
  const pid_t child = ::fork();
  if (child == 0) {
    WholeFile file{folder / "picture.png"};
    file.write("half of it");
    ::raise(SIGKILL);
  }
  int status = 0;
  CHECK(::waitpid(child, &status, 0) == child);
  REQUIRE(names().size() == 1);
  const std::string left = names()[0];
  CHECK(left == ".softfocus-" + machine_name() + "-" + std::to_string(child) + "-0");

  const std::string number = std::to_string(child);
  const std::vector<std::string> others{
      ".softfocus-another-machine-" + number + "-0", ".softfocus-" + machine_name() + "-" + number,
      ".softfocus-" + machine_name() + "-" + number + "-0.png", ".softfocus-" + number + "-0"};
  for (const std::string& other : others) std::ofstream{folder / other} << "mine";
  WholeFile own{folder / "other.png"};
  const std::size_t all = names().size();
  check_writable(folder / "picture.png");
  CHECK(names().size() == all - 1);
  CHECK_FALSE(std::filesystem::exists(folder / left));

  // The number of a process that has ended may be another container's.
  std::ofstream{folder / left} << "half";
  {
    const int marked = ::open((folder / left).c_str(), O_WRONLY);
    mark_in_use(marked);
    check_writable(folder / "picture.png");
    CHECK(std::filesystem::exists(folder / left));
    ::close(marked);
  }
  check_writable(folder / "picture.png");
  CHECK_FALSE(std::filesystem::exists(folder / left));
  own.write("all");
  own.commit();
  CHECK(std::filesystem::exists(folder / "other.png"));
  std::filesystem::remove_all(folder);
}
#endif
