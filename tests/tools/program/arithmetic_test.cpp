// --arithmetic on the command line.

#include <nlohmann/json.hpp>

#include "tests/support/cli_refused.h"

using namespace softfocus;

namespace {

std::vector<std::string> render(const TemporaryDirectory& directory,
                                std::vector<std::string> options) {
  options.insert(options.begin(), {"render", "figures", "--multisample", "1", "--size", "96x64",
                                   "-o", directory.file("a.npy")});
  return options;
}

nlohmann::json benched(const std::string& arithmetic) {
  const ProgramRun run = run_program(
      {"bench", "--image", "64x64", "--arithmetic", arithmetic, "--runs", "10", "--json"});
  CHECK(run.status == 0);
  CHECK(run.err == "");
  return nlohmann::json::parse(run.out);
}

}  // namespace

TEST_CASE("--arithmetic: integers give nearly the picture that floats give, on every unit one") {
  const TemporaryDirectory directory;
  const auto rendered = [&](std::vector<std::string> options) {
    options.insert(options.end(), {"--max-coc", "7"});
    CHECK(run_program(render(directory, options)).status == 0);
    return read_file(directory.file("a.npy"));
  };
  const auto floats = rendered({"--method", "two-pass"});
  for (const std::string arithmetic : {"fixed", "fixed-8"}) {
    CAPTURE(arithmetic);
    const auto scalar = rendered({"--arithmetic", arithmetic, "--isa", "scalar"});
    CHECK(scalar == rendered({"--arithmetic", arithmetic, "--threads", "3"}));
    CHECK(scalar != floats);
    CHECK(scalar.size() == floats.size());
  }
  CHECK(rendered({"--arithmetic", "float"}) == floats);
}

TEST_CASE("--arithmetic: the report names it where it is not float") {
  const TemporaryDirectory directory;
  const ProgramRun run = run_program(render(directory, {"--arithmetic", "fixed", "--json"}));
  CHECK(nlohmann::json::parse(run.out)["arithmetic"] == "fixed");
  const ProgramRun floats = run_program(render(directory, {"--json"}));
  CHECK_FALSE(nlohmann::json::parse(floats.out).contains("arithmetic"));
}

TEST_CASE("--arithmetic: what integers cannot do is refused") {
  const TemporaryDirectory directory;
  const auto refused = [&](std::vector<std::string> options, const std::vector<std::string>& said) {
    check_refused(directory, render(directory, std::move(options)), 2, said);
  };
  refused({"--arithmetic", "float16"}, {"--arithmetic 'float16'", "float, fixed, fixed-8"});
  refused({"--arithmetic", "fixed", "--method", "one-pass"},
          {"--arithmetic fixed", "--method one-pass", "only two-pass"});
  refused({"--arithmetic", "fixed", "--method", "auto"}, {"--method auto"});
  refused({"--arithmetic", "fixed", "--gl", "llvmpipe"}, {"--arithmetic fixed", "driver"});
  refused({"--arithmetic", "fixed-8", "--max-coc", "65"}, {"--arithmetic fixed-8", "64"});
  refused({"--arithmetic", "fixed", "--leak", "0.06"}, {"--arithmetic fixed", "1/16"});
  refused({"--arithmetic", "fixed", "--coc-scale", "1000000"}, {"--coc-scale"});
  check_refused(directory,
                {"bench", "--image", "64x64", "--arithmetic", "fixed", "--vs", "llvmpipe"}, 2,
                {"--arithmetic fixed", "driver"});
}

TEST_CASE("--arithmetic: bench times it in turn with the filter in floats") {
  for (const std::string arithmetic : {"fixed", "fixed-8"}) {
    const nlohmann::json result = benched(arithmetic);
    CHECK(result["arithmetic"] == arithmetic);
    CHECK(result["peer"]["driver"] == "float");
    CHECK(result["ratio"]["dof"] > 0.0);
    CHECK(result["ratio"]["raster"].is_null());
  }
}
