#pragma once
// For a test case that cannot do its work here: it says so and returns, and tools/test
// counts it as skipped. Where SOFTFOCUS_REQUIRE is "all", as in CI, or names what is
// missing, the case fails.

#include <doctest/doctest.h>

#include <cstdlib>
#include <iostream>
#include <set>
#include <string>
#include <string_view>

namespace softfocus {

/// `needed` is one of driver, embree, numpy, gegl, groff, bash, zsh, fish, terminal,
/// full-device, other-user; empty if it cannot be asked for, as what another build tests. `why` is
/// for a person.
inline void skip(const std::string& needed, std::string_view why) {
  const char* const set = std::getenv("SOFTFOCUS_REQUIRE");
  const std::string required = set != nullptr ? set : "";
  if (!needed.empty() &&
      (required == "all" || ("," + required + ",").find("," + needed + ",") != std::string::npos)) {
    FAIL_CHECK("SOFTFOCUS_REQUIRE is " << required << ", but: " << why);
    return;
  }
  static std::set<std::string> said;  // a case may lack two things
  const std::string name = doctest::getContextOptions()->currentTest->m_name;
  if (said.insert(name).second) std::cout << "skipped: " << name << " (" << why << ")\n";
}

}  // namespace softfocus
