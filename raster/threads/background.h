#pragma once
// One job at a time beside the calling thread, on a thread that sleeps between jobs.

#include <functional>
#include <memory>

namespace softfocus {

class Background {
 public:
  /// If the system gives no thread, begin() does the whole job.
  Background();
  /// Waits for a job that runs.
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// Starts a job, in the default floating-point environment (float_environment.h). What it touches
  /// is its own until wait() has returned or is_running() was false. Needs that no job runs.
  void begin(std::function<void()> job);

  bool is_running() const;

  /// Returns when the job has ended. If it threw, the exception is rethrown here, once.
  void wait();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace softfocus
