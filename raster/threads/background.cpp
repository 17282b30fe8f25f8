#include "raster/threads/background.h"

#include <atomic>
#include <cassert>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "raster/threads/float_environment.h"

namespace softfocus {

struct Background::State {
  std::mutex mutex;
  std::condition_variable begun;
  std::condition_variable ended;
  // Written under the mutex, read without it.
  std::atomic<bool> running{false};
  bool stopping = false;
  std::function<void()> job;
  std::exception_ptr failure;
  std::thread thread;

  void run_job() {
    try {
      job();
    } catch (...) {
      failure = std::current_exception();
    }
  }

  void work() {
    const DefaultFloatEnvironment environment;
    std::unique_lock lock(mutex);
    for (;;) {
      begun.wait(lock, [&] { return stopping || running; });
      if (!running) return;
      lock.unlock();
      run_job();
      lock.lock();
      running = false;
      ended.notify_one();
    }
  }
};

Background::Background() : state_(std::make_unique<State>()) {
  try {
    state_->thread = std::thread{[state = state_.get()] { state->work(); }};
  } catch (const std::system_error&) {
    // begin() does the work.
  }
}

Background::~Background() {
  if (!state_->thread.joinable()) return;
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopping = true;
  }
  state_->begun.notify_one();
  state_->thread.join();
}

void Background::begin(std::function<void()> job) {
  assert(!is_running());
  State& state = *state_;
  if (!state.thread.joinable()) {
    const DefaultFloatEnvironment environment;
    state.job = std::move(job);
    state.run_job();
    return;
  }
  {
    const std::lock_guard lock(state.mutex);
    state.job = std::move(job);
    state.running = true;
  }
  state.begun.notify_one();
}

bool Background::is_running() const { return state_->running; }

void Background::wait() {
  State& state = *state_;
  std::unique_lock lock(state.mutex);
  state.ended.wait(lock, [&] { return !state.running; });
  if (state.failure) std::rethrow_exception(std::exchange(state.failure, nullptr));
}

}  // namespace softfocus
