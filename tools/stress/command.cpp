// softfocus stress: where each method fails, on cases with a known answer.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <string>

#include "tools/cli/commands.h"
#include "tools/cli/option_values.h"
#include "tools/files/json.h"
#include "tools/report/report.h"
#include "tools/stress/answers.h"
#include "tools/stress/findings.h"

namespace softfocus {
namespace {

std::string card_id(const StressResult& result, const StressCurve& curve) {
  return std::string{result.of.name} + "-" + curve.method;
}

/// "radius, px".
std::string parameter_text(const StressCase& of) {
  const std::string name{of.parameter.name}, unit{of.parameter.unit};
  return unit.empty() ? name : name + ", " + unit;
}

/// Colours of the table, by how far the worst value is from the limit.
Json grades_json() {
  Json grades = Json::array();
  const auto add = [&](Json up_to, const char* text) {
    grades.push_back({{"up_to", std::move(up_to)}, {"text", text}});
  };
  add(0.1, "a tenth of the limit at most");
  add(0.5, "half the limit at most");
  add(1.0, "within the limit");
  add(2.0, "up to twice the limit");
  add(5.0, "up to five times");
  add(20.0, "up to twenty times");
  add(nullptr, "more");
  return grades;
}

/// The worst value of a curve over the limit; infinity where a value is not finite, or where a
/// limit of 0 does not hold.
double worst_ratio(const StressResult& result, const StressCurve& curve) {
  double worst = 0.0;
  for (const double value : curve.values) {
    if (result.of.limit > 0.0) {
      worst = std::max(worst, value / result.of.limit);
    } else if (!holds(result.of, value)) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return worst;
}

/// "holds", "all", or from the mildest failure to the most severe one, between which some may hold:
/// "from 8", "up to 8", "8 to 16", "at 8".
std::string failing_text(const StressResult& result, const StressCurve& curve) {
  const auto first = first_failure(result, curve);
  if (!first) return "holds";
  std::size_t last = curve.values.size() - 1;
  while (holds(result.of, curve.values[last])) --last;
  const bool to_the_end = last == curve.values.size() - 1;
  const bool all_fail = std::none_of(curve.values.begin(), curve.values.end(),
                                     [&](double value) { return holds(result.of, value); });
  if (all_fail) return "all";
  const std::string from = short_number(result.severities[*first]);
  if (to_the_end) return "from " + from;
  if (last == *first) return "at " + from;
  if (*first == 0) return "up to " + short_number(result.severities[last]);
  return from + " to " + short_number(result.severities[last]);
}

Json atlas_cell(const StressResult& result, const StressCurve& curve) {
  if (!curve.can_run) return nullptr;
  const double ratio = worst_ratio(result, curve);
  return {{"value", number_or_null(ratio)},
          {"text", failing_text(result, curve)},
          {"to", card_id(result, curve)},
          {"about", std::isfinite(ratio) ? "worst: " + short_number(ratio) + " times the limit"
                                         : "no limit holds"}};
}

Json atlas_table(const std::vector<StressResult>& results) {
  std::vector<Json> columns{{{"name", "case"}, {"word", true}},
                            {{"name", "fails by"}, {"word", true}}};
  for (const StressCurve& curve : results.front().curves) {
    Json column = Json::object();
    column["name"] = curve.method;
    columns.push_back(std::move(column));
  }
  Json rows = Json::array();
  for (const StressResult& result : results) {
    const std::string name{result.of.name};
    std::vector<Json> cells{{{"value", name}, {"to", name}}, parameter_text(result.of)};
    for (const StressCurve& curve : result.curves) cells.push_back(atlas_cell(result, curve));
    Json row = Json::object();
    row["cells"] = json_list(cells);
    rows.push_back(std::move(row));
  }
  return {{"key", "The worst value of the sweep: "},
          {"grades", grades_json()},
          {"columns", json_list(columns)},
          {"rows", std::move(rows)}};
}

Json severity_axis(const StressResult& result) {
  const double first = result.severities.front(), last = result.severities.back();
  const double smaller = std::min(first, last), larger = std::max(first, last);
  return {{"title", parameter_text(result.of)},
          {"short", result.of.parameter.name},
          {"log", smaller > 0.0 && larger / smaller > 6.0},
          {"ticks", result.severities}};
}

/// It ends at 30 times the limit and at a 30th of it.
Json value_axis(const StressCase& of) {
  constexpr double kSpan = 30.0;
  Json axis{{"title", of.unit}, {"short", of.unit}};
  axis["log"] = of.limit > 0.0;
  if (of.limit > 0.0) {
    axis["least"] = of.limit / kSpan;
    axis["most"] = of.limit * kSpan;
    axis["ticks"] = {of.limit / 10.0, of.limit, of.limit * 10.0};
  } else {
    axis["least"] = 0.0;
  }
  return axis;
}

Json curve_series(const StressResult& result, const std::string& name, const char* kind,
                  const std::vector<double>& values) {
  Json points = Json::array();
  for (std::size_t i = 0; i < values.size(); ++i) {
    Json point{{"x", result.severities[i]}, {"y", number_or_null(values[i])}};
    if (!holds(result.of, values[i])) point["bad"] = true;
    points.push_back(std::move(point));
  }
  return report_series(name, kind, std::move(points));
}

Json case_plot(const StressResult& result) {
  Json limit = Json::object();
  limit["y"] = result.of.limit;
  std::vector<Json> series{{{"name", "limit"}, {"kind", "limit"}, {"points", json_list({limit})}}};
  if (!result.noise_floor.empty()) {
    series.push_back(curve_series(result, "noise of the truth", "thin", result.noise_floor));
  }
  for (const StressCurve& curve : result.curves) {
    if (curve.can_run) series.push_back(curve_series(result, curve.method, "line", curve.values));
  }
  return {
      {"about", std::string{result.of.measured} + " by " + std::string{result.of.parameter.name}},
      {"x", severity_axis(result)},
      {"y", value_axis(result.of)},
      {"series", json_list(series)}};
}

Json method_card(const StressResult& result, const StressCurve& curve, Json& pictures) {
  const std::string on = curve.method + " on " + std::string{result.of.name};
  const std::string id = card_id(result, curve), truth = std::string{result.of.name} + ".truth.png";
  return {
      {"id", id},
      {"title", curve.method + (first_failure(result, curve) ? " fails: " : " ") +
                    failing_text(result, curve)},
      {"own", curve.method},
      {"figures",
       json_list({json_list({report_figure(pictures, id + ".picture.png", curve.pictures.picture,
                                           "Picture by " + on, "the picture"),
                             report_figure(pictures, truth, result.truth, "The truth", "the truth"),
                             report_figure(pictures, id + ".error.png", curve.pictures.error,
                                           "Map of the FLIP error of " + on, "its error")})})}};
}

Json case_part(const StressResult& result, Json& pictures) {
  const StressCase& of = result.of;
  const std::string name{of.name};
  std::string text = std::string{of.must_hold} + " Measured: " + std::string{of.measured} + ", " +
                     std::string{of.unit} + ". Limit " + short_number(of.limit) + ": " +
                     std::string{of.why_limit} + ".";
  text += result.views > 0
              ? " The truth is the mean of " + std::to_string(result.views) +
                    " views of the lens; the dotted line is one half of them against the other."
              : " The truth is calculated.";
  Json plots{{"name", name}, {"panels", json_list({case_plot(result)})}, {"height", 400}};
  Json cards = Json::array();
  for (const StressCurve& curve : result.curves) {
    if (curve.can_run) cards.push_back(method_card(result, curve, pictures));
  }
  return {{"id", name},
          {"title", name + ": " + std::string{of.title}},
          {"below", true},
          {"text", json_list({text})},
          {"plots", std::move(plots)},
          {"figures",
           json_list({json_list(
               {report_figure(pictures, name + ".sharp.png", result.sharp,
                              "The sharp picture of " + name, "the sharp picture"),
                report_figure(pictures, name + ".truth.png", result.truth, "The truth of " + name,
                              "the truth at " + std::string{of.parameter.name} + " " +
                                  short_number(result.shown))})})},
          {"cards", std::move(cards)}};
}

/// [{method, case, parameter: {name, value, unit}, value, unit, limit, holds}]: one a method that
/// can run, a case and a severity. A value that is not finite is null.
Json stress_json(const std::vector<StressResult>& results) {
  Json list = Json::array();
  for (const StressResult& result : results) {
    const StressCase& of = result.of;
    for (const StressCurve& curve : result.curves) {
      for (std::size_t i = 0; i < curve.values.size(); ++i) {
        list.push_back({{"method", curve.method},
                        {"case", of.name},
                        {"parameter",
                         {{"name", of.parameter.name},
                          {"value", result.severities[i]},
                          {"unit", of.parameter.unit}}},
                        {"value", number_or_null(curve.values[i])},
                        {"unit", of.unit},
                        {"limit", of.limit},
                        {"holds", holds(of, curve.values[i])}});
      }
    }
  }
  return list;
}

/// That list with the columns parameter, parameter_value and parameter_unit.
std::string stress_csv(const Json& list) {
  Json lines = Json::array();
  for (const Json& entry : list.values()) {
    Json line = Json::object();
    for (const std::string& name : entry.names()) {
      const Json& value = entry.at(name);
      if (!value.is_object()) {
        line[name] = value;
        continue;
      }
      line[name] = value.at("name");
      line[name + "_value"] = value.at("value");
      line[name + "_unit"] = value.at("unit");
    }
    lines.push_back(std::move(line));
  }
  return csv_of(lines);
}

/// A line a method: how many cases hold throughout, and from where on the others do not.
std::string stress_summary(const std::vector<StressResult>& results) {
  std::string text;
  const std::size_t methods = results.empty() ? 0 : results[0].curves.size();
  for (std::size_t m = 0; m < methods; ++m) {
    int all = 0, held = 0;
    std::string failing;
    for (const StressResult& result : results) {
      const StressCurve& curve = result.curves[m];
      if (!curve.can_run) continue;
      ++all;
      if (!first_failure(result, curve)) {
        ++held;
        continue;
      }
      failing += (failing.empty() ? "; fails " : ", ") + std::string{result.of.name} + " (" +
                 failing_text(result, curve) + ")";
    }
    text += results[0].curves[m].method + ": holds " + std::to_string(held) + " of " +
            std::to_string(all) + failing + "\n";
  }
  return text;
}

/// The table, case by method, coloured by the worst value over the limit; and for each case its
/// curves, its truth, and each method's picture and error.
Json stress_report(const std::vector<StressResult>& results, const StressOptions& options) {
  Json pictures = Json::object(), parts = Json::array();
  parts.push_back({{"id", "atlas"}, {"title", "All cases"}, {"table", atlas_table(results)}});
  parts.push_back(
      {{"id", "cases"},
       {"title", "Case by case"},
       {"text",
        json_list({"In the curves the broken line is the limit; red points do not hold; a method's "
                   "own curve is before the grey ones of the others. In the maps of errors black "
                   "is right and pale yellow is wrong (FLIP). Dark pictures are brightened, with "
                   "their truth."})}});
  for (const StressResult& result : results) parts.push_back(case_part(result, pictures));
  std::vector<std::string> command{"softfocus", "stress", "--size",
                                   std::to_string(options.size_px)};
  if (options.cases.size() < stress_cases().size()) {
    command.insert(command.end(), {"--cases", joined_names(options.cases)});
  }
  if (options.methods != stress_methods()) {
    command.insert(command.end(), {"--methods", joined_names(options.methods)});
  }
  if (options.quick) command.emplace_back("--quick");
  return {
      {"title", "Where depth-of-field methods fail"},
      {"text",
       json_list({"Each method on each case at " + size_text({options.size_px, options.size_px}) +
                  ", all at equal settings, with no circle cut but in the case of largest "
                  "circles. accumulation has 64 views of the lens; auto chooses for itself. A "
                  "cell tells from which severity on the method fails: the parameter stands "
                  "beside the case. –: the method needs a scene, and the case is a picture."})},
      {"command", command_text(command)},
      {"parts", std::move(parts)},
      {"pictures", std::move(pictures)}};
}

int stress(const StressOptions& options) {
  const std::filesystem::path& directory = options.directory;
  const auto csv = directory / "stress.csv", list = directory / "stress.json",
             page = directory / "index.html";
  prepare_results(directory, {csv, list, page});
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const std::vector<StressResult> results = measure_stress(options, pool);
  const Json json = stress_json(results);
  write_json(list, json);
  write_text(csv, stress_csv(json));
  write_text(page, report_page(stress_report(results, options)));
  if (options.json) {
    std::cout << json_text(json, 1) << '\n';
    return kDone;
  }
  std::cout << stress_summary(results) << "written to " << page.string() << '\n';
  return kDone;
}

}  // namespace

Command add_stress_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "stress",
                                 "Measure where each method fails, on cases with known answers");
  const auto options = std::make_shared<StressOptions>();
  add_stress_options(*parser, *options);
  return {parser, [options] {
            complete(*options);
            return stress(*options);
          }};
}

}  // namespace softfocus
