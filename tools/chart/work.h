#pragma once
// All that `chart` measures, kept in DIR/cache as it goes.
//
//   cache/SCENE.truth.npy, .json      the ground truth, and its noise
//   cache/SCENE/ENTRY.json            errors of a contender; its pictures, if the page shows them
//   cache/SCENE/truth.picture.json    the truth for the page
//   cache/SCENE/times.json            the times of all, written after each round

#include <vector>

#include "tools/chart/options.h"
#include "tools/chart/point.h"

namespace softfocus {

struct ChartFindings {
  std::vector<ChartPanel> panels;
  int kept = 0;  ///< results that an earlier run left: truths, errors and times
  int all = 0;   ///< results
};

/// Settled panels with pictures. Measures what is not kept already, with a line on the terminal
/// that says how long it takes. Needs the directory, with "cache" in it.
ChartFindings measure_chart(const ChartOptions& options, ThreadPool& pool);

}  // namespace softfocus
