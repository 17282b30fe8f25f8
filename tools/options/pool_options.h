#pragma once
// What work runs on, on the command line: --threads and --isa, the same for every command.

#include <string>

#include "raster/threads/parallel.h"
#include "tools/cli/parser.h"

namespace softfocus {

struct PoolOptions {
  int threads = hardware_threads();
  Isa isa = widest_isa();
};

/// Adds --threads and --isa. `same` ends the help of the first: what does not depend on it.
void add_pool_options(CLI::App& parser, PoolOptions& options, const std::string& same);

}  // namespace softfocus
