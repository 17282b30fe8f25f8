#pragma once
// For tests that need a GL driver.

#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>

#include "tests/support/run_program.h"
#include "tests/support/skip.h"

namespace softfocus {

/// Mesa keeps threads until the process ends. The leak sanitizer, which stops all threads then, has
/// crashed on one that was ending itself. Leaks are looked for in all runs without a driver.
inline void look_for_no_leaks() {
  static const bool set = [] {
    const char* given = std::getenv("ASAN_OPTIONS");
    const std::string options = given == nullptr ? "" : std::string{given} + ":";
    return ::setenv("ASAN_OPTIONS", (options + "detect_leaks=0").c_str(), 1) == 0;
  }();
  if (!set) throw std::runtime_error("no ASAN_OPTIONS");
}

inline bool has_driver(const std::string& name) {
  look_for_no_leaks();
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
