#pragma once
// The key under which `stress` keeps what it measured of a trial.

#include <string>

#include "tools/stress/cases/stress_case.h"

namespace softfocus {

/// A line that differs whenever a value could, but for the methods' own pictures: version, case,
/// severity, views; of each frame its size, settings and hash, that of its calculated truth and of
/// its first views; and a hash of what the measures give for a wrong answer.
std::string trial_key(const StressCase& of, double severity, const StressTrial& trial, int views,
                      ThreadPool& pool);

}  // namespace softfocus
