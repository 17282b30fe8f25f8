#include "raster/threads/parallel.h"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace softfocus;

TEST_CASE("a thread pool runs every iteration once, for any number of threads and iterations" *
          doctest::test_suite("threads")) {
  for (const int threads : {1, 2, 3, 8}) {
    ThreadPool pool{threads};
    CHECK(pool.threads() == threads);
    for (const int count : {1, 2, 7, 64, 10'000}) {
      std::vector<std::atomic<int>> runs(static_cast<std::size_t>(count));
      pool.for_each(count, [&](int i) { ++runs[static_cast<std::size_t>(i)]; });
      int wrong = 0;
      for (const auto& run : runs) wrong += run != 1;
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("a thread pool runs nothing for a count of 0 or less" * doctest::test_suite("threads")) {
  for (const int threads : {1, 4}) {
    ThreadPool pool{threads};
    for (const int count : {0, -1, -1000}) {
      pool.for_each(count, [](int) { FAIL("an iteration ran"); });
    }
  }
}

TEST_CASE("a thread pool can be used again and again, and what it wrote can be read" *
          doctest::test_suite("threads")) {
  ThreadPool pool{3};
  std::vector<int> values(50);  // plain ints: the end of a loop orders their writes
  for (int round = 0; round < 2'000; ++round) {
    pool.for_each(50, [&](int i) { values[static_cast<std::size_t>(i)] += i; });
  }
  int wrong = 0;
  for (int i = 0; i < 50; ++i) wrong += values[static_cast<std::size_t>(i)] != 2'000 * i;
  CHECK(wrong == 0);
}

TEST_CASE("a thread pool rethrows a body's exception where the loop was called" *
          doctest::test_suite("threads")) {
  for (const int threads : {1, 2, 8}) {
    ThreadPool pool{threads};
    CHECK_THROWS_WITH_AS(pool.for_each(100,
                                       [](int i) {
                                         if (i == 37) throw std::runtime_error("iteration 37");
                                       }),
                         "iteration 37", std::runtime_error);
  }
}

TEST_CASE("of many exceptions a thread pool rethrows one" * doctest::test_suite("threads")) {
  ThreadPool pool{4};
  for (int round = 0; round < 100; ++round) {
    CHECK_THROWS_AS(pool.for_each(100, [](int) { throw std::runtime_error("each"); }),
                    std::runtime_error);
  }
}

TEST_CASE("after an exception a thread pool leaves out what has not begun" *
          doctest::test_suite("threads")) {
  ThreadPool pool{2};
  std::atomic<int> runs{0};
  CHECK_THROWS(pool.for_each(1'000'000, [&](int) {
    ++runs;
    throw std::runtime_error("at once");
  }));
  CHECK(runs <= 2);
}

TEST_CASE("after an exception a thread pool works as before" * doctest::test_suite("threads")) {
  ThreadPool pool{4};
  CHECK_THROWS(pool.for_each(100, [](int) { throw 1; }));
  std::atomic<int> runs{0};
  pool.for_each(1'000, [&](int) { ++runs; });
  CHECK(runs == 1'000);
}

TEST_CASE("a thread pool of n runs iterations on n threads when they wait for each other" *
          doctest::test_suite("threads")) {
  ThreadPool pool{4};
  std::atomic<int> arrived{0};
  pool.for_each(4, [&](int) {
    ++arrived;
    while (arrived < 4) std::this_thread::yield();
  });
  CHECK(arrived == 4);
}

TEST_CASE("a thread pool of one thread runs everything on the caller's" *
          doctest::test_suite("threads")) {
  ThreadPool pool{1};
  const auto caller = std::this_thread::get_id();
  bool elsewhere = false;
  pool.for_each(100, [&](int) { elsewhere = elsewhere || std::this_thread::get_id() != caller; });
  CHECK_FALSE(elsewhere);
}

TEST_CASE("a thread pool that was never used, or used once, ends cleanly" *
          doctest::test_suite("threads")) {
  for (int i = 0; i < 200; ++i) {
    ThreadPool idle{4};
    ThreadPool once{3};
    once.for_each(3, [](int) {});
  }
  CHECK(true);
}

TEST_CASE("the machine has at least one thread" * doctest::test_suite("threads")) {
  CHECK(hardware_threads() >= 1);
}
