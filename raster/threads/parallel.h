#pragma once
// What work runs on: a pool of threads and one way to use it, a counted loop whose
// iterations may run in any order on any thread, and the vector unit that kernels use
// on each. What an iteration computes must depend on none of them.

#include <functional>
#include <memory>

#include "raster/lanes/isa.h"

namespace softfocus {

/// Threads that sleep until a loop wants them.
class ThreadPool {
 public:
  /// `threads` >= 1 counts the calling one; 1 starts none. Where the system gives fewer,
  /// fewer it is. Needs an `isa` that this CPU has.
  explicit ThreadPool(int threads, Isa isa = widest_isa());
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const;
  Isa isa() const { return isa_; }

  /// Runs body(0) to body(count - 1), each once, and returns when all have ended.
  /// An exception of a body is rethrown here after the others have stopped; the
  /// iterations not yet begun are left out. Not to be called from a body.
  void for_each(int count, const std::function<void(int)>& body);

 private:
  struct State;
  std::unique_ptr<State> state_;
  Isa isa_;
};

/// The threads that the machine can run at once, at least 1.
int hardware_threads();

}  // namespace softfocus
