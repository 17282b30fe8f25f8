#include "tools/command_line.h"
#include "tools/cli/platform.h"

int main(int argc, char** argv) {
  softfocus::prepare_process();
  return softfocus::run({argv + 1, argv + argc});
}
