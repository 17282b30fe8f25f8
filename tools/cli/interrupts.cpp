#include "tools/cli/interrupts.h"

#ifndef _WIN32
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <ctime>
#include <string>
#endif

namespace softfocus {

#ifdef _WIN32

void prepare_interrupts() {}
RemovedByInterrupt::RemovedByInterrupt(const std::filesystem::path&,
                                       const std::function<bool()>& create) {
  create();
}
RemovedByInterrupt::~RemovedByInterrupt() = default;

#else

namespace {

// A handler may neither lock nor allocate, so names stand in memory of their own.
enum class SlotState : int { free, being_written, set };
struct Slot {
  std::atomic<SlotState> state{SlotState::free};
  std::array<char, 4096> name{};
};
static_assert(std::atomic<SlotState>::is_always_lock_free);
std::array<Slot, 64> slots;
/// No file is made any more.
std::atomic<bool> is_ending{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void end_by_interrupt(int signal) {
  // A second signal, to another thread, would end the program in the midst of this.
  if (is_ending.exchange(true)) return;
  // A disk that does not answer must not keep the program from its end.
  int waits_left = 1000;
  for (const Slot& slot : slots) {
    while (slot.state.load() == SlotState::being_written && waits_left-- > 0) {
      const timespec millisecond{.tv_sec = 0, .tv_nsec = 1'000'000};
      ::nanosleep(&millisecond, nullptr);
    }
    if (slot.state.load() == SlotState::set) ::unlink(slot.name.data());
  }
  struct sigaction end {};
  end.sa_handler = SIG_DFL;
  ::sigaction(signal, &end, nullptr);
  ::raise(signal);
}

constexpr std::array kInterrupts{SIGINT, SIGTERM, SIGHUP};

/// While this lives, interrupts go to other threads: the handler would wait for its own.
class Uninterrupted {
 public:
  Uninterrupted() {
    sigset_t interrupts;
    ::sigemptyset(&interrupts);
    for (const int signal : kInterrupts) ::sigaddset(&interrupts, signal);
    ::pthread_sigmask(SIG_BLOCK, &interrupts, &before_);
  }
  ~Uninterrupted() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  Uninterrupted(const Uninterrupted&) = delete;
  Uninterrupted& operator=(const Uninterrupted&) = delete;

 private:
  sigset_t before_{};
};

/// A slot of this thread's own, -1 if none is free.
int claimed_slot() {
  for (std::size_t i = 0; i < slots.size(); ++i) {
    SlotState free = SlotState::free;
    if (slots[i].state.compare_exchange_strong(free, SlotState::being_written)) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

}  // namespace

void prepare_interrupts() {
  for (const int signal : kInterrupts) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = end_by_interrupt;
    ::sigaction(signal, &action, nullptr);
  }
}

RemovedByInterrupt::RemovedByInterrupt(const std::filesystem::path& file,
                                       const std::function<bool()>& create) {
  const Uninterrupted uninterrupted;
  const std::string& name = file.native();
  const int claimed = name.size() < slots[0].name.size() ? claimed_slot() : -1;
  if (claimed < 0) {
    create();
    return;
  }
  Slot& slot = slots[static_cast<std::size_t>(claimed)];
  // The handler sees the claim, or this sees that it has begun.
  if (is_ending.load()) {
    slot.state.store(SlotState::free);
    for (;;) ::pause();
  }
  std::copy_n(name.c_str(), name.size() + 1, slot.name.data());
  const bool is_made = create();
  slot.state.store(is_made ? SlotState::set : SlotState::free);
  if (is_made) slot_ = claimed;
}

RemovedByInterrupt::~RemovedByInterrupt() {
  if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].state.store(SlotState::free);
}

#endif

}  // namespace softfocus
