// softfocus selftest: whether this program, on this machine, gives the bits that every
// other gives.

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "scenes/files/scene_error.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/files/json.h"
#include "tools/golden/hashes.h"
#include "tools/options/run_options.h"

namespace softfocus {
namespace {

struct SelftestOptions {
  PoolOptions pool;
  std::string branch;
  GoldenSet set = GoldenSet::all;
  bool json = false;
  bool print = false;
};

/// As golden/table.inc has it.
void print_group(const HashGroup& group) {
  constexpr std::size_t kEndsOfLine = 18;
  std::cout << "{\"" << group.name << "\", " << hash_text(group.hash) << ",\n \"";
  for (std::size_t i = 0; i < group.ends.size(); ++i) {
    if (i > 0) std::cout << (i % kEndsOfLine == 0 ? " \"\n \"" : " ");
    std::cout << end_text(group.ends[i]);
  }
  std::cout << "\"},\n";
}

/// Groups, or the members of the only group.
void print(const std::vector<NamedHash>& hashes, std::string_view branch) {
  const std::vector<HashGroup> groups = groups_of(hashes);
  if (groups.size() > 1 || groups.front().name != branch) {
    for (const HashGroup& group : groups) print_group(group);
  } else {
    for (const NamedHash& one : hashes) std::cout << hash_text(one.hash) << ' ' << one.name << '\n';
  }
}

void print_json(const std::vector<HashCheck>& checks) {
  auto list = Json::array();
  for (const HashCheck& check : checks) {
    list.push_back(
        {{"name", check.name},
         {"expected_end", check.expected ? Json(end_text(*check.expected)) : Json(nullptr)},
         {"computed", check.computed ? Json(hash_text(*check.computed)) : Json(nullptr)},
         {"pass", check.passes}});
  }
  std::cout << json_text(list, 2) << '\n';
}

int selftest(const SelftestOptions& options) {
  if (options.json && options.print) {
    throw UsageError("--json and --print would both write to standard output; give one");
  }
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const std::vector<NamedHash> computed = golden_hashes(pool, options.set, options.branch);
  const std::vector<HashGroup> expected = expected_groups(options.set, options.branch);
  if (computed.empty() && expected.empty()) {
    std::vector<std::string> names;
    for (const HashGroup& group : expected_groups(options.set)) {
      names.push_back(group.name.substr(0, group.name.find(' ')));
    }
    throw UsageError("no golden hashes are below '" + options.branch +
                     "'; 'softfocus selftest --print' lists their groups" +
                     did_you_mean(options.branch, names));
  }
  if (options.print) {
    if (!computed.empty()) print(computed, options.branch);
    return kDone;
  }
  const std::vector<HashCheck> checks = check_hashes(expected, computed);
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
  add_optional_argument(*parser, "GROUP",
                        "Only what is below it: 'figures', 'figures ieee', 'figures ieee 97x61'",
                        options->branch);
  add_pool_options(*parser, options->pool, "the hashes are the same");
  add_flag(*parser, "--quick", "Leave out larger frames, and most under other profiles than ieee",
           [options] { options->set = GoldenSet::quick; });
  add_flag(*parser, "--json", "Print every hash, expected and computed, as JSON", options->json);
  add_flag(*parser, "--print",
           "Print what was computed as the table's source, or one group's hashes; compare nothing",
           options->print);
  return {parser, [options] { return selftest(*options); }};
}

}  // namespace softfocus
