#include "tools/gl/driver/driver_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>

#include "scenes/files/scene_error.h"

namespace softfocus {
namespace {

constexpr char kError = '!';  // begins the line that says what went wrong
constexpr char kLine = '.';

void send_line(int pipe, char kind, const std::string& line) {
  const std::string text = kind + printable(line) + '\n';
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::write(pipe, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR) ::_exit(1);
    if (count > 0) done += static_cast<std::size_t>(count);
  }
}

[[noreturn]] void run_child(int pipe, const std::function<void(const SendLine&)>& work) {
  try {
    work([pipe](const std::string& line) { send_line(pipe, kLine, line); });
  } catch (const std::exception& error) {
    send_line(pipe, kError, error.what());
  }
  // Nothing of the parent's is flushed or torn down twice.
  ::_exit(0);
}

// The child and the end of the pipe that it writes to.
struct Child {
  pid_t process;
  std::FILE* lines;

  ~Child() {
    if (lines == nullptr) return;  // it was waited for
    ::kill(process, SIGKILL);
    wait();
  }

  /// How it ended, in words; empty if well.
  std::string wait() {
    std::fclose(lines);
    lines = nullptr;
    int status = 0;
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status)) {
      return "its process ended with signal " + std::to_string(WTERMSIG(status)) + " (" +
             ::strsignal(WTERMSIG(status)) + ')';
    }
    if (status == 0) return "";
    return "its process ended with status " + std::to_string(WEXITSTATUS(status));
  }
};

}  // namespace

std::string run_driver_process(const std::function<void(const SendLine&)>& work,
                               const std::function<void(const std::string&)>& receive) {
  std::cout.flush();
  int pipe[2];
  if (::pipe(pipe) != 0) return std::string("no pipe to its process: ") + std::strerror(errno);
  const pid_t process = ::fork();
  if (process == 0) {
    ::close(pipe[0]);
    run_child(pipe[1], work);
  }
  ::close(pipe[1]);
  if (process < 0) {
    ::close(pipe[0]);
    return std::string("no process for it: ") + std::strerror(errno);
  }

  Child child{process, ::fdopen(pipe[0], "r")};
  std::string error;
  std::string line;
  for (int c; (c = std::getc(child.lines)) != EOF;) {
    if (c != '\n') {
      line += static_cast<char>(c);
      continue;
    }
    if (line.starts_with(kError)) error = line.substr(1);
    if (line.starts_with(kLine)) receive(line.substr(1));
    line.clear();
  }
  const std::string ending = child.wait();
  return ending.empty() ? error : ending;
}

}  // namespace softfocus
