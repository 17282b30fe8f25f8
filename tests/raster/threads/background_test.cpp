#include "raster/threads/background.h"

#include <doctest/doctest.h>

#include <atomic>
#include <stdexcept>

#include "raster/threads/parallel.h"

using namespace softfocus;

TEST_SUITE("threads") {
  TEST_CASE("a background job is done when wait() returns, and another can follow") {
    Background background;
    int sum = 0;
    for (int i = 1; i <= 20; ++i) {
      background.begin([&sum, i] { sum += i; });
      background.wait();
      CHECK(!background.is_running());
    }
    CHECK(sum == 210);
  }

  TEST_CASE("a background job runs loops of its own beside the caller's") {
    Background background;
    ThreadPool pool(2), own(1);
    int there = 0;
    background.begin([&] { own.for_each(100, [&](int i) { there += i; }); });
    std::atomic<int> here{0};
    pool.for_each(100, [&](int i) { here += i; });
    background.wait();
    CHECK(there == 4950);
    CHECK(here == 4950);
  }

  TEST_CASE("what a background job throws is rethrown once by wait()") {
    Background background;
    background.begin([] { throw std::runtime_error("lost"); });
    CHECK_THROWS_WITH_AS(background.wait(), "lost", std::runtime_error);
    background.wait();
  }

  TEST_CASE("a background that is left waits for its job") {
    int done = 0;
    {
      Background background;
      background.begin([&] { done = 1; });
    }
    CHECK(done == 1);
  }
}
