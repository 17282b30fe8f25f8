#pragma once
// Impostors' answers to a case of reliefs: drawn from one eye, shown to another.

#include <string>
#include <vector>

#include "tools/stress/cases/stress_case.h"

namespace softfocus {

/// One relief warped or marched, the impostor that may renew it, and octahedral atlases.
std::vector<std::string> relief_answers();
bool is_relief_answer(const std::string& method);

/// The frame's scene has a relief.
Image relief_answer(const std::string& method, const StressFrame& frame, ThreadPool& pool);

}  // namespace softfocus
