#include "raster/threads/float_environment.h"

#include <doctest/doctest.h>

#include <atomic>
#include <cfenv>
#include <thread>

#include "raster/threads/parallel.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

using namespace softfocus;

namespace {

// Changes the calling thread's environment; false if this machine cannot.
using Change = bool (*)();

bool flush_subnormals() {
#if defined(__SSE2__)
  constexpr unsigned kFlushResults = 0x8000, kFlushOperands = 0x0040;
  _mm_setcsr(_mm_getcsr() | kFlushResults | kFlushOperands);
  return true;
#elif defined(__aarch64__)
  constexpr std::uint64_t kFlush = std::uint64_t{1} << 24;
  asm volatile("msr fpcr, %0" : : "r"(kFlush));
  return true;
#else
  return false;
#endif
}

bool round_upwards() {
#ifdef FE_UPWARD
  return std::fesetround(FE_UPWARD) == 0;
#else
  return false;
#endif
}

// Volatile: computed when it runs, not by the compiler.
bool is_default_environment() {
  volatile float subnormal = 0x1p-140f, one = 1.0f, little = 0x1p-30f;
  const bool keeps_subnormals = subnormal * 0.5f == 0x1p-141f && subnormal + subnormal != 0.0f;
  return keeps_subnormals && one + little == 1.0f && -one - little == -1.0f;
}

struct Outcome {
  bool changed = false;  // the environment could be, and computing showed it
  int iterations_as_default = 0;
  bool caller_keeps_its_own = false;
};

// A loop in which each thread has one iteration, in a caller of another environment.
Outcome loop_in(Change change, int threads, bool pool_exists_before) {
  Outcome outcome;
  std::atomic<int> as_default{0};
  std::atomic<int> arrived{0};
  // A thread of its own: the tests after this one want theirs unchanged.
  std::thread{[&] {
    ThreadPool before{pool_exists_before ? threads : 1};
    if (!change()) return;
    outcome.changed = !is_default_environment();
    ThreadPool after{pool_exists_before ? 1 : threads};
    (pool_exists_before ? before : after).for_each(threads, [&](int) {
      ++arrived;
      while (arrived < threads) std::this_thread::yield();
      as_default += is_default_environment() ? 1 : 0;
    });
    outcome.caller_keeps_its_own = !is_default_environment();
  }}.join();
  outcome.iterations_as_default = as_default;
  return outcome;
}

void check_loops(Change change) {
  for (const int threads : {1, 2, 4}) {
    for (const bool pool_exists_before : {false, true}) {
      CAPTURE(threads);
      CAPTURE(pool_exists_before);
      const Outcome outcome = loop_in(change, threads, pool_exists_before);
      if (!outcome.changed) continue;
      CHECK(outcome.iterations_as_default == threads);
      CHECK(outcome.caller_keeps_its_own);
    }
  }
}

}  // namespace

TEST_CASE("a loop keeps subnormals on all threads of a program that flushes them") {
  check_loops(flush_subnormals);
}

TEST_CASE("a loop rounds to nearest on all threads of a program that rounds upwards") {
  check_loops(round_upwards);
}

TEST_CASE("a default float environment ends with its scope") {
  std::thread{[] {
    if (!round_upwards() || is_default_environment()) return;
    {
      const DefaultFloatEnvironment environment;
      CHECK(is_default_environment());
    }
    CHECK_FALSE(is_default_environment());
  }}.join();
}

#if defined(__SSE2__)
TEST_CASE("on x86 both ways of leaving the default environment can be had") {
  CHECK(loop_in(flush_subnormals, 1, false).changed);
  CHECK(loop_in(round_upwards, 1, false).changed);
}
#endif
