#include "tools/stress/findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tools/cli/option_values.h"
#include "tools/cli/progress.h"
#include "tools/report/kept_results.h"
#include "tools/stress/answers.h"
#include "tools/stress/trial_record.h"

namespace softfocus {
namespace {

constexpr int kQuickViews = 128;

/// Cases that are measured on the same pictures, by their places in the findings.
using CaseGroup = std::vector<std::size_t>;

/// A number cut to six digits, so that nobody's last digit shows.
double of_six_digits(double value) {
  if (!std::isfinite(value)) return value;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return std::strtod(text.data(), nullptr);
}

/// Passed along with all the work.
struct StressWork {
  const StressOptions& options;
  ThreadPool& pool;
  StressFindings findings;
  Progress progress{options.quiet};
  TimeLeft left{};

  void show(const StressResult& result, double severity, const std::string& method) {
    const double seconds = left.seconds();
    progress.show(std::string{result.of.name} + ", " + std::string{result.of.parameter.name} + " " +
                  short_number(severity) + ": " + method +
                  (seconds > 0.0 ? "; " + time_left_text(seconds) : ""));
  }
};

/// A trial at one severity, and what is kept of it. The truth is made when it is asked for.
class TrialWork {
 public:
  TrialWork(StressWork& work, const CaseGroup& group, std::size_t index)
      : work_(work),
        group_(group),
        severity_(first().severities[index]),
        trial_(first().of.make(severity_, work.options.size_px, work.pool)),
        record_(work.options.directory / "cache" /
                    (std::string{first().of.name} + "-" + std::to_string(index) + "-" +
                     std::to_string(work.options.size_px) + ".json"),
                trial_key(first().of, severity_, trial_, first().views, work.pool)) {}

  void run() {
    for (const std::string& method : work_.options.methods) {
      work_.show(first(), severity_, method);
      if (const auto pictures = method_pictures(method, trial_, work_.pool)) {
        measure_method(method, *pictures);
      }
      work_.left.done(method, 1.0);
    }
    if (first().views > 0) measure_noise();
    if (severity_ == first().shown) keep_truth_pictures();
    record_.save();
  }

 private:
  StressResult& first() { return work_.findings.results[group_.front()]; }

  const StressTruth& truth() {
    if (!truth_) truth_ = make_stress_truth(trial_, first().views, work_.pool);
    return *truth_;
  }

  double measured(const StressCase& of, const std::vector<Image>& truth,
                  const std::vector<Image>& result) {
    return of_six_digits(of.measure({trial_, severity_, truth, result, work_.pool}));
  }

  /// The kept number, or what `make` gives, which is kept.
  template <class Make>
  double number(const std::string& entry, const std::string& hash, std::string_view case_name,
                const Make& make) {
    const std::string name = "value of " + std::string{case_name};
    ++work_.findings.all;
    if (const auto kept = record_.number(entry, hash, name)) {
      ++work_.findings.kept;
      return *kept;
    }
    const double value = make();
    record_.keep(entry, hash, name, number_or_null(value));
    return std::isfinite(value) ? value : std::numeric_limits<double>::infinity();
  }

  template <class Make>
  std::string text(const std::string& entry, const std::string& hash, const std::string& name,
                   const Make& make) {
    if (const auto kept = record_.text(entry, hash, name)) return *kept;
    std::string made = make();
    record_.keep(entry, hash, name, made);
    return made;
  }

  void measure_method(const std::string& method, const std::vector<Image>& pictures) {
    const std::string hash = hashes_of(pictures);
    for (const std::size_t i : group_) {
      StressResult& result = work_.findings.results[i];
      const auto curve = std::find_if(result.curves.begin(), result.curves.end(),
                                      [&](const StressCurve& of) { return of.method == method; });
      curve->can_run = true;
      curve->values.push_back(number(method, hash, result.of.name, [&] {
        return measured(result.of, truth().pictures, pictures);
      }));
      if (severity_ != result.shown) continue;
      const auto gain = [&] { return display_gain(truth().pictures.back()); };
      curve->pictures.picture =
          text(method, hash, "picture", [&] { return stress_picture(pictures.back(), gain()); });
      curve->pictures.error = text(method, hash, "error", [&] {
        return stress_error_picture(truth().pictures.back(), pictures.back(), gain(), work_.pool);
      });
    }
  }

  // The truth's pictures are kept under no hash: the record's key decides.
  void measure_noise() {
    for (const std::size_t i : group_) {
      StressResult& result = work_.findings.results[i];
      result.noise_floor.push_back(number("truth", "", result.of.name, [&] {
        return measured(result.of, truth().first_half, truth().second_half);
      }));
    }
  }

  void keep_truth_pictures() {
    const auto gain = [&] { return display_gain(truth().pictures.back()); };
    const std::string sharp = text(
        "truth", "", "sharp", [&] { return stress_picture(trial_.frames.back().sharp, gain()); });
    const std::string right = text("truth", "", "picture",
                                   [&] { return stress_picture(truth().pictures.back(), gain()); });
    for (const std::size_t i : group_) {
      work_.findings.results[i].sharp = sharp;
      work_.findings.results[i].truth = right;
    }
  }

  StressWork& work_;
  const CaseGroup& group_;
  double severity_;
  StressTrial trial_;
  KeptResults record_;
  std::optional<StressTruth> truth_;
};

std::vector<StressResult> empty_results(const StressOptions& options) {
  std::vector<StressResult> results;
  for (const StressCase& of : stress_cases()) {
    if (std::find(options.cases.begin(), options.cases.end(), of.name) == options.cases.end()) {
      continue;
    }
    StressResult result{.of = of,
                        .severities = severities_of(of, options.size_px, options.quick),
                        .noise_floor = {},
                        .views = options.quick ? std::min(of.views, kQuickViews) : of.views,
                        .shown = 0.0,
                        .sharp = {},
                        .truth = {},
                        .curves = {}};
    result.shown = shown_severity(of, result.severities);
    for (const std::string& method : options.methods) result.curves.push_back({.method = method});
    results.push_back(std::move(result));
  }
  return results;
}

std::vector<CaseGroup> case_groups(const std::vector<StressResult>& results) {
  std::vector<CaseGroup> groups;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (i == 0 || !same_trials(results[i - 1].of, results[i].of)) groups.emplace_back();
    groups.back().push_back(i);
  }
  return groups;
}

}  // namespace

std::optional<std::size_t> first_failure(const StressResult& result, const StressCurve& curve) {
  for (std::size_t i = 0; i < curve.values.size(); ++i) {
    if (!holds(result.of, curve.values[i])) return i;
  }
  return std::nullopt;
}

StressFindings measure_stress(const StressOptions& options, ThreadPool& pool) {
  std::vector<StressResult> results = empty_results(options);
  const std::vector<CaseGroup> groups = case_groups(results);
  std::size_t trials = 0;
  for (const CaseGroup& group : groups) trials += results[group.front()].severities.size();
  StressWork work{options, pool, {std::move(results), 0, 0}};
  // Views of the lens take about as long as fifty filters.
  for (const std::string& method : options.methods) {
    work.left.plan(method, static_cast<double>(trials),
                   find_method(method) != nullptr ? 1.0 : 50.0);
  }
  for (const CaseGroup& group : groups) {
    const std::size_t count = work.findings.results[group.front()].severities.size();
    for (std::size_t i = 0; i < count; ++i) TrialWork{work, group, i}.run();
  }
  return std::move(work.findings);
}

}  // namespace softfocus
