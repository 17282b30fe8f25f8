// softfocus_selftest [--quick | --few]: `softfocus selftest` without the rest of the program, for
// builds that exist only for their hashes.

#include <exception>
#include <iostream>
#include <string_view>

#include "tools/golden/hashes.h"

int main(int count, char** arguments) {
  using namespace softfocus;
  const std::string_view option = count == 2 ? arguments[1] : "";
  const bool is_quick = option == "--quick", is_few = option == "--few";
  if (count > 1 && !is_quick && !is_few) {
    std::cerr << "usage: softfocus_selftest [--quick | --few]\n";
    return 2;
  }
  const GoldenSet set = is_quick ? GoldenSet::quick : is_few ? GoldenSet::few : GoldenSet::all;
  try {
    ThreadPool pool{hardware_threads()};
    const auto checks = check_hashes(expected_groups(set), golden_hashes(pool, set));
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
