#pragma once
// What a bench measured, to read or as JSON.

#include <optional>
#include <string>
#include <vector>

#include "tools/bench/paired_runs.h"
#include "tools/bench/work.h"

namespace softfocus {

struct BenchPeer {
  std::string driver;    ///< its name on the command line
  std::string renderer;  ///< GL_RENDERER and GL_VERSION
  bool equal = false;    ///< its picture has the bits of ours
};

struct BenchRecord {
  const BenchOptions& options;
  const BenchWork& work;
  PairedSamples samples;
  std::optional<BenchPeer> peer;
};

std::string bench_text(const BenchRecord& record);
std::string bench_json(const BenchRecord& record);

}  // namespace softfocus
