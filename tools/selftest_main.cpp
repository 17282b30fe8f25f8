// softfocus_selftest [--quick | --few] [--shaders FOLDER]: `softfocus selftest` without the rest of
// the program, for builds that exist only for their hashes. With --shaders also the quick cases of
// `softfocus crosscheck --driver emulated`: our GLSL against its C++ forms. The SPIR-V goes to
// FOLDER, and where there is no glslang comes from it.

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string_view>

#include "tools/crosscheck/cases.h"
#include "tools/golden/hashes.h"

namespace {

using namespace softfocus;

struct SelftestArguments {
  GoldenSet set = GoldenSet::all;
  std::filesystem::path shaders{};
};

int usage() {
  std::cerr << "usage: softfocus_selftest [--quick | --few] [--shaders FOLDER]\n";
  return 2;
}

/// Whether all cases are equal.
bool check_shaders(const SelftestArguments& arguments, ThreadPool& pool) {
  const Profile profile{};
  const Shaders shaders{};
  const GlContext gl{*find_driver("emulated"), {}, profile, arguments.shaders};
  const Bench bench{gl, shaders, profile, pool};
  std::size_t cases = 0, equal = 0;
  std::uint64_t values = 0;
  for (const Case& one : quick_cases(arguments.set == GoldenSet::few)) {
    ++cases;
    Tally tally;
    std::string failure;
    try {
      one.run(bench, tally);
      if (tally.differing != 0) failure = std::to_string(tally.differing) + " values differ";
    } catch (const std::exception& error) {
      failure = error.what();
    }
    values += tally.values;
    if (failure.empty()) ++equal;
    if (!failure.empty()) std::cerr << one.stage << '/' << one.name << ": " << failure << '\n';
  }
  std::cout << equal << " of " << cases << " cases of shaders equal, " << values << " values\n";
  return equal == cases;
}

bool check_numbers(const SelftestArguments& arguments, ThreadPool& pool) {
  const auto checks =
      check_hashes(expected_groups(arguments.set), golden_hashes(pool, arguments.set));
  const std::string failures = describe_failures(checks);
  if (!failures.empty()) {
    std::cerr << "selftest: " << failures << "; docs/portability.md says how to go on\n";
    return false;
  }
  std::cout << "pass: " << checks.size() << " hashes are as expected\n";
  return true;
}

}  // namespace

int main(int count, char** words) {
  SelftestArguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    if (word == "--quick" && arguments.set == GoldenSet::all) {
      arguments.set = GoldenSet::quick;
    } else if (word == "--few" && arguments.set == GoldenSet::all) {
      arguments.set = GoldenSet::few;
    } else if (word == "--shaders" && i + 1 < count) {
      arguments.shaders = words[++i];
    } else {
      return usage();
    }
  }
  try {
    ThreadPool pool{hardware_threads()};
    if (!arguments.shaders.empty() && !check_shaders(arguments, pool)) return 1;
    return check_numbers(arguments, pool) ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "selftest: " << error.what() << '\n';
  }
  return 1;
}
