#include "raster/threads/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "raster/threads/float_environment.h"

namespace softfocus {
namespace {

inline void let_the_core_rest() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

// Loops follow each other closely, and waking a sleeping thread takes tens of microseconds.
// So a thread waits that long before it sleeps. It does not yield: another program would keep
// the core for its whole turn.
template <class Condition>
void wait_a_little(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds{60};
  while (!condition() && std::chrono::steady_clock::now() < end) let_the_core_rest();
}

}  // namespace

struct ThreadPool::State {
  std::mutex mutex;
  std::condition_variable work_ready;
  std::condition_variable work_done;
  // Written under the mutex, read without it.
  std::atomic<std::uint64_t> generation{0};  // counts loops: a sleeper sees a new one
  std::atomic<int> busy_workers{0};
  bool stopping = false;

  Iteration iteration{};
  int count = 0;
  std::atomic<int> next{0};
  std::exception_ptr failure;

  std::vector<std::thread> workers;

  void run_iterations() {
    for (int i = next.fetch_add(1); i < count; i = next.fetch_add(1)) {
      try {
        iteration.call(iteration.callable, i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next.store(count);
      }
    }
  }

  void work() {
    const DefaultFloatEnvironment environment;
    std::uint64_t seen = 0;
    for (;;) {
      wait_a_little([&] { return generation != seen; });
      {
        std::unique_lock lock(mutex);
        work_ready.wait(lock, [&] { return stopping || generation != seen; });
        if (stopping) return;
        seen = generation;
      }
      run_iterations();
      const std::lock_guard lock(mutex);
      if (--busy_workers == 0) work_done.notify_one();
    }
  }
};

ThreadPool::ThreadPool(int threads, Isa isa) : isa_(isa) {
  auto state = std::make_unique<State>();
  try {
    for (int i = 1; i < threads; ++i) {
      state->workers.emplace_back([shared = state.get()] { shared->work(); });
    }
  } catch (const std::system_error&) {
    // The system gives no more threads: the pool works with those it has.
  }
  state_ = state.release();
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopping = true;
  }
  state_->work_ready.notify_all();
  for (std::thread& worker : state_->workers) worker.join();
  delete state_;
}

int ThreadPool::threads() const { return static_cast<int>(state_->workers.size()) + 1; }

void ThreadPool::run(int count, Iteration iteration) {
  if (count <= 0) return;
  const DefaultFloatEnvironment environment;
  if (state_->workers.empty() || count == 1) {
    for (int i = 0; i < count; ++i) iteration.call(iteration.callable, i);
    return;
  }
  {
    const std::lock_guard lock(state_->mutex);
    state_->iteration = iteration;
    state_->count = count;
    state_->next.store(0);
    state_->failure = nullptr;
    state_->busy_workers = static_cast<int>(state_->workers.size());
    ++state_->generation;
  }
  state_->work_ready.notify_all();
  state_->run_iterations();
  wait_a_little([&] { return state_->busy_workers == 0; });
  std::unique_lock lock(state_->mutex);
  state_->work_done.wait(lock, [&] { return state_->busy_workers == 0; });
  if (state_->failure) std::rethrow_exception(std::exchange(state_->failure, nullptr));
}

int hardware_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace softfocus
