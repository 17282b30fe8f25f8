#pragma once
// What a measuring command finds: printed as it comes, or with --json as one object at the end.
// Both have the same names; tools/report/report.html draws the object.

#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/parser.h"
#include "tools/cli/timing.h"
#include "tools/files/json.h"

namespace softfocus {

/// A number's decimal places are as given; a text is to the left.
struct FindingColumn {
  std::string_view key;
  int width;
  int places = 0;
};

class Findings {
 public:
  explicit Findings(bool as_json) : as_json_(as_json) {}

  /// Members of the whole, or of its member of that name: "name: key value, key value".
  void add(const Json& members, std::string_view name = {});
  /// Medians and ends, to the list `times`.
  void add_times(const std::vector<Milliseconds>& times);
  /// How many times as long as the first the second took, pair by pair, and what else is to say.
  void add_ratio(const std::vector<Milliseconds>& times, const Json& more);
  /// Begins a list of records; their table has these columns.
  void begin_table(std::string_view list, std::vector<FindingColumn> columns);
  /// A record has all of its table's keys, and may have more.
  void add_row(const Json& record);
  /// Prints the object, if it is to be JSON.
  void finish() const;

 private:
  bool as_json_;
  Json json_ = Json::object();
  std::string list_;
  std::vector<FindingColumn> columns_;
};

/// Adds --json.
void add_json_option(CLI::App& parser, bool& json);

}  // namespace softfocus
