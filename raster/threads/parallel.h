#pragma once
// A pool of threads, and the one way to use it: a counted loop whose iterations run in any
// order on any thread. The pool carries the vector unit that kernels use. Results must
// depend on neither.

#include "raster/lanes/isa.h"
#include "raster/threads/memory.h"

namespace softfocus {

/// Threads that sleep until a loop wants them.
class ThreadPool {
 public:
  /// `threads` >= 1 counts the calling one; 1 starts none. If the system gives fewer, the pool
  /// has fewer. Needs an `isa` that this CPU has.
  explicit ThreadPool(int threads, Isa isa = widest_isa());
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int threads() const;
  Isa isa() const { return isa_; }
  /// Of what is made with this pool, frame after frame.
  MemoryShelf& memory() { return memory_; }

  /// Runs body(0) to body(count - 1), each once and in the default floating-point environment
  /// (float_environment.h), and returns when all have ended. If a body throws, iterations that
  /// have not begun are left out, and the first exception is rethrown here. Must not be called
  /// from a body.
  template <class Body>
  void for_each(int count, const Body& body) {
    run(count,
        {&body, [](const void* callable, int i) { (*static_cast<const Body*>(callable))(i); }});
  }

 private:
  // A reference to a callable of any type: std::function would copy it and allocate.
  struct Iteration {
    const void* callable;
    void (*call)(const void* callable, int i);
  };
  struct State;

  void run(int count, Iteration iteration);

  State* state_;  // owned; <memory> is more to parse than all of this header
  MemoryShelf memory_;
  Isa isa_;
};

/// The threads that the machine can run at once, at least 1.
int hardware_threads();

}  // namespace softfocus
