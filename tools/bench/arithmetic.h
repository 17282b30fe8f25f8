#pragma once
// The filter in another arithmetic, timed in turn with the one in floats.

#include <functional>

#include "tools/bench/report.h"

namespace softfocus {

/// Times `dof` alone. Tables, and for `fixed-8` the picture in bytes, are made beforehand.
BenchRecord bench_arithmetic(const BenchOptions& options, const BenchWork& work, ThreadPool& pool,
                             const std::function<void(int run)>& on_run);

}  // namespace softfocus
