// softfocus selftest: whether this program, on this machine, gives the bits that every
// other gives.

#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/files/json.h"
#include "tools/golden/hashes.h"
#include "tools/options/run_options.h"

namespace softfocus {
namespace {

struct SelftestOptions {
  PoolOptions pool;
  GoldenSet set = GoldenSet::all;
  bool json = false;
  bool print = false;
};

void print_table(const std::vector<HashCheck>& checks) {
  for (const HashCheck& check : checks) {
    if (!check.computed) continue;
    std::cout << "{\"" << check.name << "\", " << hash_text(*check.computed) << "},\n";
  }
}

void print_json(const std::vector<HashCheck>& checks) {
  const auto text_or_null = [](const std::optional<std::uint64_t>& hash) {
    return hash ? Json(hash_text(*hash)) : Json(nullptr);
  };
  auto list = Json::array();
  for (const HashCheck& check : checks) {
    list.push_back({{"name", check.name},
                    {"expected", text_or_null(check.expected)},
                    {"computed", text_or_null(check.computed)},
                    {"pass", passes(check)}});
  }
  std::cout << json_text(list, 2) << '\n';
}

int selftest(const SelftestOptions& options) {
  if (options.json && options.print) {
    throw UsageError("--json and --print would both write to standard output; give one");
  }
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const std::vector<HashCheck> checks =
      check_hashes(expected_hashes(options.set), golden_hashes(pool, options.set));
  if (options.print) {
    print_table(checks);
    return kDone;
  }
  if (options.json) print_json(checks);
  const std::string failures = describe_failures(checks);
  if (!failures.empty()) {
    throw std::runtime_error("selftest: " + failures + "; docs/portability.md says how to go on");
  }
  if (!options.json) std::cout << "pass: " << checks.size() << " hashes are as expected\n";
  return kDone;
}

}  // namespace

Command add_selftest_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "selftest",
                                 "Check that this machine gives the bits that every other gives");
  const auto options = std::make_shared<SelftestOptions>();
  add_pool_options(*parser, options->pool, "the hashes are the same");
  add_flag(*parser, "--quick", "Leave out larger frames, and most under other profiles than ieee",
           [options] { options->set = GoldenSet::quick; });
  add_flag(*parser, "--json", "Print every hash, expected and computed, as JSON", options->json);
  add_flag(*parser, "--print", "Print what was computed as the table's source, and compare nothing",
           options->print);
  return {parser, [options] { return selftest(*options); }};
}

}  // namespace softfocus
