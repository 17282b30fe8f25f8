#include "tools/files/findings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

std::string words_of(std::string_view key) {
  std::string words{key};
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string value_text(const Json& value) {
  if (value.is_text()) return value.text();
  if (value.is_null()) return "none";
  const double number = value.number();
  return number == std::floor(number) && std::fabs(number) < 1e15 ? json_text(std::llround(number))
                                                                  : short_number(number);
}

/// Columns are apart, however wide a text is.
void print_cell(const std::string& text, int width, bool is_text) {
  std::printf(is_text ? "%-*s " : "%*s ", width, text.c_str());
}

}  // namespace

void Findings::add(const Json& members, std::string_view name) {
  Json& of = name.empty() ? json_ : json_[name];
  std::string line = name.empty() ? "" : words_of(name) + ":";
  for (const std::string& key : members.names()) {
    of[key] = members.at(key);
    if (!line.empty()) line += line.back() == ':' ? " " : ", ";
    line += words_of(key) + " " + value_text(members.at(key));
  }
  if (!as_json_) std::cout << line << std::endl;
}

void Findings::add_times(const std::vector<Milliseconds>& times) {
  for (const Milliseconds& of : times) {
    const Spread ms = spread_of(of.ms);
    const double cpu_ms = spread_of(of.cpu_ms).median;
    json_["times"].push_back({{"name", of.name},
                              {"median_ms", ms.median},
                              {"min_ms", ms.min},
                              {"max_ms", ms.max},
                              {"cpu_ms", cpu_ms}});
    if (as_json_) continue;
    std::printf("%-26s %9.2f ms  (%.2f to %.2f; %.2f of CPU)\n", of.name.c_str(), ms.median, ms.min,
                ms.max, cpu_ms);
  }
  std::fflush(stdout);
}

void Findings::add_ratio(const std::vector<Milliseconds>& times, const Json& more) {
  const Spread ratio = spread_of(pair_ratios(times[0].ms, times[1].ms));
  Json members{{"median", ratio.median}, {"min", ratio.min}, {"max", ratio.max}};
  for (const std::string& key : more.names()) members[key] = more.at(key);
  add(members, "ratio");
}

void Findings::begin_table(std::string_view list, std::vector<FindingColumn> columns) {
  list_ = list;
  columns_ = std::move(columns);
  json_[list_] = Json::array();
  if (as_json_) return;
  for (const FindingColumn& column : columns_) {
    print_cell(words_of(column.key), column.width, &column == &columns_.front());
  }
  std::puts("");
}

void Findings::add_row(const Json& record) {
  json_[list_].push_back(record);
  if (as_json_) return;
  for (const FindingColumn& column : columns_) {
    const Json& value = record.at(column.key);
    if (value.is_text()) {
      print_cell(value.text(), column.width, true);
    } else {
      std::printf("%*.*f ", column.width, column.places, value.number());
    }
  }
  std::puts("");
  std::fflush(stdout);
}

void Findings::finish() const {
  if (as_json_) std::cout << json_text(json_, 2) << '\n';
}

void add_json_option(CLI::App& parser, bool& json) {
  add_flag(parser, "--json", "Print JSON", json);
}

}  // namespace softfocus
