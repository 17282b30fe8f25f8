#pragma once
// Checks that hold for every refusal of the program.

#include <doctest/doctest.h>

#include "tests/support/run_program.h"

namespace softfocus {

/// Runs the program and checks that it ends with `status`, has one line to say, in which
/// every one of `named` stands, and leaves the directory as it was.
inline void check_refused(const TemporaryDirectory& directory,
                          const std::vector<std::string>& arguments, int status,
                          const std::vector<std::string>& named, const RunSetting& setting = {}) {
  std::string command;
  for (const std::string& word : arguments) command += word + " ";
  CAPTURE(command);
  const std::vector<std::string> before = directory.listing();
  const ProgramRun run = run_program(arguments, setting);
  CHECK(run.status == status);
  CAPTURE(run.err);
  CHECK(is_one_line(run.err));
  for (const std::string& part : named) {
    CAPTURE(part);
    CHECK(contains(run.err, part));
  }
  CHECK(run.out == "");
  CHECK(directory.listing() == before);
}

}  // namespace softfocus
