#pragma once
// The answers to a trial: the lens's own, and each method's.

#include <optional>
#include <string>
#include <vector>

#include "tools/stress/cases/stress_case.h"

namespace softfocus {

/// Views that the method `accumulation` gets.
inline constexpr int kStressSamples = 64;

/// The filters of dof/dof.h, accumulation, what draws the scene in one go, auto, motion blur,
/// kinds of shadows, and impostors.
std::vector<std::string> stress_methods();

/// A method's pictures, or nothing if it needs a scene and the trial is made as a picture, or if it
/// is a filter of depth of field and the trial's shutter is open, or motion blur and it is not.
/// Kinds of shadows, and they alone, answer trials of shadows; impostors those of reliefs.
std::optional<std::vector<Image>> method_pictures(const std::string& method,
                                                  const StressTrial& trial, ThreadPool& pool);

/// The truth of each frame, and where views make it that of either half of them.
struct StressTruth {
  std::vector<Image> pictures;
  std::vector<Image> first_half, second_half;  ///< empty where the truth is calculated
};

/// `views` is even.
StressTruth make_stress_truth(const StressTrial& trial, int views, ThreadPool& pool);

}  // namespace softfocus
