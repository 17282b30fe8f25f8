#pragma once
// For tests that need a GL driver. Without it a test says so, and ctest lists it as
// skipped; where SOFTFOCUS_REQUIRE_DRIVERS is set, as in CI, that is a failure.

#include <doctest/doctest.h>

#include <cstdlib>
#include <map>
#include <string>

#include "tests/support/run_program.h"

namespace softfocus {

inline bool has_driver(const std::string& name) {
  static std::map<std::string, ProgramRun> asked;
  auto found = asked.find(name);
  if (found == asked.end()) {
    found = asked
                .emplace(name, run_program({"crosscheck", "--driver", name, "--case",
                                            "store/rgba8-around-every-byte"}))
                .first;
  }
  const ProgramRun& run = found->second;
  if (run.err.empty()) return true;
  const std::string missing = "no GL driver " + name + " (" + run.err + ")";
  const bool required = std::getenv("SOFTFOCUS_REQUIRE_DRIVERS") != nullptr;
  CHECK_MESSAGE(!required, missing);
  if (!required) MESSAGE("skipped: " << missing);
  return false;
}

/// Sets an environment variable while it lives, for the programs run meanwhile.
class EnvironmentVariable {
 public:
  EnvironmentVariable(const char* name, const char* value) : name_(name) {
    ::setenv(name, value, 1);
  }
  ~EnvironmentVariable() { ::unsetenv(name_); }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

 private:
  const char* name_;
};

}  // namespace softfocus
