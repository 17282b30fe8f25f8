#pragma once
// A bench's results, to read or as JSON.

#include <optional>
#include <string>
#include <vector>

#include "dof/auto/auto_method.h"
#include "tools/bench/paired_runs.h"
#include "tools/bench/work.h"
#include "tools/cli/timing.h"
#include "tools/files/json.h"

namespace softfocus {

struct BenchPeer {
  std::string driver;        ///< its name on the command line
  std::string renderer;      ///< GL_RENDERER and GL_VERSION
  bool equal = false;        ///< its picture has the bits of ours
  std::string difference{};  ///< why not, and what shows more; may be empty

  /// A form of the filter's shader, and the median of its times.
  struct ShaderForm {
    std::string name;
    double filter_ms;
  };
  std::vector<ShaderForm> shaders{};  ///< none if nothing is filtered, or not by a driver
  std::string shader{};               ///< the fastest: the one that the peer's times are of
};

struct BenchRecord {
  const BenchOptions& options;
  const BenchWork& work;
  PairedSamples samples;
  std::optional<BenchPeer> peer;
  std::optional<AutoMethod> choice{};  ///< of auto
  int samples_taken = 0;               ///< by a method that draws the scene
  std::vector<double> frames_ms{};     ///< of --frames, in their order
};

std::string bench_text(const BenchRecord& record);
std::string bench_json(const BenchRecord& record);

// What every bench says.

/// "5.71 [5.52, 6.03]"; milliseconds without `places` have two, or three below 10.
std::string spread_text(const Spread& spread, std::optional<int> places = {});

/// With blanks up to the width, one at least.
std::string padded(const std::string& text, std::size_t width);

/// A line of profile, machine and runs.
std::string run_text(const BenchOptions& options, const BenchWork& work);

/// Version, work, profile, machine and runs; no peer yet.
Json run_json(const BenchOptions& options, const BenchWork& work);

}  // namespace softfocus
