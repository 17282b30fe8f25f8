#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "tests/support/run_program.h"
#include "tools/golden/hashes.h"

using namespace softfocus;

TEST_CASE("selftest --quick passes and says how many hashes there were" *
          doctest::test_suite("long")) {
  const ProgramRun run = run_program({"selftest", "--quick"});
  CHECK(run.status == 0);
  CHECK(run.out == "pass: " + std::to_string(expected_hashes(GoldenSet::quick).size()) +
                       " hashes are as expected\n");
  CHECK(run.err == "");
}

TEST_CASE("selftest --print prints the table's source" * doctest::test_suite("long")) {
  const ProgramRun run = run_program({"selftest", "--print", "--threads", "8"});
  CHECK(run.status == 0);
  CHECK(run.out == read_file(SOFTFOCUS_TEST_DATA "/../../tools/golden/table.inc"));
}

TEST_CASE("selftest --json lists what was expected, what was computed and whether it passes" *
          doctest::test_suite("long")) {
  const ProgramRun run = run_program({"selftest", "--quick", "--json", "--threads", "1"});
  CHECK(run.status == 0);
  const auto list = nlohmann::json::parse(run.out);
  CHECK(list.size() > 100);
  for (const auto& entry : list) {
    CAPTURE(entry.dump());
    CHECK(entry.at("name").is_string());
    CHECK(entry.at("expected").get<std::string>().size() == 18);
    CHECK(entry.at("computed") == entry.at("expected"));
    CHECK(entry.at("pass") == true);
  }
}

TEST_CASE("selftest refuses two kinds of output and threads that cannot be") {
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--json", "--print"}, {"--threads", "0"}, {"more"}}) {
    std::vector<std::string> arguments{"selftest"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramRun run = run_program(arguments);
    CHECK(run.status == 2);
    CHECK(is_one_line(run.err));
    CHECK(run.out == "");
  }
}
