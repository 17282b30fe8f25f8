#include <csignal>

#include "tools/command_line.h"

int main(int argc, char** argv) {
  // A closed pipe and a file-size limit are then errors of the write that meets
  // them, reported like any other, and not the silent end of the program.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  return softfocus::run({argv + 1, argv + argc});
}
