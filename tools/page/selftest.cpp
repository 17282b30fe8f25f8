// selftest: the golden hashes, part by part; with "quick": true, those of selftest --quick.

#include <algorithm>
#include <iterator>

#include "tools/page/requests.h"

namespace softfocus {

Json answer_selftest(Page& page, const Json& request) {
  const Json* quick = request.find("quick");
  const GoldenSet set = quick != nullptr && quick->boolean() ? GoldenSet::quick : GoldenSet::all;
  const std::vector<NamedHash> expected = expected_hashes(set);
  const auto total = static_cast<double>(expected.size());
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
    std::vector<NamedHash> more = page.golden_parts.back()(*page.pool);
    page.golden.insert(page.golden.end(), std::move_iterator(more.begin()),
                       std::move_iterator(more.end()));
    page.golden_parts.pop_back();
  }
  Json results = Json::array();
  for (std::size_t i = first; i < std::min(first + count, page.golden.size()); ++i) {
    const NamedHash& computed = page.golden[i];
    const auto wanted = std::find_if(expected.begin(), expected.end(), [&](const NamedHash& entry) {
      return entry.name == computed.name;
    });
    const bool is_known = wanted != expected.end();
    results.push_back({{"name", computed.name},
                       {"hash", hash_text(computed.hash)},
                       {"wanted", is_known ? Json(hash_text(wanted->hash)) : Json(nullptr)},
                       {"equal", is_known && wanted->hash == computed.hash}});
  }
  return {{"results", results}, {"total", expected.size()}};
}

}  // namespace softfocus
