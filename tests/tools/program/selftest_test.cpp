#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "raster/lanes/isa.h"
#include "tests/support/run_program.h"
#include "tools/golden/hashes.h"

using namespace softfocus;

// golden_test.cpp has all hashes, on the widest unit.
TEST_CASE("selftest passes on the other vector units and says how many hashes there were" *
          doctest::test_suite("long")) {
  for (const Isa isa : available_isas()) {
    if (isa == widest_isa()) continue;
    CAPTURE(isa_name(isa));
    const std::size_t count = member_count(expected_groups(GoldenSet::quick));
    const ProgramRun run =
        run_program({"selftest", "--quick", "--isa", std::string{isa_name(isa)}});
    CHECK(run.status == 0);
    CHECK(run.out == "pass: " + std::to_string(count) + " hashes are as expected\n");
    CHECK(run.err == "");
  }
}

TEST_CASE("selftest --print prints the table's source" * doctest::test_suite("long")) {
  const ProgramRun run =
      run_program({"selftest", "figures", "--print", "--quick", "--threads", "8"});
  CHECK(run.status == 0);
  const std::string table = read_file(SOFTFOCUS_TEST_DATA "/../../tools/golden/table.inc");
  std::string wanted;
  for (const HashGroup& group : expected_groups(GoldenSet::quick, "figures")) {
    const std::size_t begin = table.find("{\"" + group.name + "\", ");
    REQUIRE(begin != table.npos);
    const std::size_t next = table.find('{', begin + 1);
    wanted += table.substr(begin, next == table.npos ? next : next - begin);
  }
  CHECK(run.out == wanted);
}

TEST_CASE("selftest --print lists the hashes of one group, and of a branch its part of the table") {
  const ProgramRun group = run_program({"selftest", "number", "--print"});
  CHECK(group.status == 0);
  CHECK(group.out.starts_with("0x5d79f1b086f30345 number half decoded\n"));
  const ProgramRun branch = run_program({"selftest", "samplers", "--print"});
  CHECK(branch.status == 0);
  const std::string table = read_file(SOFTFOCUS_TEST_DATA "/../../tools/golden/table.inc");
  CHECK(branch.out.starts_with("{\"samplers ieee\", "));
  CHECK(table.find(branch.out) != std::string::npos);
}

TEST_CASE("selftest of a branch checks its hashes alone") {
  const ProgramRun run = run_program({"selftest", "samplers ieee"});
  CHECK(run.status == 0);
  CHECK(run.out == "pass: 24 hashes are as expected\n");
  const ProgramRun slip = run_program({"selftest", "figurse"});
  CHECK(slip.status == 2);
  CHECK(slip.err.ends_with("; did you mean 'figures'?\n"));
}

TEST_CASE("selftest --json lists what was expected, what was computed and whether it passes" *
          doctest::test_suite("long")) {
  const ProgramRun run =
      run_program({"selftest", "cube-room", "--quick", "--json", "--threads", "1"});
  CHECK(run.status == 0);
  const auto list = nlohmann::json::parse(run.out);
  CHECK(list.size() == member_count(expected_groups(GoldenSet::quick, "cube-room")));
  for (const auto& entry : list) {
    CAPTURE(entry.dump());
    CHECK(entry.at("name").is_string());
    const std::string computed = entry.at("computed");
    CHECK(computed.size() == 18);
    CHECK(entry.at("expected_end") == computed.substr(14));
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
