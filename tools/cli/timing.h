#pragma once
// Times: taken of one thing and of several in turn, and what is said of them.

#include <chrono>
#include <ctime>
#include <span>
#include <string>
#include <vector>

namespace softfocus {

template <class Work>
double milliseconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// The middle and the ends of some samples.
struct Spread {
  double median = 0.0;
  double min = 0.0;
  double max = 0.0;
};

/// Needs at least one sample. The median of an even number is the mean of the two in the middle.
Spread spread_of(std::vector<double> samples);

/// peer / ours, pair by pair: how many times faster ours was. Needs two lists of one length, all
/// values above 0.
std::vector<double> pair_ratios(std::span<const double> ours, std::span<const double> peers);

/// 0 of none.
double mean_of(const std::vector<double>& values);
/// The value at a share of 0..1 of the sorted ones; 0 of none.
double sorted_at(std::vector<double> values, double share);

struct Milliseconds {
  std::string name;
  std::vector<double> ms{};
  std::vector<double> cpu_ms{};  ///< of all threads
};

/// Several things timed in turn, so that what disturbs the machine disturbs all.
template <class... Work>
void time_in_turn(std::vector<Milliseconds>& all, int runs, const Work&... work) {
  const auto timed = [](Milliseconds& of, const auto& one) {
    const std::clock_t cpu_start = std::clock();
    of.ms.push_back(milliseconds_of(one));
    of.cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC);
  };
  for (int run = 0; run < runs; ++run) {
    std::size_t i = 0;
    (timed(all[i++], work), ...);
  }
}

}  // namespace softfocus
