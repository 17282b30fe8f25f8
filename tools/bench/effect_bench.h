#pragma once
// `bench --effect`: times effects on one picture, each alone, and on a GL driver in turn.

#include <functional>
#include <string>
#include <vector>

#include "raster/threads/parallel.h"
#include "tools/bench/options.h"
#include "tools/bench/paired_runs.h"
#include "tools/bench/work.h"

namespace softfocus {

/// One effect's times.
struct EffectTimes {
  std::string name;  ///< as it was given: "bloom:levels=3"
  std::vector<double> ours_ms{};
  std::vector<double> peers_ms{};  ///< a driver's, drawing a triangle; none without one
  std::vector<double> quads_ms{};  ///< drawing two
  bool equal = true;               ///< all have the same bits
};

struct EffectBench {
  std::string renderer{};  ///< GL_RENDERER and GL_VERSION; empty without a driver
  std::vector<EffectTimes> effects{};
};

/// The work's picture is what they read: the scene drawn sharp, or what nothing draws. Calls
/// `on_run` before each pair of runs. Throws DriverError.
EffectBench bench_effects(const BenchOptions& options, const BenchWork& work, ThreadPool& pool,
                          const std::function<void(const std::string& what)>& on_run);

std::string effect_bench_text(const BenchOptions& options, const BenchWork& work,
                              const EffectBench& bench);
std::string effect_bench_json(const BenchOptions& options, const BenchWork& work,
                              const EffectBench& bench);

}  // namespace softfocus
