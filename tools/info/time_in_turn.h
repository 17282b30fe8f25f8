#pragma once
// Several things timed in turn, so that what disturbs the machine disturbs all.

#include <chrono>
#include <ctime>
#include <string>
#include <vector>

namespace softfocus {

struct Milliseconds {
  std::string name;
  std::vector<double> ms{};
  std::vector<double> cpu_ms{};  ///< of all threads
};

template <class... Work>
void time_in_turn(std::vector<Milliseconds>& all, int runs, const Work&... work) {
  const auto timed = [](Milliseconds& of, const auto& one) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    one();
    of.cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
    of.ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count());
  };
  for (int run = 0; run < runs; ++run) {
    std::size_t i = 0;
    (timed(all[i++], work), ...);
  }
}

/// Sorts the times and prints their medians.
void print_times(std::vector<Milliseconds>& all);

}  // namespace softfocus
