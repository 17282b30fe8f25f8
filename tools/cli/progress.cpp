#include "tools/cli/progress.h"

#include <iostream>

#include "tools/cli/platform.h"

namespace softfocus {
namespace {

constexpr std::string_view kEraseLine = "\r\x1b[K";

}  // namespace

Progress::Progress(bool quiet) : on_terminal_(!quiet && is_terminal(kStandardError)) {}

Progress::~Progress() { clear(); }

void Progress::show(std::string_view stage) {
  if (on_terminal_) std::cerr << kEraseLine << "softfocus: " << stage << " ..." << std::flush;
}

void Progress::clear() {
  if (on_terminal_) std::cerr << kEraseLine << std::flush;
}

}  // namespace softfocus
