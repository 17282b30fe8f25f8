#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "raster/lanes/isa.h"
#include "tests/support/run_program.h"
#include "tools/golden/hashes.h"

using namespace softfocus;

// golden_test.cpp has the widest unit's hashes.
TEST_CASE("selftest passes on the other vector units and says how many hashes there were" *
          doctest::test_suite("long")) {
  const std::string passed =
      "pass: " + std::to_string(expected_hashes().size()) + " hashes are as expected\n";
  for (const Isa isa : available_isas()) {
    if (isa == widest_isa()) continue;
    CAPTURE(isa_name(isa));
    const ProgramRun run = run_program({"selftest", "--isa", std::string{isa_name(isa)}});
    CHECK(run.status == 0);
    CHECK(run.out == passed);
    CHECK(run.err == "");
  }
}

TEST_CASE("selftest --print prints the table's source" * doctest::test_suite("long")) {
  const ProgramRun run = run_program({"selftest", "--print", "--quick", "--threads", "8"});
  CHECK(run.status == 0);
  std::string wanted;
  std::istringstream table{read_file(SOFTFOCUS_TEST_DATA "/../../tools/golden/table.inc")};
  std::string line;
  for (const NamedHash& entry : expected_hashes(GoldenSet::quick)) {
    while (std::getline(table, line) && !line.starts_with("{\"" + entry.name + "\", ")) {
    }
    wanted += line + '\n';
  }
  CHECK(run.out == wanted);
}

TEST_CASE("selftest --json lists what was expected, what was computed and whether it passes" *
          doctest::test_suite("long")) {
  const ProgramRun run = run_program({"selftest", "--quick", "--json", "--threads", "1"});
  CHECK(run.status == 0);
  const auto list = nlohmann::json::parse(run.out);
  CHECK(list.size() == expected_hashes(GoldenSet::quick).size());
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
