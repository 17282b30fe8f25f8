#include "tools/report/laboratory.h"

#include <algorithm>
#include <cassert>
#include <iostream>

#include "tools/cli/errors.h"

namespace softfocus {

void add_results_option(CLI::App& parser, LabOptions& options, const std::string& what) {
  add_value(parser, "-o,--output", "DIR", "Where " + what + " and what was measured go; required",
            [&options](const std::string& text) { options.directory = text; });
}

void check_results_option(const LabOptions& options, const std::string& what,
                          const std::string& name) {
  if (!options.directory.empty()) return;
  throw UsageError("-o is missing; give a directory for " + what + ", such as -o " + name);
}

void Laboratory::show(const std::string& stage) {
  const double seconds = left.seconds();
  progress.show(seconds > 0.0 ? stage + "; " + time_left_text(seconds) : stage);
}

void Laboratory::settle(KeptResults& record, const std::string& entry, const std::string& hash,
                        const LabMeasure& measure) {
  all += measure.is_result ? 1 : 0;
  const Json* const there = again ? nullptr : record.find(entry, hash, measure.name);
  try {
    if (there != nullptr) {
      measure.take(*there);
      kept += measure.is_result ? 1 : 0;
      if (!measure.kind.empty()) left.drop(measure.kind, measure.units);
      return;
    }
  } catch (const JsonError&) {  // damaged
  }
  const Json made = measure.make();
  if (!measure.kind.empty()) left.done(measure.kind, measure.units);
  record.keep(entry, hash, measure.name, made);
  measure.take(made);
}

void Laboratory::run(KeptResults& record, const LabContender& contender) {
  show(contender.stage);
  left.start();
  const std::optional<std::string> hash = contender.run();
  if (!hash) {
    left.drop(contender.kind, 1.0);
    return;
  }
  left.done(contender.kind, 1.0);
  for (const LabMeasure& measure : contender.measures(*hash)) {
    settle(record, contender.name, *hash, measure);
  }
}

void Laboratory::print_kept(const char* results) const {
  if (kept == 0) return;
  std::cout << "went on: " << kept << " of " << all << ' ' << results << " were there already\n";
}

HalvedViews halved_views(const LensViewInput& input, int first, int count,
                         const std::function<void(int)>& on_views, ThreadPool& pool) {
  assert(count % (2 * kSampleGroup) == 0);
  AccumulationBuffer buffer = make_accumulation_buffer(input, pool);
  SampleSums sums = make_sample_sums(input.pinhole.width, input.pinhole.height);
  const auto add = [&](int begin, int end) {
    for (int i = begin; i < end; i += kLensViewGroup) {
      const int until = std::min(i + kLensViewGroup, end);
      add_lens_views(buffer, input, first + i, first + until, sums, pool);
      if (on_views) on_views(until);
    }
  };
  const auto mean_of = [&](const SampleSums& of) {
    return mean_picture(of, input.pinhole, input.profile, pool);
  };
  add(0, count / 2);
  const SampleSums half = sums;
  add(count / 2, count);
  return {mean_of(sums), mean_of(half), mean_of(later_samples(half, sums))};
}

}  // namespace softfocus
