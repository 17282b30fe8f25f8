#include "tools/stress/findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>

#include "dof/pipelines/pipeline.h"
#include "scenes/frame/frame.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/files/hash_text.h"
#include "tools/options/method_options.h"
#include "tools/report/laboratory.h"
#include "tools/stress/answers.h"
#include "tools/stress/trial_record.h"

namespace softfocus {
namespace {

constexpr int kSmallestStressPx = 64, kLargestStressPx = 1024, kSizeStep = 16;
constexpr int kUsualStressPx = 256, kQuickStressPx = 128;

std::vector<std::string> case_names() {
  std::vector<std::string> names;
  for (const StressCase& of : stress_cases()) names.emplace_back(of.name);
  return names;
}

}  // namespace

void add_stress_options(CLI::App& parser, StressOptions& options) {
  begin_group(parser, "Output");
  add_flag(parser, "--json", "Print what stress.json holds, and nothing else", options.json);
  add_results_option(parser, options, "the atlas");
  begin_group(parser, "What is measured");
  add_value(parser, "--methods", "A,B,...",
            "Methods (default: all; each case takes those that it is for)",
            [&options](const std::string& text) {
              options.methods = listed_methods(text, stress_methods());
            });
  offer(parser, "--methods", stress_methods);
  add_value(parser, "--cases", "A,B,...", "Cases (default: all)",
            [&options](const std::string& text) {
              options.cases = listed_names("--cases", text, case_names());
            });
  offer(parser, "--cases", case_names);
  add_value(parser, "--size", "N",
            "Width and height of the pictures, a multiple of 16 from 64 to 1024 (default: 256; 128 "
            "with --quick); circles larger than a quarter of it are left out",
            [&options](const std::string& text) {
              constexpr std::string_view kWanted = "a multiple of 16 from 64 to 1024";
              options.size_px =
                  parse_whole("--size", text, kSmallestStressPx, kLargestStressPx, kWanted);
              if (options.size_px % kSizeStep != 0) {
                throw UsageError("--size '" + text + "': give " + std::string{kWanted});
              }
            });
  add_flag(parser, "--quick", "Small pictures, three severities a case: under a minute",
           options.quick);
  begin_group(parser, "Run");
  add_pool_options(parser, options.pool, "the results are the same");
  add_quiet_option(parser, options.quiet);
}

void complete(StressOptions& options) {
  check_results_option(options, "the atlas", "atlas");
  if (options.size_px == 0) options.size_px = options.quick ? kQuickStressPx : kUsualStressPx;
  if (options.methods.empty()) options.methods = stress_methods();
  if (options.cases.empty()) options.cases = case_names();
}

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
  std::vector<StressResult> results;
  Laboratory lab{options.quiet};
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
    for (const std::string& method : work_.options.methods) work_.lab.run(record_, answer(method));
    for (const LabMeasure& measure : of_truth()) work_.lab.settle(record_, "truth", "", measure);
    record_.save();
  }

 private:
  StressResult& first() { return work_.results[group_.front()]; }
  bool is_shown() { return severity_ == first().shown; }

  const StressTruth& truth() {
    if (!truth_) truth_ = make_stress_truth(trial_, first().views, work_.pool);
    return *truth_;
  }
  const Image& last_truth() { return truth().pictures.back(); }
  double gain() { return display_gain(last_truth()); }

  /// A value of a case, which goes to `values`.
  LabMeasure value_of(const StressCase& of, std::function<double()> make,
                      std::vector<double>& values) {
    return {.name = "value of " + std::string{of.name},
            .make = [make = std::move(make)] { return number_or_null(of_six_digits(make())); },
            .take =
                [&values](const Json& json) {
                  values.push_back(json.is_null() ? std::numeric_limits<double>::infinity()
                                                  : json.number());
                }};
  }

  static LabMeasure picture_of(const char* name, std::function<Json()> make, std::string& place) {
    return {.name = name,
            .make = std::move(make),
            .take = [&place](const Json& json) { place = json.text(); },
            .is_result = false};
  }

  LabContender answer(const std::string& method) {
    const Method* const filter = find_method_choice(method).filter;
    const bool is_users = filter != nullptr && filter->pipeline != nullptr;
    return {.name = is_users ? method + " " + hash_text(filter->pipeline->hash) : method,
            .stage = std::string{first().of.name} + ", " + std::string{first().of.parameter.name} +
                     " " + short_number(severity_) + ": " + method,
            .kind = method,
            .run = [this, method]() -> std::optional<std::string> {
              pictures_ = method_pictures(method, trial_, work_.pool);
              if (!pictures_) return std::nullopt;
              return hashes_of(*pictures_);
            },
            .measures = [this, method](const std::string&) { return of_answer(method); }};
  }

  std::vector<LabMeasure> of_answer(const std::string& method) {
    std::vector<LabMeasure> measures;
    for (const std::size_t i : group_) {
      StressResult& result = work_.results[i];
      StressCurve& curve =
          *std::find_if(result.curves.begin(), result.curves.end(),
                        [&](const StressCurve& of) { return of.method == method; });
      curve.can_run = true;
      measures.push_back(value_of(
          result.of,
          [this, &result] {
            return result.of.measure({trial_, severity_, truth().pictures, *pictures_, work_.pool});
          },
          curve.values));
      if (severity_ != result.shown) continue;
      measures.push_back(picture_of(
          "picture", [this] { return stress_picture(pictures_->back(), gain()); },
          curve.pictures.picture));
      measures.push_back(picture_of(
          "error",
          [this] {
            return stress_error_picture(last_truth(), pictures_->back(), gain(), work_.pool);
          },
          curve.pictures.error));
    }
    // The time of measures is their method's: no unit of its own.
    for (LabMeasure& measure : measures) measure.kind = method, measure.units = 0.0;
    return measures;
  }

  /// The truth's are kept under no hash: the record's key decides.
  std::vector<LabMeasure> of_truth() {
    std::vector<LabMeasure> measures;
    for (const std::size_t i : group_) {
      StressResult& result = work_.results[i];
      if (first().views > 0) {
        measures.push_back(value_of(
            result.of,
            [this, &result] {
              return result.of.measure(
                  {trial_, severity_, truth().first_half, truth().second_half, work_.pool});
            },
            result.noise_floor));
      }
      if (!is_shown()) continue;
      measures.push_back(picture_of(
          "sharp", [this] { return stress_picture(trial_.frames.back().sharp, gain()); },
          result.sharp));
      measures.push_back(picture_of(
          "picture", [this] { return stress_picture(last_truth(), gain()); }, result.truth));
    }
    return measures;
  }

  StressWork& work_;
  const CaseGroup& group_;
  double severity_;
  StressTrial trial_;
  KeptResults record_;
  std::optional<StressTruth> truth_;
  std::optional<std::vector<Image>> pictures_;  ///< of the answer under way
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

std::vector<StressResult> measure_stress(const StressOptions& options, ThreadPool& pool) {
  std::vector<StressResult> results = empty_results(options);
  const std::vector<CaseGroup> groups = case_groups(results);
  std::size_t trials = 0;
  for (const CaseGroup& group : groups) trials += results[group.front()].severities.size();
  StressWork work{options, pool, std::move(results)};
  // Views of the lens take about as long as fifty filters.
  for (const std::string& method : options.methods) {
    work.lab.left.plan(method, static_cast<double>(trials),
                       find_method_choice(method).filter != nullptr ? 1.0 : 50.0);
  }
  for (const CaseGroup& group : groups) {
    const std::size_t count = work.results[group.front()].severities.size();
    for (std::size_t i = 0; i < count; ++i) TrialWork{work, group, i}.run();
  }
  if (!options.json) work.lab.print_kept("values");
  return std::move(work.results);
}

}  // namespace softfocus
