// selftest: the golden hashes, part by part; with "quick": true, those of selftest --quick.

#include <algorithm>

#include "tools/page/requests.h"

namespace softfocus {
namespace {

/// Checks the groups of which hashes were computed.
std::vector<HashCheck> check_part(std::span<const HashGroup> table,
                                  std::span<const NamedHash> computed) {
  std::vector<HashGroup> expected(table.begin(), table.end());
  std::erase_if(expected, [&](const HashGroup& group) {
    return std::none_of(computed.begin(), computed.end(),
                        [&](const NamedHash& one) { return group_of(one.name) == group.name; });
  });
  return check_hashes(expected, computed);
}

}  // namespace

Json answer_selftest(Page& page, const Json& request) {
  const Json* quick = request.find("quick");
  const GoldenSet set = quick != nullptr && quick->boolean() ? GoldenSet::quick : GoldenSet::all;
  const std::vector<HashGroup> table = expected_groups(set);
  const std::size_t all = member_count(table);
  const auto total = static_cast<double>(all);
  const auto first =
      static_cast<std::size_t>(checked_number(request.at("first"), "first", 0.0, total));
  const auto count =
      static_cast<std::size_t>(checked_number(request.at("count"), "count", 0.0, total));
  if (page.golden.empty() || page.golden_set != set) {
    page.golden_set = set;
    page.golden_parts = golden_parts(set);
    std::reverse(page.golden_parts.begin(), page.golden_parts.end());
    page.golden.clear();
  }
  while (page.golden.size() < first + count && !page.golden_parts.empty()) {
    stop_if_cancelled(page);
    const auto more = check_part(table, page.golden_parts.back().hashes(*page.pool));
    page.golden.insert(page.golden.end(), more.begin(), more.end());
    page.golden_parts.pop_back();
  }
  Json results = Json::array();
  for (std::size_t i = first; i < std::min(first + count, page.golden.size()); ++i) {
    const HashCheck& check = page.golden[i];
    results.push_back(
        {{"name", check.name},
         {"hash", check.computed ? Json(hash_text(*check.computed)) : Json(nullptr)},
         {"wanted_end", check.expected ? Json(end_text(*check.expected)) : Json(nullptr)},
         {"equal", check.passes}});
  }
  return {{"results", results}, {"total", all}};
}

}  // namespace softfocus
