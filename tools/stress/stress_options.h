#pragma once
// Everything that `stress` is told.

#include <filesystem>
#include <string>
#include <vector>

#include "tools/cli/parser.h"
#include "tools/options/run_options.h"

namespace softfocus {

struct StressOptions {
  std::filesystem::path directory;
  std::vector<std::string> methods;  ///< none given: all
  std::vector<std::string> cases;    ///< likewise
  int size_px = 0;                   ///< 0: 256, or 128 with `quick`
  bool quick = false;
  bool json = false;
  bool quiet = false;
  PoolOptions pool;
};

void add_stress_options(CLI::App& parser, StressOptions& options);

/// Settles what was not given. Throws UsageError.
void complete(StressOptions& options);

}  // namespace softfocus
