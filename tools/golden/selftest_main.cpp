// softfocus_selftest: `softfocus selftest` without options and without the rest of the
// program, for builds that exist only for their hashes.

#include <exception>
#include <iostream>

#include "tools/golden/hashes.h"

int main() {
  using namespace softfocus;
  try {
    ThreadPool pool{hardware_threads()};
    const auto checks = check_hashes(expected_hashes(), golden_hashes(pool));
    const std::string failures = describe_failures(checks);
    if (failures.empty()) {
      std::cout << "pass: " << checks.size() << " hashes are as expected\n";
      return 0;
    }
    std::cerr << "selftest: " << failures << "; docs/portability.md says how to go on\n";
  } catch (const std::exception& error) {
    std::cerr << "selftest: " << error.what() << '\n';
  }
  return 1;
}
