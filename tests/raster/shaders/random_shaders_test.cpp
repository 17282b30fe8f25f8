#include <doctest/doctest.h>

#include "tests/support/random_spirv.h"
#include "tests/support/sanitizers.h"
#include "tests/support/shader_checks.h"

#include <functional>
#include <initializer_list>

using namespace softfocus;

namespace {

using enum SpirvOp;

/// Words of a module that does little, but for what is put among its declarations and into main().
struct Words {
  std::vector<std::uint32_t> all{0x07230203, 0x00010000, 0, 1u << 20, 0};
  std::uint32_t next = 100;

  void put(SpirvOp op, const std::vector<std::uint32_t>& operands) {
    all.push_back(static_cast<std::uint32_t>(operands.size() + 1) << 16 |
                  static_cast<std::uint32_t>(op));
    all.insert(all.end(), operands.begin(), operands.end());
  }
};
enum Id : std::uint32_t { no_id, main_id, void_id, function_id, int_id, bool_id, true_id, one_id };

/// Whether a shader is refused, with a line of that in it.
bool is_refused(const std::function<void(Words&)>& declare, const std::function<void(Words&)>& body,
                const std::string& why) {
  Words words;
  words.put(entry_point, {4, main_id, 0});
  words.put(type_void, {void_id});
  words.put(type_function, {function_id, void_id});
  words.put(type_int, {int_id, 32, 1});
  words.put(type_bool, {bool_id});
  words.put(constant_true, {bool_id, true_id});
  words.put(constant, {int_id, one_id, 1});
  declare(words);
  words.put(SpirvOp::function, {void_id, main_id, 0, function_id});
  words.put(label, {50});
  body(words);
  words.put(function_end, {});
  try {
    test::run_any_shader(words.all, Isa::baseline);
  } catch (const ShaderError& error) {
    return std::string{error.what()}.find(why) != std::string::npos;
  }
  return false;
}
void nothing(Words&) {}
void return_only(Words& words) { words.put(return_nothing, {}); }

void check_random_shaders(std::uint64_t first, std::uint64_t end) {
  for (std::uint64_t seed = first; seed < end; ++seed) {
    CAPTURE(seed);
    const test::CheckResult result = test::check_shader(test::RandomSpirv{seed}.words(), seed);
    CHECK(!result.is_stopped);
    CHECK(result.difference == "");
  }
}

}  // namespace

TEST_CASE("random shaders have a pixel's bits on every unit, at every width, simplified or not") {
  check_random_shaders(0, kHasSanitizers ? 4 : 12);
}

TEST_CASE("so have more of them" * doctest::test_suite("long")) { check_random_shaders(12, 60); }

TEST_CASE("a type that consists of itself is refused") {
  constexpr std::uint32_t kHead[] = {0x07230203, 0x00010000, 0, 9, 0};
  const auto words = [&](std::vector<std::uint32_t> type) {
    type.insert(type.begin(), std::begin(kHead), std::end(kHead));
    return type;
  };
  for (const auto& type : {std::vector<std::uint32_t>{4u << 16 | 32, 5, 1, 5},  // a pointer
                           std::vector<std::uint32_t>{3u << 16 | 33, 5, 5},     // a function
                           std::vector<std::uint32_t>{9u << 16 | 25, 5, 5, 1, 0, 0, 0, 1, 0}}) {
    CHECK_THROWS_WITH_AS(read_spirv(words(type)),
                         "the SPIR-V is damaged: a type is used that is not there", ShaderError);
  }
}

TEST_CASE("damaged SPIR-V is refused in words, or runs and ends") {
  test::Random random{5};
  int ran = 0;
  for (std::uint64_t seed = 0; seed < fewer<std::uint64_t>(600); ++seed) {
    CAPTURE(seed);
    try {
      test::run_any_shader(damaged_spirv(test::RandomSpirv{seed % 40}.words(), random),
                           Isa::baseline);
      ++ran;
    } catch (const ShaderError&) {
    }
  }
  CHECK(ran > fewer(20));
}

