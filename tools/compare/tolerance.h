#pragma once
// How far off a picture may be: limits, and whether they were kept.

#include <optional>
#include <string>
#include <vector>

#include "dof/measure/difference.h"

namespace softfocus {

struct Tolerance {
  std::optional<int> max_half_ulps;  ///< of any value, alpha too
  std::optional<double> max_flip;    ///< mean over the picture
  std::optional<double> max_error;   ///< of a colour's value (Difference::max_error)
};

bool has_limits(const Tolerance& tolerance);

/// A limit, what was found, and the names of both.
struct LimitFinding {
  std::string option;  ///< "--max-ulps"
  std::string unit;    ///< " half-ULPs", or nothing
  double limit = 0.0;
  double value = 0.0;
};

inline bool is_kept(const LimitFinding& finding) { return finding.value <= finding.limit; }

/// A finding for each limit. `flip` is needed with max_flip alone.
std::vector<LimitFinding> check_limits(const Tolerance& tolerance, const Difference& difference,
                                       std::optional<double> flip);

/// "--max-ulps 4: broken by 1, 5 half-ULPs".
std::string limit_text(const LimitFinding& finding);

}  // namespace softfocus
