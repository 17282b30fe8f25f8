#include "tools/gl/driver_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>

#include "tools/gl/driver.h"

namespace softfocus {
namespace {

constexpr char kError = '!';  // begins the line that says what went wrong
constexpr char kLine = '.';

void write_all(int pipe, std::string text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::write(pipe, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR) ::_exit(1);
    if (count > 0) done += static_cast<std::size_t>(count);
  }
}

[[noreturn]] void run_child(int pipe, const std::function<void(const SendLine&)>& work) {
  try {
    work([pipe](const std::string& line) { write_all(pipe, kLine + line + '\n'); });
  } catch (const std::exception& error) {
    write_all(pipe, kError + std::string(error.what()) + '\n');
  }
  // Nothing of the parent's is flushed or torn down twice.
  ::_exit(0);
}

}  // namespace

std::string run_driver_process(const std::function<void(const SendLine&)>& work,
                               const std::function<void(const std::string&)>& receive) {
  int pipe[2];
  if (::pipe(pipe) != 0) throw DriverError(std::string("no pipe: ") + std::strerror(errno));
  std::cout.flush();
  const pid_t child = ::fork();
  if (child < 0) throw DriverError(std::string("no process: ") + std::strerror(errno));
  if (child == 0) {
    ::close(pipe[0]);
    run_child(pipe[1], work);
  }
  ::close(pipe[1]);

  std::string error;
  std::string line;
  std::FILE* from = ::fdopen(pipe[0], "r");
  for (int c; (c = std::getc(from)) != EOF;) {
    if (c != '\n') {
      line += static_cast<char>(c);
      continue;
    }
    if (line.front() == kError) {
      error = line.substr(1);
    } else {
      receive(line.substr(1));
    }
    line.clear();
  }
  std::fclose(from);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status)) {
    error = std::string("the driver's process ended with signal ") +
            std::to_string(WTERMSIG(status)) + " (" + ::strsignal(WTERMSIG(status)) + ')';
  } else if (status != 0) {
    error = "the driver's process ended with status " + std::to_string(WEXITSTATUS(status));
  }
  return error;
}

}  // namespace softfocus