TEST_CASE("a shader that grows without end is refused") {
  CHECK(is_refused(
      nothing, [](Words& words) { words.put(branch, {50}); }, "too long"));
  const auto structures = [](Words& words) {
    std::uint32_t inner = int_id;
    for (int i = 0; i < 50000; ++i, inner = words.next++)
      words.put(type_struct, {words.next, inner});
  };
  CHECK(is_refused(structures, return_only, "nested too deeply"));
  const auto emptiness = [](Words& words) {
    words.put(type_struct, {90});
    words.put(constant, {int_id, 91, ~0u});
    words.put(type_array, {92, 90, 91});
  };
  CHECK(is_refused(emptiness, return_only, "holds no numbers"));
  const auto zeros = [](Words& words) {
    words.put(constant, {int_id, 91, 1u << 16});
    words.put(type_array, {92, int_id, 91});
    for (int i = 0; i < 10000; ++i) words.put(constant_null, {92, words.next++});
  };
  CHECK(is_refused(zeros, return_only, "too many numbers"));
  const auto inputs = [](Words& words) {
    words.put(constant, {int_id, 91, 1u << 16});
    words.put(type_array, {92, int_id, 91});
    words.put(type_pointer, {93, 1, 92});
    for (int i = 0; i < 10000; ++i) words.put(variable, {93, words.next++, 1});
  };
  CHECK(is_refused(inputs, return_only, "too many numbers"));
}

TEST_CASE("control flow that is walked again and again is refused") {
  // Both ways of each branch go to the next.
  const auto doubled = [](Words& words) {
    for (std::uint32_t i = 0; i < 150; ++i) {
      words.put(selection_merge, {10000 + i, 0});
      words.put(branch_conditional, {true_id, 1000 + i, 1000 + i});
      words.put(label, {1000 + i});
    }
    words.put(return_nothing, {});
    for (std::uint32_t i = 0; i < 150; ++i) {
      words.put(label, {10000 + i});
      words.put(return_nothing, {});
    }
  };
  CHECK(is_refused(nothing, doubled, "too long"));
  const auto nested = [](Words& words) {
    for (std::uint32_t i = 0; i < 5000; ++i) {
      words.put(selection_merge, {10000 + i, 0});
      words.put(branch_conditional, {true_id, 1000 + i, 10000 + i});
      words.put(label, {1000 + i});
    }
    for (std::uint32_t i = 5000; i-- > 0;) {
      words.put(branch, {10000 + i});
      words.put(label, {10000 + i});
    }
    words.put(return_nothing, {});
  };
  CHECK(is_refused(nothing, nested, "nested too deeply"));
  // Each function calls the next twice.
  const auto calls = [](Words& words) {
    for (std::uint32_t i = 0; i < 60; ++i) {
      if (i > 0) {
        words.put(SpirvOp::function, {void_id, 1000 + i, 0, function_id});
        words.put(label, {2000 + i});
      }
      words.put(function_call, {void_id, 3000 + i, 1001 + i});
      words.put(function_call, {void_id, 4000 + i, 1001 + i});
      words.put(return_nothing, {});
      words.put(function_end, {});
    }
    words.put(SpirvOp::function, {void_id, 1060, 0, function_id});
    words.put(label, {2060});
    words.put(return_nothing, {});
  };
  CHECK(is_refused(nothing, calls, "too long"));
  // A switch with a long way from case to case.
  const auto ways = [](Words& words) {
    words.put(selection_merge, {90, 0});
    words.put(switch_case, {one_id, 90, 0, 100000, 1, 99});
    for (std::uint32_t i = 0; i < 100000; ++i) {
      words.put(label, {100000 + i});
      words.put(branch, {100001 + i});
    }
    words.put(label, {200000});
    words.put(branch, {99});
    words.put(label, {99});
    words.put(return_nothing, {});
    words.put(label, {90});
    words.put(return_nothing, {});
  };
  CHECK(!is_refused(nothing, ways, ""));
}
