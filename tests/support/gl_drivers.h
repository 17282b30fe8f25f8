#pragma once
// For tests that need a GL driver.

#include <cstdlib>
#include <map>
#include <string>

#include "tests/support/run_program.h"
#include "tests/support/skip.h"

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
  skip("driver", "no GL driver " + name + ": " + run.err.substr(0, run.err.find('\n')));
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
